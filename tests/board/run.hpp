// What both programs for the board share: the paper's rig, a run with the hash of all it put on record, and on the
// board what a period costs in instructions and how deep the stack went.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "firmware/loop/control_loop.hpp"

namespace board {

using model::Channel;

/// The paper's rig with the project's FDVA.
constexpr model::RigParameters<double> paper_rig(model::RigKind kind) {
  model::RigParameters<double> rig;
  rig.kind = kind;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, kind == model::RigKind::hil ? 0.0 : 1140.0};
  if (kind == model::RigKind::hil) rig.machine.virtual_damping = 1140.0;
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

/// Ducts that open and close in a run of two seconds.
constexpr firmware::ValvePlan::Change changes[] = {{hal::milliseconds(500), hal::Openings::from_bits(0b101101)},
                                                   {hal::milliseconds(900), hal::Openings::from_bits(0)},
                                                   {hal::milliseconds(1200), hal::Openings::from_bits(0b111111)}};
inline constexpr firmware::ValvePlan valves(hal::Openings::first(2), changes);
inline constexpr std::uint64_t samples = 2000;

/// The sensors of a kind of rig; fit(channel) for each.
template <class Fit>
void fit_sensors(model::RigKind kind, const Fit& fit) {
  if (kind == model::RigKind::quarter_car) {
    for (const Channel c :
         {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b}) {
      fit(c);
    }
  } else {
    fit(Channel::F);
    fit(Channel::x_act);
  }
}

/// FNV-1a over the bits of numbers.
class Hash {
 public:
  void take(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    if (value != value) bits = 0x7ff8000000000000U;  // which NaN it is means nothing
    for (int i = 0; i < 8; ++i) {
      hash_ ^= (bits >> (8 * i)) & 0xffU;
      hash_ *= 1099511628211U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037U;
};

#ifdef __arm__
#define RIGTWIN_ON_BOARD 1
extern "C" std::uint32_t stack_end[];
inline volatile std::uint32_t& at(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
inline void start_timer() {
  at(0xE000E014) = 0xFFFFFF;  // SysTick counts down at the CPU's clock
  at(0xE000E018) = 0;
  at(0xE000E010) = 5;
}
inline std::uint32_t ticks() { return 0xFFFFFFU - at(0xE000E018); }

// Whatever of the stack still has this pattern later has not been used.
inline constexpr std::uint32_t unused = 0xA5A5A5A5U;
inline std::uint32_t* painted = nullptr;  // from here down
[[gnu::noinline]] inline void paint_stack() {
  auto* here = static_cast<std::uint32_t*>(__builtin_frame_address(0)) - 64;
  for (std::uint32_t* to = stack_end; to < here;) *to++ = unused;
  painted = here;
}
inline unsigned long deepest_stack() {
  const std::uint32_t* lowest = stack_end;
  if (*lowest != unused) return 999'999;  // all of it
  while (*lowest == unused) ++lowest;
  return static_cast<unsigned long>(painted - lowest) * 4;
}
#else
inline void start_timer() {}
inline void paint_stack() {}
inline unsigned long deepest_stack() { return 0; }
inline std::uint32_t ticks() { return 0; }
#endif

/// A line of words and whole numbers: the C library's printing is larger than the control loop.
class Line {
 public:
  Line& operator<<(std::string_view words) {
    for (const char c : words) put(c);
    return *this;
  }
  Line& operator<<(unsigned long number) { return digits(number, 10, 1); }
  Line& hexadecimal(std::uint32_t number) { return digits(number, 16, 8); }
  ~Line() {
    put('\n');
    text_[size_] = '\0';
    std::fputs(text_.data(), stdout);
  }

 private:
  void put(char c) {
    if (size_ + 1 < text_.size()) text_[size_++] = c;
  }
  Line& digits(unsigned long number, unsigned long base, int least) {
    std::array<char, 24> reversed{};
    int count = 0;
    for (; number > 0 || count < least; number /= base) {
      reversed[static_cast<std::size_t>(count++)] = "0123456789abcdef"[number % base];
    }
    while (count > 0) put(reversed[static_cast<std::size_t>(--count)]);
    return *this;
  }
  std::array<char, 160> text_{};
  std::size_t size_ = 0;
};

/// Period after period until the run has ended, and a line about it. `construction`: how deep the stack went before.
inline void run(std::string_view name, firmware::ControlLoop& loop, firmware::Journal& journal, hal::Clock& clock,
                [[maybe_unused]] unsigned long construction) {
  Hash hash;
  [[maybe_unused]] std::uint64_t counted = 0;  // instructions, on the board
  std::uint64_t periods = 0;
  paint_stack();
  loop.arm();
  loop.start();
  while (periods == 0 || loop.mode() != firmware::Mode::safe) {
    clock.sleep_until(loop.due());
    const std::uint32_t before = ticks();
    loop.step();
    counted += (ticks() - before) & 0xFFFFFFU;
    ++periods;
    while (const auto record = journal.pop()) {
      for (const double value : record->values) hash.take(value);
      hash.take(record->wheel_load);
      hash.take(record->velocities.body);
      hash.take(record->command.position);
      hash.take(record->openings.bits());
    }
  }
  [[maybe_unused]] const unsigned long deepest = deepest_stack();
  (Line() << name << " " << static_cast<unsigned long>(periods) << " periods, ended by "
          << firmware::name(loop.trip().reason) << ": ")
      .hexadecimal(static_cast<std::uint32_t>(hash.value() >> 32U))
      .hexadecimal(static_cast<std::uint32_t>(hash.value()));
#ifdef RIGTWIN_ON_BOARD
  // -icount shift=6 makes an instruction 64 ns, the timer's clock has 25 MHz: 1.6 ticks an instruction.
  Line() << "board: " << name << " " << static_cast<unsigned long>(counted * 5 / 8 / periods) << " instructions "
         << deepest << " bytes of stack, construction " << construction;
#endif
}

}  // namespace board
