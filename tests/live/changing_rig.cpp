#include "tests/live/changing_rig.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/simulation/gaussian.hpp"
#include "firmware/simulation/road.hpp"
#include "model/rig/rig_model.hpp"

namespace sample {

using model::Channel;
using model::RigKind;

namespace {

constexpr std::string_view plain_car = R"(
[body]
mass = 290.0
[wheel]
mass = 40.0
[tyre]
stiffness = 200e3
damping = 100.0
)";

/// The channels that a rig of this kind records.
std::vector<Channel> recorded(RigKind kind) {
  switch (kind) {
    case RigKind::quarter_car:
      return {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::dz_w, Channel::dz_b, Channel::F_w};
    case RigKind::hil:
      return {Channel::z_r, Channel::z_w, Channel::z_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F};
    default:
      return {Channel::x_cmd, Channel::x_act, Channel::F};
  }
}

constexpr std::string_view oil = R"(
[fdva]
piston_area = 30e-4
duct_diameter = 12e-3
duct_length = 0.6361571127
oil_density = 860.0
oil_viscosity = 32e-6
minor_loss = 1.5
coupling_stiffness = 55e3
ducts = 6
open_ducts = 2
)";

double delay_of(const model::RigParameters<double>& rig) {
  model::MachinePath<double> machine{};
  rig.effects.act_on(machine);
  return machine.delay;
}

}  // namespace

void drive(const firmware::RigDescription& description, const Run& run,
           const std::function<void(const host_sim::live::LiveSample&)>& take) {
  model::RigParameters<double> before = description.rig;
  if (run.from_the_beginning) run.from_the_beginning(before);
  model::RigParameters<double> after = before;
  if (run.change) run.change(after);
  const double rate = description.sample_rate, period = 1.0 / rate;
  firmware::IsoRoad road;
  road.seed = run.seed;
  road.speed = run.speed;
  road.bandwidth = firmware::default_bandwidth(before, rate);
  const auto count = static_cast<std::size_t>(std::lround(run.duration * rate));
  firmware::FootPointMotion ground = firmware::drive_over(road, rate, count);
  constexpr double pi = 3.14159265358979324;
  for (std::size_t k = 0; k < count; ++k) {
    const double u = std::clamp((static_cast<double>(k) * period - 0.5 * run.duration) / 10.0, 0.0, 1.0);
    const double change = run.level - 1.0, slow = pi / 10.0;
    const double level = 1.0 + change * 0.5 * (1.0 - std::cos(pi * u)), rises = change * 0.5 * slow * std::sin(pi * u);
    auto& m = ground[k];
    m = {level * m.position, level * m.velocity + rises * m.position,
         level * m.acceleration + 2.0 * rises * m.velocity};
  }
  const firmware::FootPointMotion motion = firmware::excitation(description.rig, ground, rate);
  const model::RigModel<> healthy(before, period), changed(after, period);
  const bool bench = before.kind == RigKind::component_bench;
  auto x = healthy.start(bench ? 0.0 : motion[0].position, bench ? motion[0].position : 0.0);
  auto shadow = x;
  firmware::Gaussian gaussian(run.seed, 7);
  const auto from = static_cast<std::size_t>(std::lround(run.changes_at * rate));
  for (std::size_t k = 0; k < count; ++k) {
    model::Signals<double> noise{};
    for (std::size_t c = 0; c < noise.size(); ++c) {
      if (description.noise[c]) noise[c] = *description.noise[c] * gaussian();
    }
    // The delay lines and filters of the changed sensors have lived through the last half second.
    if (k + 500 == from) {
      shadow = x;
      shadow.sensors = changed.start().sensors;
    }
    if (k == from) x.sensors = shadow.sensors;
    const model::RigModel<>& now = k < from ? healthy : changed;
    if (k == from && delay_of(after) != delay_of(before)) now.set_delay(x, delay_of(after));
    const model::RigModel<>::Input input{
        .foot_point = motion[k], .command = {motion[k].position, motion[k].velocity}, .noise = &noise};
    if (k > 0) now.step(x, input);
    if (k < from && k + 500 >= from) changed.step(shadow, input);
    const auto measured = now.measured(x, &noise);
    host_sim::live::LiveSample sample;
    sample.time = static_cast<double>(k) * period;
    for (const Channel channel : recorded(before.kind)) sample.values[index(channel)] = measured[index(channel)];
    if (bench) sample.values[index(Channel::x_cmd)] = motion[k].position;
    if (run.reader && k >= from) run.reader(sample);
    take(sample);
  }
}

std::vector<host_sim::live::Finding> diagnosed(const firmware::RigDescription& rig, const Run& run) {
  host_sim::live::LiveDiagnosis diagnosis(rig);
  drive(rig, run, [&](const host_sim::live::LiveSample& sample) { static_cast<void>(diagnosis.push(sample)); });
  return diagnosis.findings();
}

namespace {

firmware::RigDescription described_car(std::string_view damper) {
  return firmware::parse_rig(
      "kind = \"quarter_car\"\nsample_rate = 1000.0\n" + std::string(plain_car) + std::string(damper) + R"(
[suspension]
stiffness = 31500.0
damping = 1140.0
[noise]
z_r = 2e-5
zdd_r = 0.05
zdd_w = 0.05
zdd_b = 0.05
F_w = 10.0
dz_w = 5e-5
dz_b = 5e-5
)",
      "quarter_car.toml");
}

firmware::RigDescription described_hil(std::string_view damper) {
  return firmware::parse_rig(
      "kind = \"hil\"\nsample_rate = 1000.0\n" + std::string(plain_car) + std::string(damper) + R"(
[suspension]
stiffness = 31500.0
damping = 0.0
[machine]
virtual_damping = 1140.0
[effects.actuator_delay]
delay = 0.004
[noise]
F = 10.0
x_act = 2e-5
)",
      "hil.toml");
}

}  // namespace

firmware::RigDescription quarter_car() { return described_car(""); }
firmware::RigDescription quarter_car_fdva() { return described_car(oil); }
firmware::RigDescription hil() { return described_hil(""); }
firmware::RigDescription hil_fdva() { return described_hil(oil); }

firmware::RigDescription component_bench() {
  return firmware::parse_rig(R"(kind = "component_bench"
sample_rate = 1000.0
[suspension]
stiffness = 31500.0
damping = 1140.0
[noise]
F = 10.0
x_act = 2e-5
)",
                             "component_bench.toml");
}

}  // namespace sample
