// The control loop around a rig that is the model itself, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/loop/control_loop.hpp"
#include "hal/simulated/rig.hpp"
#include "model/rig/rig_model.hpp"

namespace rig_under_test {

using Parameters = model::RigParameters<double>;
using firmware::Motion;
using firmware::Record;
using model::Channel;

inline constexpr double h = 1e-3;
inline constexpr hal::Time ms = hal::milliseconds(1);
inline constexpr double half_stroke = 0.125, speed_limit = 0.7;  ///< of the settings' own limits
inline constexpr double two_pi = 6.283185307179586;

/// The paper's rig with the project's FDVA, of any kind.
inline Parameters paper_rig(model::RigKind kind) {
  Parameters p;
  p.kind = kind;
  if (kind != model::RigKind::component_bench) {
    p.body.mass = 290.0;
    p.wheel.mass = 40.0;
    p.tyre.stiffness = 200e3;
    p.tyre.damping = 100.0;
  }
  if (kind == model::RigKind::hil) p.machine.virtual_damping = 1140.0;
  p.suspension.stiffness = 31.5e3;
  p.suspension.damping = kind == model::RigKind::quarter_car ? 1140.0 : 0.0;
  p.has_fdva = true;
  p.fdva.piston_area = 30e-4;
  p.fdva.duct_diameter = 12e-3;
  p.fdva.duct_length = 0.6361571127;
  p.fdva.oil_density = 860.0;
  p.fdva.oil_viscosity = 32e-6;
  p.fdva.minor_loss = 1.5;
  p.fdva.coupling_stiffness = 55e3;
  p.fdva.ducts = 6;
  p.fdva.open_ducts = 2;
  return p;
}

/// What is not as described about the sensors of x_act, z_r and F.
struct Deviations {
  double position_sign = 1.0;
  double position_offset = 0.0;  ///< [m]
  double force_sign = 1.0;
  double force_offset = 0.0;                           ///< [N]
  double force_noise = 0.0;                            ///< rectangular, peak [N]
  std::uint64_t force_torn_after = ~std::uint64_t{0};  ///< so many samples: nothing but noise [samples]
};

/// Something in the way of the drive of a bench, beyond a place on one side, from a sample on; it is pressed like a spring.
struct Obstacle {
  double place = 0.0;       ///< away from the middle on the side of its sign [m]
  double stiffness = 0.0;   ///< [N/m]; 0: nothing
  std::uint64_t after = 0;  ///< [samples]

  [[nodiscard]] double force(double position) const {
    const double side = place < 0.0 ? -1.0 : 1.0, way = side * (position - place);
    return way > 0.0 ? side * stiffness * way : 0.0;
  }
};

/// The model as the plant of the simulated back-end.
class ModelPlant final : public hal::simulated::Plant {
 public:
  using Model = model::RigModel<double>;

  ModelPlant(const Parameters& parameters, double rest, const Deviations& deviations = {},
             const Obstacle& obstacle = {}, double period = h)
      : deviations_(deviations),
        obstacle_(obstacle),
        model_(parameters, period,
               parameters.kind == model::RigKind::hil ? model::ModelledPart::test_machine
                                                      : model::ModelledPart::whole_rig),
        state_(parameters.kind == model::RigKind::quarter_car ? model_.start(rest) : model_.start(0.0, rest)) {}

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Model::State& state() const { return state_; }
  /// What the load cell carries, whatever it shows: F, of a quarter car F_w [N].
  [[nodiscard]] double force() const {
    const auto measured = model_.measured(state_);
    return measured[model::index(force_channel())] + met(measured[model::index(Channel::x_act)]);
  }

 private:
  [[nodiscard]] Channel force_channel() const {
    return model_.parameters().kind == model::RigKind::quarter_car ? Channel::F_w : Channel::F;
  }
  /// What the obstacle adds at the instant that was measured last.
  [[nodiscard]] double met(double position) const {
    const bool there = obstacle_.stiffness > 0.0 && measured_ > obstacle_.after;
    return there ? obstacle_.force(position) : 0.0;
  }

  void do_measure(std::span<double, hal::channel_capacity> values) override {
    const auto measured = model_.measured(state_);
    std::copy(measured.begin(), measured.end(), values.begin());
    const bool torn = measured_++ >= deviations_.force_torn_after;
    double& force = values[model::index(force_channel())];
    force += met(measured[model::index(Channel::x_act)]);
    for (const Channel c : {Channel::x_act, Channel::z_r}) {
      values[model::index(c)] = deviations_.position_sign * values[model::index(c)] + deviations_.position_offset;
    }
    drawn_ = drawn_ * 6364136223846793005U + 1442695040888963407U;
    const double noise = 2.0 * static_cast<double>(drawn_ >> 11U) / 9007199254740992.0 - 1.0;
    force = (torn ? 0.0 : deviations_.force_sign * force + deviations_.force_offset) + deviations_.force_noise * noise;
  }
  void do_advance(const hal::Command& command, hal::Openings openings) override {
    Model::Input in;
    in.foot_point = {command.position, command.velocity, command.acceleration};
    in.command = {command.position, command.velocity};
    if (model_.parameters().has_fdva) model_.open_ducts(state_, static_cast<model::OpenDucts>(openings.bits()));
    model_.step(state_, in);
  }

  Deviations deviations_;
  Obstacle obstacle_;
  std::uint64_t drawn_ = 1;
  std::uint64_t measured_ = 0;
  Model model_;
  Model::State state_;
};

/// A road that begins at rest and without a jump of its acceleration: Σ a_i (1 − cos ω_i t)², 0.8 and 6.5 Hz and twice
/// that, `samples` long.
inline std::vector<Motion> road(std::size_t samples, double scale = 1.0, double begin = 0.0, double period = h) {
  std::vector<Motion> motions;
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = period * static_cast<double>(k);
    Motion m{begin, 0.0, 0.0};
    for (const auto& [amplitude, f] : {std::pair{2e-3, 0.8}, std::pair{0.2e-3, 6.5}}) {
      const double a = scale * amplitude, w = two_pi * f;
      const double cosine = std::cos(w * t), sine = std::sin(w * t), hill = 1.0 - cosine;
      m.position += a * hill * hill;
      m.velocity += 2.0 * a * w * hill * sine;
      m.acceleration += 2.0 * a * w * w * (sine * sine + hill * cosine);
    }
    motions.push_back(m);
  }
  return motions;
}

inline hal::SensorSetup sensors_of(model::RigKind kind) {
  hal::SensorSetup setup;
  const auto fit = [&setup](Channel channel, double limit) { setup[model::index(channel)] = {true, -limit, limit}; };
  if (kind == model::RigKind::quarter_car) {
    fit(Channel::z_r, 0.1375);
    for (const Channel c : {Channel::zdd_r, Channel::zdd_w, Channel::zdd_b}) fit(c, 98.0);
    fit(Channel::F_w, 10e3);
    for (const Channel c : {Channel::dz_w, Channel::dz_b}) fit(c, 0.125);
  } else {
    fit(Channel::x_act, 0.125);
    fit(Channel::F, 30e3);
  }
  return setup;
}

/// Everything that a run is made of; change it before the run is built.
struct Scene {
  explicit Scene(model::RigKind kind, std::size_t samples = 1000)
      : parameters(paper_rig(kind)), sensors(sensors_of(kind)), reference(road(samples)) {}

  Parameters parameters;
  firmware::Settings settings{};
  hal::SensorSetup sensors;
  std::vector<Motion> reference;
  firmware::ValvePlan valves{hal::Openings::first(2)};
  hal::simulated::FaultPlan faults{};
  hal::Openings safe_position = hal::Openings::first(6);
  hal::Time watchdog = hal::milliseconds(20);
  std::size_t journal = 64;
  bool drive_enable = true;          ///< the drive stands still without it
  bool enable_feedback = false;      ///< a contact shows its power
  bool high_pressure = false;        ///< its power unit has a second stage
  std::optional<double> drive_at{};  ///< where the drive stands at first; nothing: at rest
  Deviations deviations{};
  Obstacle obstacle{};
};

/// A scene come to life.
class Journey {
 public:
  explicit Journey(const Scene& s)
      : scene(s),
        plant(scene.parameters, scene.drive_at.value_or(scene.settings.ramps.rest), scene.deviations, scene.obstacle,
              scene.settings.period.seconds()),
        rig(plant, construction(scene), scene.faults),
        reference(scene.reference),
        storage(scene.journal),
        journal(storage),
        loop(scene.settings, scene.parameters, rig.roles(), reference, scene.valves, journal) {}

  /// So many periods on the rig's clock, the journal read after each.
  void periods(std::size_t count) {
    loop.run([&] {
      drain();
      return count-- > 0;
    });
  }

  /// Started, and run until the rig is at rest in safe again (or for 20 s, which no test takes).
  void whole() {
    loop.arm();
    loop.start();
    periods(1);
    for (int i = 0; i < 20'000 && !(loop.mode() == firmware::Mode::safe && loop.at_rest()); ++i) periods(1);
  }

  [[nodiscard]] std::vector<Record> rows(firmware::Mode mode) const {
    std::vector<Record> selected;
    std::copy_if(records.begin(), records.end(), std::back_inserter(selected),
                 [mode](const Record& record) { return record.mode == mode; });
    return selected;
  }

  Scene scene;
  ModelPlant plant;
  hal::simulated::Rig rig;
  firmware::TableReference reference;
  std::vector<Record> storage;
  firmware::Journal journal;
  firmware::ControlLoop loop;
  std::vector<Record> records;

 private:
  static hal::simulated::Construction construction(const Scene& scene) {
    hal::simulated::Construction c;
    c.period = scene.settings.period;
    c.sensors = scene.sensors;
    c.ducts = 6;
    c.safe_position = scene.safe_position;
    c.watchdog = scene.watchdog;
    c.rest = {scene.drive_at.value_or(scene.settings.ramps.rest), 0.0, 0.0};
    c.drive_enable = scene.drive_enable;
    c.enable_feedback = scene.enable_feedback;
    c.high_pressure = scene.high_pressure;
    c.interlocks = 2;
    return c;
  }
  void drain() {
    while (const auto record = journal.pop()) records.push_back(*record);
  }
};

/// What holds after every trip, whatever it was.
inline void expect_safe_end(const Journey& run) {
  EXPECT_EQ(run.loop.mode(), firmware::Mode::safe);
  EXPECT_TRUE(run.loop.at_rest());
  EXPECT_EQ(run.rig.openings(), run.scene.safe_position);
  double last = run.scene.settings.ramps.rest;
  bool tripped = false;
  for (const Record& row : run.records) {
    EXPECT_FALSE(tripped && row.mode == firmware::Mode::running) << "running again after a trip";
    if (row.trip.reason != firmware::Reason::none) {
      tripped = true;
      EXPECT_EQ(row.openings, run.scene.safe_position) << "from the very period of the trip";
    }
    EXPECT_LE(std::abs(row.command.position), half_stroke);
    EXPECT_LE(std::abs(row.command.position - last), speed_limit * h * (1.0 + 1e-9)) << row.period;
    last = row.command.position;
  }
  EXPECT_TRUE(tripped);
}

/// The largest step of the drive in so many periods [m].
inline double largest_step(Journey& run, int periods) {
  double largest = 0.0, last = run.rig.drive().position;
  for (int k = 0; k < periods; ++k) {
    run.periods(1);
    largest = std::max(largest, std::abs(run.rig.drive().position - last));
    last = run.rig.drive().position;
  }
  return largest;
}

inline double value(const Record& record, Channel channel) { return record.values[model::index(channel)]; }

}  // namespace rig_under_test
