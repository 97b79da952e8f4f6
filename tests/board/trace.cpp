// Runs of all rig kinds through the control loop and the simulated rig, without files, heap or operating system, and a
// hash of every record: the same on a Cortex-M7 as on a PC. There it also says what a period costs, in instructions.
#include <optional>

#include "hal/simulated/rig.hpp"
#include "model/components/road_filter.hpp"
#include "tests/board/run.hpp"

namespace {

using Model = model::RigModel<double>;
constexpr double period = 1e-3;

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
  Road() : filter_({256e-6, 27.78, 0.05, 30.0}, period) {}

 private:
  std::optional<firmware::Motion> do_at(std::uint64_t sample) override {
    if (sample >= board::samples) return std::nullopt;
    if (sample > 0) state_ = filter_.step(state_, 22.360679774997898 * noise_());
    return filter_.motion(state_);
  }
  model::RoadFilter<double> filter_;
  model::RoadFilter<double>::State state_ = model::RoadFilter<double>::State::Zero();
  Noise noise_;
};

/// The rig's hardware. (Its own model: the control program's is a part of the loop.)
class Plant final : public hal::simulated::Plant {
 public:
  explicit Plant(const model::RigParameters<double>& rig)
      : model_(rig, period,
               rig.kind == model::RigKind::hil ? model::ModelledPart::test_machine : model::ModelledPart::whole_rig),
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

void ride(model::RigKind kind) {
  board::paint_stack();
  static std::optional<Plant> plant;
  static std::optional<Road> road;
  static std::optional<hal::simulated::Rig> rig;
  static std::optional<firmware::ControlLoop> loop;
  const auto parameters = board::paper_rig(kind);
  hal::simulated::Construction construction;
  construction.period = hal::milliseconds(1);
  construction.ducts = 6;
  board::fit_sensors(kind, [&](model::Channel c) { construction.sensors[model::index(c)].fitted = true; });
  rig.emplace(plant.emplace(parameters), construction);
  static firmware::JournalStorage<2> storage;
  firmware::Journal journal(storage);
  firmware::Settings settings;
  settings.limits.speed = 5.0;
  loop.emplace(settings, parameters, rig->roles(), road.emplace(), board::valves, journal);
  const unsigned long deepest = board::deepest_stack();
  board::run(model::name(kind), *loop, journal, rig->roles().clock, deepest);
}

}  // namespace

extern "C" int trace() {
  board::start_timer();
  for (const auto kind : {model::RigKind::hil, model::RigKind::quarter_car, model::RigKind::component_bench})
    ride(kind);
  return 0;
}

#ifndef RIGTWIN_ON_BOARD
int main() { return trace(); }
#endif
