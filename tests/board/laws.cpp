// Laws from tables on a board: the model of every kind of rig with a damper's curve, a surface, branches with memory
// and a sensor's curve, step by step, and a hash of every measured value: the same on a Cortex-M7 as on a PC. This
// program says how much room it wants (room, below); laws.ld holds it to a budget of its own.
#include <algorithm>
#include <optional>

#include "model/rig/rig_model.hpp"
#include "tests/board/run.hpp"

namespace {

/// What a rig under test has: damper and stop, a bush over deflection and velocity, three branches.
constexpr model::LawCapacity room{.curves = 3, .surfaces = 1, .branches = 3};
constexpr std::size_t longest_delay = 16;  // [samples]
constexpr double period = 1e-3;

using Model = model::RigModel<double, longest_delay, model::ModelVariant::every_part, room>;
using Rig = Model::Rig;

model::CurveTable<double> curve(model::LawPlace place, model::LawOver over, std::initializer_list<double> at,
                                std::initializer_list<double> value) {
  model::CurveTable<double> table;
  table.place = place;
  table.over = over;
  table.count = static_cast<std::uint8_t>(at.size());
  std::copy(at.begin(), at.end(), table.at.begin());
  std::copy(value.begin(), value.end(), table.value.begin());
  return table;
}

/// The paper's rig with laws at every place that its kind has.
Rig rig_with_laws(model::RigKind kind) {
  Rig rig;
  rig.kind = kind;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 200.0};
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  auto& laws = rig.laws;
  laws.curves[laws.curve_count++] =
      curve(model::LawPlace::suspension, model::LawOver::velocity, {-1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0},
            {-1900.0, -900.0, -350.0, 0.0, 200.0, 500.0, 1100.0});
  laws.curves[laws.curve_count++] = curve(model::LawPlace::suspension, model::LawOver::deflection,
                                          {-0.02, -0.01, 0.0, 0.01, 0.02}, {-1500.0, -100.0, 0.0, 100.0, 1500.0});
  auto sensor = curve(model::LawPlace::sensor, model::LawOver::deflection, {-5e3, 0.0, 5e3}, {-4.9e3, 0.0, 5.05e3});
  sensor.channel = kind == model::RigKind::quarter_car ? model::Channel::F_w : model::Channel::F;
  laws.curves[laws.curve_count++] = sensor;
  auto& surface = laws.surfaces[laws.surface_count++];
  surface.rows = 3;
  surface.columns = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    surface.deflection[i] = 0.02 * (static_cast<double>(i) - 1.0);
    surface.velocity[i] = 0.5 * (static_cast<double>(i) - 1.0);
  }
  for (std::size_t i = 0; i < 3; i += 2) surface.value[i] = {-60.0, 0.0, 60.0};
  auto& branches = laws.branches;
  branches[laws.branch_count++] = {.stiffness = 20e3, .slip_force = 60.0};
  branches[laws.branch_count++] = {.stiffness = 30e3, .slip_force = 25.0, .gap = 1e-3};
  branches[laws.branch_count++] = {.stiffness = 8e3, .time_constant = 0.02};
  return rig;
}

/// Foot point or command: 1.2 and 7 Hz, each a pointer that turns by the same angle every sample.
class Waves {
 public:
  model::Motion<double> next() {
    model::Motion<double> motion{};
    for (Wave& w : waves_) {
      const double cosine = w.cosine * w.turn_cosine - w.sine * w.turn_sine;
      w.sine = w.sine * w.turn_cosine + w.cosine * w.turn_sine;
      w.cosine = cosine;
      motion.position += w.amplitude * w.sine;
      motion.velocity += w.amplitude * w.omega * w.cosine;
      motion.acceleration -= w.amplitude * w.omega * w.omega * w.sine;
    }
    return motion;
  }

 private:
  struct Wave {
    double amplitude, omega, turn_cosine, turn_sine;
    double cosine = 1.0, sine = 0.0;
  };
  std::array<Wave, 2> waves_{{{10e-3, 7.5398223686155035, 0.99997157567, 0.00753975092},
                              {2e-3, 43.982297150257104, 0.99903295476, 0.04396811802}}};
};

void ride(model::RigKind kind) {
  static std::optional<Model> rig;
  static std::optional<Model::State> state;
  board::paint_stack();
  rig.emplace(rig_with_laws(kind), period, model::ModelledPart::whole_rig);
  state.emplace(rig->start(0.0));
  const unsigned long construction = board::deepest_stack();
  Waves waves;
  board::Hash hash;
  std::uint64_t counted = 0;
  board::paint_stack();
  for (std::uint64_t k = 0; k < board::samples; ++k) {
    Model::Input in;
    in.foot_point = waves.next();
    in.command = {in.foot_point.position, in.foot_point.velocity};
    const std::uint32_t before = board::ticks();
    rig->step(*state, in);
    counted += (board::ticks() - before) & 0xFFFFFFU;
    for (const double value : rig->measured(*state)) hash.take(value);
  }
  const unsigned long deepest = board::deepest_stack();
  board::Line line;
  line << model::name(kind) << " ";
  line.hexadecimal(static_cast<std::uint32_t>(hash.value() >> 32U))
      .hexadecimal(static_cast<std::uint32_t>(hash.value()));
#ifdef RIGTWIN_ON_BOARD
  board::Line() << "board: " << model::name(kind) << " " << static_cast<unsigned long>(counted * 5 / 8 / board::samples)
                << " instructions " << deepest << " bytes of stack, construction " << construction;
#else
  static_cast<void>(construction + deepest + counted);
#endif
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
