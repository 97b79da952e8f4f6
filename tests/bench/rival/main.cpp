// What this machine takes for as much work as a period of the control loop is, after as long a sleep: the floor that
// the loop's own time is held against (real_time.bash).
//
//   rigtwin_rival SECONDS [PRIORITY]
//
// Every millisecond the program sleeps and then goes once through 48 pieces of code, each of four cache lines and three
// more of data, spread over as many pages as the loop's data: 201 lines of code, 144 of data, 2400 instructions, hardly
// a branch among them. (A period of the hil loop on x86-64, simulated rig included, with all its branches: 197 lines of
// code, 144 of data, 2380 instructions; counted with valgrind's lackey.) In every other period it does so once before,
// too, while it waits awake for its instant, as rig_controller does.
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include "firmware/controller/early_wake.hpp"
#include "firmware/controller/histogram.hpp"
#include "hal/linux/clock.hpp"

namespace {

constexpr std::size_t pieces = 48;
constexpr std::size_t pages = 18;
constexpr std::size_t page = 4096 / sizeof(double);
constexpr std::size_t line = 64 / sizeof(double);

struct Data {
  double *a, *b, *c;
};

template <std::size_t I>
[[gnu::noinline, gnu::aligned(256)]] void piece(const Data& d) {
  constexpr double some = 1.0 / static_cast<double>(I + 2), more = 0.5 + some;
  d.a[0] = d.a[0] * some + d.b[0];
  d.a[1] = d.a[1] * more + d.b[1];
  d.a[2] = d.a[2] * some - d.b[2];
  d.b[3] = d.b[3] * more + d.c[3];
  d.b[4] = d.b[4] * some + d.c[4];
  d.b[5] = d.b[5] * more - d.c[5];
  d.c[6] = d.c[6] * some + d.a[6];
  d.c[7] = d.c[7] * more - d.a[7];
  d.a[6] = d.b[1] * some + d.c[0];
  d.b[7] = d.c[2] * more + d.a[4];
  d.c[3] = d.a[3] * some - d.b[6];
}

/// In an order that does not follow the addresses, as calls do not.
template <std::size_t... I>
[[gnu::noinline]] void go_through(const std::array<Data, pieces>& data, std::index_sequence<I...>) {
  (piece<(I * 23) % pieces>(data[I]), ...);
}

void print(const char* what, const firmware::controller::Histogram& h) {
  const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) * 1e-3; };
  std::printf("  %-17s C:%8llu Min:%9.1f P50:%9.1f P99:%9.1f P99.9:%9.1f Max:%9.1f us\n", what,
              static_cast<unsigned long long>(h.count()), us(h.lowest()), us(h.quantile(0.5)), us(h.quantile(0.99)),
              us(h.quantile(0.999)), us(h.highest()));
}

}  // namespace

int main(int argc, char** argv) {
  const long seconds = argc > 1 ? std::atol(argv[1]) : 0;
  if (seconds < 1 || argc > 3) {
    std::fputs("usage: rigtwin_rival SECONDS [PRIORITY]\n", stderr);
    return 2;
  }
  auto memory = std::make_unique<std::array<double, pages * page>>();
  memory->fill(1e-3);
  std::array<Data, pieces> data{};
  std::size_t next = 0;
  const auto take = [&] {
    double* taken = memory->data() + next * 7 % pages * page + next / pages * line;
    ++next;
    return taken;
  };
  for (Data& d : data) d = {take(), take(), take()};
  ::mlockall(MCL_CURRENT | MCL_FUTURE);
  if (argc > 2) {
    sched_param parameters{};
    parameters.sched_priority = std::atoi(argv[2]);
    if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) std::puts("  SCHED_FIFO refused");
  }

  const auto work = [&] { go_through(data, std::make_index_sequence<pieces>{}); };
  hal::linux::MonotonicClock clock;
  firmware::controller::EarlyWake wake(hal::microseconds(200));
  const auto plain = std::make_unique<firmware::controller::Histogram>();
  const auto rehearsed = std::make_unique<firmware::controller::Histogram>();
  hal::Time due = clock.now() + hal::milliseconds(1);
  for (long k = 0; k < seconds * 1000; ++k, due += hal::milliseconds(1)) {
    const bool early = k % 2 == 1;
    clock.sleep_until(early ? due - wake.early() : due);
    if (early) {
      if (wake.there_is_time(due - clock.now())) {
        work();
        wake.rehearsed(due - clock.now());
      }
      while (clock.now() < due) {
      }
    }
    const hal::Time begin = clock.now();
    work();
    const hal::Time end = clock.now();
    (early ? rehearsed : plain)->add((end - begin).ns);
    if (end > due + hal::milliseconds(1)) due = end;
  }
  print("rival", *plain);
  print("rival, rehearsed", *rehearsed);
  return (*memory)[0] == 42.0 ? 1 : 0;  // the work has a result
}
