// What the heap seal of rig_controller sees: prints how often a sealed thread broke it by each kind of call.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "firmware/controller/real_time/heap_seal.hpp"

namespace {

struct alignas(64) Line {
  char bytes[64];
};

template <class Work>
void probe(const char* what, Work&& work) {
  const std::uint64_t before = firmware::controller::broken_seals();
  firmware::controller::seal_heap(true);
  work();
  firmware::controller::seal_heap(false);
  std::printf("%s %llu\n", what, static_cast<unsigned long long>(firmware::controller::broken_seals() - before));
}

}  // namespace

int main() {
  static void* volatile memory = nullptr;
  static Line* volatile line = nullptr;
  probe("nothing", [] {});
  probe("malloc", [] { memory = std::malloc(10); });
  probe("realloc", [] { memory = std::realloc(memory, 1000); });
  probe("free", [] { std::free(memory); });
  probe("free nullptr", [] { std::free(nullptr); });
  probe("aligned_alloc", [] { memory = std::aligned_alloc(64, 128); });
  std::free(memory);
  probe("aligned new", [] { line = new Line; });
  probe("aligned delete", [] { delete line; });
  return 0;
}
