// Runs of all rig kinds through the control loop, without files, heap or operating system, and a hash of every record:
// the same on a Cortex-M7 as on a PC. There it also says what a period costs, in instructions, and how much stack it
// took.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>

#include "firmware/control_loop.hpp"
#include "hal/simulated/rig.hpp"
#include "model/rig_model.hpp"
#include "model/road_filter.hpp"

namespace {

using Model = model::RigModel<double>;
using model::Channel;
constexpr double period = 1e-3;

/// The paper's rig with the project's FDVA.
model::RigParameters<double> paper_rig(model::RigKind kind) {
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

/// White noise by integers, twelve uniform numbers each: no logarithm, the same everywhere.
class Noise {
 public:
  double operator()() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005U + 1442695040888963407U;
      sum += static_cast<double>(state_ >> 11U) * 0x1p-53;
    }
    return sum;
  }

 private:
  std::uint64_t state_ = 1;
};

class Road final : public firmware::Reference {
 public:
  explicit Road(std::uint64_t samples) : filter_({256e-6, 27.78, 0.05, 30.0}, period), samples_(samples) {}

 private:
  std::optional<firmware::Motion> do_at(std::uint64_t sample) override {
    if (sample >= samples_) return std::nullopt;
    if (sample > 0) state_ = filter_.step(state_, 22.360679774997898 * noise_());
    return filter_.motion(state_);
  }
  model::RoadFilter<double> filter_;
  model::RoadFilter<double>::State state_ = model::RoadFilter<double>::State::Zero();
  Noise noise_;
  std::uint64_t samples_;
};

/// The rig's hardware. (Its own model: the control program's is a part of the loop.)
class Plant final : public hal::simulated::Plant {
 public:
  explicit Plant(const model::RigParameters<double>& rig)
      : model_(rig, period, rig.kind == model::RigKind::hil ? model::Extent::test_machine : model::Extent::whole_rig),
        state_(model_.start(0.0)) {}

 private:
  void do_measure(std::span<double, hal::channel_capacity> values) override {
    const auto measured = model_.measured(state_);
    for (std::size_t i = 0; i < measured.size(); ++i) values[i] = measured[i];
  }
  void do_advance(const hal::Command& command, hal::Openings openings) override {
    const auto open = static_cast<model::OpenDucts>(openings.bits());
    if (open != state_.ducts.open()) model_.open_ducts(state_, open);
    Model::Input in;
    in.foot_point = {command.position, command.velocity, command.acceleration};
    in.command = {command.position, command.velocity};
    model_.step(state_, in);
  }
  Model model_;
  Model::State state_;
};

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
volatile std::uint32_t& at(std::uintptr_t address) { return *reinterpret_cast<volatile std::uint32_t*>(address); }
void start_timer() {
  at(0xE000E014) = 0xFFFFFF;  // SysTick counts down at the CPU's clock
  at(0xE000E018) = 0;
  at(0xE000E010) = 5;
}
std::uint32_t ticks() { return 0xFFFFFFU - at(0xE000E018); }

// Whatever of the stack still has this pattern later has not been used.
constexpr std::uint32_t unused = 0xA5A5A5A5U;
std::uint32_t* painted = nullptr;  // from here down
[[gnu::noinline]] void paint_stack() {
  auto* here = static_cast<std::uint32_t*>(__builtin_frame_address(0)) - 64;
  for (std::uint32_t* to = stack_end; to < here;) *to++ = unused;
  painted = here;
}
unsigned long deepest_stack() {
  const std::uint32_t* lowest = stack_end;
  if (*lowest != unused) return 999'999;  // the stack went beyond its end, into what lies below
  while (*lowest == unused) ++lowest;
  return static_cast<unsigned long>(painted - lowest) * 4;
}
#else
void start_timer() {}
void paint_stack() {}
std::uint32_t ticks() { return 0; }
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

template <class T>
class Place {  // static storage, filled when it is its turn
 public:
  template <class... Arguments>
  T& make(const Arguments&... arguments) {
    value_.reset();
    return value_.emplace(arguments...);
  }

 private:
  std::optional<T> value_;
};

Place<Plant> plants;
Place<Road> roads;

void run(model::RigKind kind, firmware::ControlLoop& loop, firmware::Journal& journal, hal::simulated::Rig& rig) {
  Hash hash;
  [[maybe_unused]] std::uint64_t counted = 0;  // instructions, on the board
  std::uint64_t periods = 0;
  paint_stack();
  loop.start();
  const hal::Rig roles = rig.roles();
  while (periods == 0 || loop.mode() != firmware::Mode::safe) {
    roles.clock.sleep_until(loop.due());
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
#ifdef RIGTWIN_ON_BOARD
  const unsigned long deepest = deepest_stack();
#endif
  (Line() << model::name(kind) << " " << static_cast<unsigned long>(periods) << " periods, ended by "
          << firmware::name(loop.trip().reason) << ": ")
      .hexadecimal(static_cast<std::uint32_t>(hash.value() >> 32U))
      .hexadecimal(static_cast<std::uint32_t>(hash.value()));
#ifdef RIGTWIN_ON_BOARD
  // -icount shift=6 makes an instruction 64 ns, the timer's clock has 25 MHz: 1.6 ticks an instruction.
  Line() << "board: " << model::name(kind) << " " << static_cast<unsigned long>(counted * 5 / 8 / periods)
         << " instructions " << deepest << " bytes of stack";
#endif
}

void ride(model::RigKind kind) {
  const auto parameters = paper_rig(kind);
  Plant& plant = plants.make(parameters);
  hal::simulated::Construction construction;
  construction.period = hal::milliseconds(1);
  construction.ducts = 6;
  const auto fit = [&construction](Channel channel) { construction.sensors[model::index(channel)].fitted = true; };
  if (kind == model::RigKind::quarter_car) {
    for (const Channel c :
         {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b}) {
      fit(c);
    }
  } else {
    fit(Channel::F);
    fit(Channel::x_act);
  }
  hal::simulated::Rig rig(plant, construction);
  Road& road = roads.make(std::uint64_t{2000});
  static firmware::JournalStorage<2> storage;
  firmware::Journal journal(storage);
  const firmware::ValvePlan::Change changes[] = {{hal::milliseconds(500), hal::Openings::from_bits(0b101101)},
                                                 {hal::milliseconds(900), hal::Openings::from_bits(0)},
                                                 {hal::milliseconds(1200), hal::Openings::from_bits(0b111111)}};
  const firmware::ValvePlan valves(hal::Openings::first(2), changes);
  firmware::Settings settings;
  settings.limits.speed = 5.0;
  static std::optional<firmware::ControlLoop> loop;
  loop.reset();
  loop.emplace(settings, parameters, rig.roles(), road, valves, journal);
  run(kind, *loop, journal, rig);
}

}  // namespace

extern "C" int trace() {
  start_timer();
  for (const auto kind : {model::RigKind::hil, model::RigKind::quarter_car, model::RigKind::component_bench})
    ride(kind);
  return 0;
}

#ifndef RIGTWIN_ON_BOARD
int main() { return trace(); }
#endif
