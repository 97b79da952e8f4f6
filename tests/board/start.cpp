// From reset to main() on a Cortex-M7, output and end through the debugger's door (semihosting).
#include <cstdint>
#include <cstdlib>

extern "C" {
extern std::uint32_t data_image[], data_begin[], data_end[], bss_begin[], bss_end[], stack_begin[];
int trace();
void initialise_monitor_handles();
void __libc_init_array();
void* __dso_handle = nullptr;  // NOLINT(readability-identifier-naming): objects that live for ever ask for it
void _init() {}
void _fini() {}

[[noreturn]] void fault() {
  std::uint32_t block[2] = {0x20026, 99};  // application exit with status 99
  asm volatile("mov r0, #0x20\n mov r1, %0\n bkpt 0xab" : : "r"(block) : "r0", "r1", "memory");
  for (;;) {
  }
}

[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20U;  // the floating-point unit
  asm volatile("dsb\n isb");
  for (std::uint32_t *to = data_begin, *from = data_image; to < data_end;) *to++ = *from++;
  for (std::uint32_t* to = bss_begin; to < bss_end;) *to++ = 0;
  initialise_monitor_handles();
  __libc_init_array();
  std::exit(trace());
}

[[gnu::section(".vectors"), gnu::used]] const std::uintptr_t vectors[16] = {
    reinterpret_cast<std::uintptr_t>(stack_begin), reinterpret_cast<std::uintptr_t>(&reset),
    reinterpret_cast<std::uintptr_t>(&fault),      reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault),      reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault)};
}
