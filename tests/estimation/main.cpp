// rigtwin_estimation [HOURS [SEED [CASE]]]: how often the innovation monitor calls a right model wrong; without hours what
// the wheel load of the Kalman filter is worth on roads that are not the described one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "firmware/loop/guards/command_guard.hpp"
#include "firmware/loop/kalman/kalman_filter.hpp"
#include "firmware/loop/kalman/steady_gains.hpp"
#include "model/components/road_filter.hpp"
#include "model/rig/rig_model.hpp"

namespace {

using firmware::EstimatorEquations;
using firmware::InnovationMonitor;
using firmware::KalmanFilter;
using firmware::SteadyGains;
using model::Channel;

constexpr double period = 1e-3, described_roughness = 64e-6, speed = 27.78, bandwidth = 30.0;

struct Sensor {
  Channel channel;
  double noise, range;
};
/// Noise and ranges of the paper's rig.
constexpr std::array<Sensor, 7> sensors{{{Channel::z_r, 2e-5, 1.0},
                                         {Channel::zdd_r, 0.05, 98.0},
                                         {Channel::zdd_w, 0.05, 98.0},
                                         {Channel::zdd_b, 0.05, 98.0},
                                         {Channel::F_w, 10.0, 1e4},
                                         {Channel::dz_w, 5e-5, 1.0},
                                         {Channel::dz_b, 5e-5, 1.0}}};

model::RigParameters<double> paper_car() {
  model::RigParameters<double> rig;
  rig.body.mass = 290.0;
  rig.wheel.mass = 40.0;
  rig.tyre = {200e3, 100.0};
  rig.suspension = {31500.0, 1140.0};
  return rig;
}

struct Filter {
  Filter(const std::vector<Channel>& channels, double roughness)
      : equations(settings(channels, roughness), paper_car()),
        gains(std::make_unique<SteadyGains>(equations, period)),
        filter(std::make_unique<KalmanFilter>(equations, *gains, period)) {}
  static firmware::KalmanSettings settings(const std::vector<Channel>& channels, double roughness) {
    firmware::KalmanSettings settings;
    settings.roughness = roughness;
    for (const Sensor& s : sensors) {
      if (std::find(channels.begin(), channels.end(), s.channel) != channels.end())
        settings.noise[model::index(s.channel)] = s.noise;
    }
    return settings;
  }
  EstimatorEquations equations;
  std::unique_ptr<SteadyGains> gains;
  std::unique_ptr<KalmanFilter> filter;
};

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  double uniform() { return uniform_(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_{};
  std::uniform_real_distribution<double> uniform_{};
};

std::vector<Channel> all_channels() {
  std::vector<Channel> list;
  for (const Sensor& s : sensors) list.push_back(s.channel);
  return list;
}

/// A foot point that follows a wish within 0.7 m/s, as the loop's guard lets it.
class LimitedFootPoint {
 public:
  LimitedFootPoint() : guard_(limits(), period, 0.0) {}
  model::Motion<double> follow(const model::Motion<double>& wanted, hal::Time now) {
    const auto verdict = guard_.judge({wanted.position, wanted.velocity, wanted.acceleration}, now);
    guard_.passed(verdict.command);
    limited_ += verdict.limited ? 1U : 0U;
    return {verdict.command.position, verdict.command.velocity, verdict.command.acceleration};
  }
  [[nodiscard]] std::uint64_t limited() const { return limited_; }

 private:
  static firmware::Limits limits() {
    firmware::Limits limits;
    limits.stroke = 100.0;  // a road at 0.05 Hz is let go where it wants to
    return limits;
  }
  firmware::CommandGuard guard_;
  std::uint64_t limited_ = 0;
};

struct Trouble {
  const char* name;
  double lost = 0.0;         ///< share of the samples of each channel
  bool bursts = false;       ///< a tenth of the time no channel for 20 ms
  bool limited = false;      ///< by the speed of the command
  double range_share = 1.0;  ///< of the accelerations' and the force's range
  double roughness = described_roughness;
};

/// Runs a right model and counts; the second monitor may call it wrong once an hour.
void false_alarms(const Trouble& trouble, double hours, std::uint64_t seed) {
  Filter made(all_channels(), trouble.roughness);
  InnovationMonitor often(made.equations.channels(), period, 1.0);
  const model::RigModel<> car(paper_car(), period);
  auto x = car.start(0.0);
  const model::RoadFilter<double> road({trouble.roughness, speed, 0.05, bandwidth}, period);
  auto on_road = model::RoadFilter<double>::State::Zero().eval();
  Normal normal(seed);
  LimitedFootPoint foot;
  const auto periods = static_cast<std::uint64_t>(hours * 3600.0 / period);
  std::uint64_t without = 0, innovations = 0, wide = 0;
  int burst = 0;
  double squares = 0.0;
  for (std::uint64_t k = 1; k <= periods; ++k) {
    on_road = road.step(on_road, normal() * std::sqrt(0.5 / period));
    const hal::Time now = hal::milliseconds(static_cast<std::int64_t>(k));
    auto motion = road.motion(on_road);
    if (trouble.limited) motion = foot.follow(motion, now);
    car.step(x, {.foot_point = motion});
    const auto truth = car.signals(x);
    hal::Frame frame;
    if (trouble.bursts && burst == 0 && normal.uniform() < 0.1 / 18.0) burst = 20;
    if (burst > 0) --burst;
    for (const Sensor& s : sensors) {
      const double value = truth[model::index(s.channel)] + s.noise * normal();
      const double range =
          s.range * (s.channel == Channel::z_r || s.channel == Channel::dz_w || s.channel == Channel::dz_b
                         ? 1.0
                         : trouble.range_share);
      if (burst > 0 || std::abs(value) >= range || (trouble.lost > 0.0 && normal.uniform() < trouble.lost)) {
        ++without;
        continue;
      }
      frame.channels[model::index(s.channel)] = {value, now, hal::Quality::good};
    }
    made.filter->step(frame, 0, now);
    squares += made.filter->nis();
    innovations += static_cast<std::uint64_t>(made.filter->innovations());
#ifdef RIGTWIN_OLD_FILTER
    const std::uint64_t wide_now = 0;
#else
    const std::uint64_t wide_now = made.filter->wide_periods();
#endif
    for (int i = 0; i < made.equations.channels(); ++i) {
      const double innovation = made.filter->innovation(i);
      if (innovation == 0.0) continue;
#ifndef RIGTWIN_OLD_FILTER
      if (wide_now != wide) {
        often.set_aside(i);
        continue;
      }
#endif
      often.take(i, innovation);
    }
    wide = wide_now;
  }
  std::printf("%-34s %5.1f h  %7.3f %7.3f %7.3f %7.3f  %5u  %5u  %8.1f\n", trouble.name, hours,
              100.0 * static_cast<double>(without) / static_cast<double>(periods * sensors.size()),
              100.0 * static_cast<double>(foot.limited()) / static_cast<double>(periods),
              100.0 * static_cast<double>(wide) / static_cast<double>(periods),
              squares / static_cast<double>(innovations), made.filter->monitor().alarms(), often.alarms(), hours * 1.0);
  std::fflush(stdout);
}

struct Drive {
  double error = 0.0, load = 0.0, wide = 0.0;
};
Drive drive(const std::vector<Channel>& channels, const std::function<model::Motion<double>(std::uint64_t)>& foot_point,
            const model::RigParameters<double>& rig, std::uint64_t seed, int periods) {
  Filter made(channels, described_roughness);
  const model::RigModel<> car(rig, period);
  auto x = car.start(0.0);
  Normal normal(seed + 77);
  Drive result;
  constexpr int settled = 5000;
  for (int k = 1; k <= periods; ++k) {
    const hal::Time now = hal::milliseconds(k);
    car.step(x, {.foot_point = foot_point(static_cast<std::uint64_t>(k))});
    const auto truth = car.signals(x);
    hal::Frame frame;
    for (const Sensor& s : sensors) {
      const double value = truth[model::index(s.channel)] + s.noise * normal();
      if (std::abs(value) >= s.range) continue;
      frame.channels[model::index(s.channel)] = {value, now, hal::Quality::good};
    }
    made.filter->step(frame, 0, now);
    if (k <= settled) continue;
    const double load = truth[model::index(Channel::F_w)];
    result.error += std::pow(made.filter->wheel_load() - load, 2);
    result.load += load * load;
  }
  result.error = std::sqrt(result.error / (periods - settled));
  result.load = std::sqrt(result.load / (periods - settled));
#ifndef RIGTWIN_OLD_FILTER
  result.wide = static_cast<double>(made.filter->wide_periods()) / periods;
#endif
  return result;
}

struct Shape {
  std::string name;
  double roughness = described_roughness, bandwidth = 30.0;
  std::function<model::Motion<double>(double)> added{};  ///< beside the road
  bool limited = false;
  double wheel_guide = 0.0;
};

model::Motion<double> versine(double t, double depth, double length) {
  const double w = 2.0 * std::numbers::pi / length;
  if (t < 0.0 || t > length) return {};
  return {-0.5 * depth * (1.0 - std::cos(w * t)), -0.5 * depth * w * std::sin(w * t),
          -0.5 * depth * w * w * std::cos(w * t)};
}

void roads(std::uint64_t seed) {
  const std::vector<std::pair<const char*, std::vector<Channel>>> sets{
      {"all", all_channels()},
      {"without zdd_r", {Channel::z_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b}},
      {"z_r, zdd_r", {Channel::z_r, Channel::zdd_r, Channel::zdd_w, Channel::zdd_b}},
      {"dz_b, zdd_b, zdd_w", {Channel::dz_b, Channel::zdd_b, Channel::zdd_w}}};
  std::vector<Shape> shapes;
  for (const auto& [name, g] : {std::pair{"A", 16e-6}, {"B", 64e-6}, {"C", 256e-6}, {"D", 1024e-6}, {"E", 4096e-6}})
    shapes.push_back({.name = std::string("class ") + name + ", 30 Hz", .roughness = g});
  for (const double f : {5.0, 15.0, 60.0, 100.0, 200.0})
    shapes.push_back({.name = "class B, " + std::to_string(static_cast<int>(f)) + " Hz", .bandwidth = f});
  shapes.push_back({.name = "class B, 30 Hz, potholes 40 mm, 50 ms",
                    .added = [](double t) { return versine(std::fmod(t, 4.0) - 2.0, 0.04, 0.05); }});
  shapes.push_back({.name = "class A, 30 Hz, potholes 30 mm, 20 ms", .roughness = 16e-6, .added = [](double t) {
                      return versine(std::fmod(t, 4.0) - 2.0, 0.03, 0.02);
                    }});
  shapes.push_back({.name = "class B, steps of 20 mm at 0.7 m/s",
                    .added =
                        [](double t) {
                          const double s = std::fmod(t, 8.0) - 4.0;  // up, 4 s later down
                          return model::Motion<double>{s < 0.0 ? 0.02 : 0.0, 0.0, 0.0};
                        },
                    .limited = true});
  shapes.push_back({.name = "class C, limited to 0.7 m/s", .roughness = 256e-6, .limited = true});
  shapes.push_back({.name = "class B, wheel guide friction 30 N", .wheel_guide = 30.0});
  std::printf("%-40s %9s", "road", "F_w [N]");
  for (const auto& [name, set] : sets) std::printf("  %18s", name);
  std::printf("\n");
  for (const Shape& shape : shapes) {
    std::string line;
    double load = 0.0;
    for (const auto& [name, set] : sets) {
      const model::RoadFilter<double> road({shape.roughness, speed, 0.05, shape.bandwidth}, period);
      auto on_road = model::RoadFilter<double>::State::Zero().eval();
      Normal normal(seed);
      LimitedFootPoint foot;
      auto rig = paper_car();
      if (shape.wheel_guide > 0.0) rig.effects.add(model::WheelGuideFriction<double>{shape.wheel_guide});
      const Drive d = drive(
          set,
          [&](std::uint64_t k) {
            on_road = road.step(on_road, normal() * std::sqrt(0.5 / period));
            auto motion = road.motion(on_road);
            if (shape.added) {
              const auto more = shape.added(static_cast<double>(k) * period);
              motion = {motion.position + more.position, motion.velocity + more.velocity,
                        motion.acceleration + more.acceleration};
            }
            if (shape.limited) motion = foot.follow(motion, hal::milliseconds(static_cast<std::int64_t>(k)));
            return motion;
          },
          rig, seed, 60'000);
      char text[64];
      std::snprintf(text, sizeof text, "  %9.2f (%5.1f %%)", d.error, 100.0 * d.wide);
      line += text;
      load = d.load;
    }
    std::printf("%-40s %9.1f%s\n", shape.name.c_str(), load, line.c_str());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** arguments) {
  const double hours = count > 1 ? std::atof(arguments[1]) : 0.0;
  const std::uint64_t seed = count > 2 ? static_cast<std::uint64_t>(std::atoll(arguments[2])) : 1;
  if (hours <= 0.0) {
    roads(seed);
    return 0;
  }
  const std::vector<Trouble> troubles{{.name = "none"},
                                      {.name = "10 % of the samples lost", .lost = 0.1},
                                      {.name = "20 ms without samples, 10 %", .bursts = true},
                                      {.name = "command limited, class B", .limited = true},
                                      {.name = "command limited, class C", .limited = true, .roughness = 256e-6},
                                      {.name = "saturated", .range_share = 0.2},
                                      {.name = "all of them, class C",
                                       .lost = 0.1,
                                       .bursts = true,
                                       .limited = true,
                                       .range_share = 0.4,
                                       .roughness = 256e-6}};
  const std::size_t only = count > 3 ? static_cast<std::size_t>(std::atoi(arguments[3])) : troubles.size();
  for (std::size_t i = 0; i < troubles.size(); ++i) {
    if (only == troubles.size() || only == i) false_alarms(troubles[i], hours, seed + i);
  }
  return 0;
}
