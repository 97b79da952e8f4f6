// From reset to main() on a Cortex-M7, output and end through the debugger's door (semihosting).
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" {
extern std::uint32_t data_image[], data_begin[], data_end[], bss_begin[], bss_end[], stack_begin[];
int trace();
void __libc_init_array();
void* __dso_handle = nullptr;  // NOLINT(readability-identifier-naming): objects that live for ever ask for it
void _init() {}
void _fini() {}

namespace {
void ask_debugger(std::uint32_t operation, const void* what) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = what;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}
[[noreturn]] void leave(std::uint32_t status) {
  const std::uint32_t block[2] = {0x20026, status};  // application exit
  ask_debugger(0x20, block);
  for (;;) {
  }
}
}  // namespace

[[noreturn]] void fault() { leave(99); }
// In place of newlib's, which would bring files, buffers and a heap. What stands for a stream is read through this
// pointer (address 0 is flash), and asked nothing.
struct _reent* _impure_ptr = nullptr;  // NOLINT(readability-identifier-naming,bugprone-reserved-identifier)
[[noreturn]] void abort() { leave(98); }
int fputs(const char* text, FILE* /*stream*/) {
  ask_debugger(0x04, text);
  return 0;
}
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* /*stream*/) {
  for (std::size_t i = 0; i < size * count; ++i) ask_debugger(0x03, static_cast<const char*>(bytes) + i);
  return count;
}
int fputc(int c, FILE* stream) {
  const char byte = static_cast<char>(c);
  fwrite(&byte, 1, 1, stream);
  return c;
}
int __aeabi_atexit(void*, void (*)(void*), void*) { return 0; }  // NOLINT(readability-identifier-naming): nothing ends
[[noreturn]] void __cxa_pure_virtual() { leave(97); }            // NOLINT(readability-identifier-naming)

[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20U;  // the floating-point unit
  asm volatile("dsb\n isb");
  for (std::uint32_t *to = data_begin, *from = data_image; to < data_end;) *to++ = *from++;
  for (std::uint32_t* to = bss_begin; to < bss_end;) *to++ = 0;
  __libc_init_array();
  leave(static_cast<std::uint32_t>(trace()));
}

[[gnu::section(".vectors"), gnu::used]] const std::uintptr_t vectors[16] = {
    reinterpret_cast<std::uintptr_t>(stack_begin), reinterpret_cast<std::uintptr_t>(&reset),
    reinterpret_cast<std::uintptr_t>(&fault),      reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault),      reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault)};
}

// There is no heap to give anything back to; destructors of polymorphic objects name these all the same.
void operator delete(void* /*memory*/) noexcept { abort(); }
void operator delete(void* /*memory*/, std::size_t /*size*/) noexcept { abort(); }
