// Rigs whose description does not say everything, or not rightly.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/truth/random.hpp"
#include "tests/truth/recorder.hpp"
#include "tests/truth/truth.hpp"

namespace truth {
namespace {

using Channels = std::vector<std::string>;

/// How many effects hide, on which kinds of rig, and what else must hold for a truth to be taken.
struct Base {
  std::string kinds = "qhb";
  int effects = 0;
  Wanted wanted;
  std::function<bool(const Truth&)> fits;
  bool one_record = false;  ///< from rest
};

template <typename T>
const T& one_of(const std::vector<T>& values, Random& random) {
  return values[static_cast<std::size_t>(random.below(static_cast<int>(values.size())))];
}

bool hides(const Truth& truth, const std::set<std::string>& names) {
  return std::any_of(truth.effects.begin(), truth.effects.end(),
                     [&](const Effect& effect) { return names.contains(effect.name); });
}

/// Whether each effect shows in the channels that are recorded, by three times their noise.
bool every_effect_shows(const Truth& truth) {
  Truth glance = truth;
  RecordPlan plan = truth.records.front();
  plan.duration = 4.0;
  plan.warm = 0.0;
  glance.records = {plan};
  glance.rough.recorder.clear();
  const Fineness coarse{5, false};
  const Record with = simulate(glance, coarse).front();
  for (const Effect& effect : truth.effects) {
    Truth without = glance;
    std::erase_if(without.effects,
                  [&](const Effect& e) { return e.name == effect.name && e.channel == effect.channel; });
    const Record other = simulate(without, coarse).front();
    double largest = 0.0;
    for (const std::string& channel : recorded_channels(truth)) {
      const auto noise = truth.noise.find(channel);
      if (noise == truth.noise.end()) continue;
      const std::vector<double>& a = with.channels.at(channel);
      const std::vector<double>& b = other.channels.at(channel);
      double power = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) power += (a[i] - b[i]) * (a[i] - b[i]);
      largest = std::max(largest, std::sqrt(power / static_cast<double>(a.size())) / noise->second);
    }
    if (largest < 3.0) return false;
  }
  return true;
}

Truth drawn(const std::string& group, std::uint64_t seed, const Base& base) {
  Truth truth = draw(group, seed, base.wanted);
  if (base.one_record) {
    truth.records.resize(1);
    truth.records.front().warm = 0.0;
  }
  return truth;
}

Truth drawn(const Base& base, Random& random) {
  static const std::vector<std::string> names{"none", "single", "pair", "triple", "quadruple", "quintuple"};
  for (int tries = 0; tries < 200; ++tries) {
    const char kind = base.kinds[static_cast<std::size_t>(random.below(static_cast<int>(base.kinds.size())))];
    const std::string where = kind == 'q' ? "quarter_car" : (kind == 'h' ? "hil" : "component_bench");
    Truth truth = drawn(names[static_cast<std::size_t>(base.effects)] + ":" + where, random.next() % 1000000U, base);
    if (!base.fits || base.fits(truth)) return truth;
  }
  throw std::runtime_error("no rig fits");
}

/// Channels with noise: those that a sensor measures.
Channels measured(const Truth& truth) {
  Channels all;
  for (const std::string& channel : recorded_channels(truth))
    if (truth.noise.contains(channel)) all.push_back(channel);
  return all;
}

/// Some of the channels, `least` at least; not all if `proper`, where there are more than that.
Channels some(const Channels& all, bool proper, Random& random, std::size_t least = 1) {
  Channels chosen;
  while (chosen.size() < least || (proper && chosen.size() == all.size() && all.size() > least)) {
    chosen.clear();
    for (const std::string& channel : all)
      if (random.chance(0.5)) chosen.push_back(channel);
  }
  return chosen;
}

Truth noise_wrong(Base base, Random& random) {
  Truth truth = drawn(base, random);
  for (const auto& [channel, rms] : truth.noise) {
    const double factor = random.logarithmic(1.0 / 3.0, 3.0);
    truth.rough.declared[channel] = factor;
    if (factor < 0.67 || factor > 1.5)
      truth.rough.faults.push_back({{"noise_level"}, {channel}, {{"factor", 1.0 / factor}}});
  }
  return truth;
}

Truth noise_absent(Base base, Random& random) {
  Truth truth = drawn(base, random);
  truth.rough.noise_absent = true;
  return truth;
}

/// Low-pass over channels as one cause: two of three recorders compute it, the others have it before they sample.
void filter(Truth& truth, const Channels& channels, double corner, Random& random) {
  Recorder with{.corner = corner};
  with.digital = random.below(3) > 0;
  with.order = 1 + random.below(with.digital ? 4 : 2);
  for (const std::string& channel : channels) {
    truth.rough.recorder[channel] = with;
    truth.rough.declared[channel] = noise_behind(with, truth.sample_rate);
  }
}

Truth noise_coloured(Base base, Random& random) {
  base.kinds = "qqb";
  base.fits = [](const Truth& truth) { return !hides(truth, {"sensor_delay", "sensor_lag", "sensor_hold"}); };
  Truth truth = drawn(base, random);
  const Channels all = measured(truth);
  // A filter of one channel is its sensor's lag.
  const Channels channels = random.chance(0.5) ? all : some(all, true, random, 2);
  const double corner = random.logarithmic(60.0, 400.0);
  filter(truth, channels, corner, random);
  truth.rough.noise_absent = random.chance(0.5);
  truth.rough.faults.push_back({{"noise_colour", "common_filter"}, channels, {{"corner_hz", corner}}});
  return truth;
}

Truth parameters_off(Base base, Random& random) {
  base.kinds = "qqb";
  base.effects = std::min(base.effects, 1);
  // What a wrong parameter of the suspension can look like hides elsewhere.
  base.fits = [](const Truth& truth) {
    return !hides(truth,
                  {"viscous_damping", "relaxation", "top_mount", "sensor_gain", "progressive_spring", "bump_stop"});
  };
  Truth truth = drawn(base, random);
  std::vector<std::string> paths{"suspension.stiffness", "suspension.damping"};
  if (truth.kind == Kind::quarter_car) paths = {"body.mass", "wheel.mass", "tyre.stiffness", paths[0], paths[1]};
  if (truth.fdva) paths.emplace_back("fdva.coupling_stiffness");
  const std::string path = one_of(paths, random);
  truth.rough.tolerance_absent = random.chance(0.5);
  if (truth.rough.tolerance_absent) truth.actual = truth.nominal;
  const auto tolerance = truth.tolerance.find(path);
  const double width = tolerance == truth.tolerance.end() || truth.rough.tolerance_absent ? 0.0 : tolerance->second;
  truth.actual[path] =
      truth.nominal.at(path) * (1.0 + random.sign() * std::max(random.uniform(0.05, 0.15), 2.5 * width));
  truth.rough.off = {path};
  return truth;
}

Truth few_sensors(Base base, Random& random) {
  static const std::vector<std::pair<char, Channels>> sets{{'q', {"z_r", "zdd_w", "zdd_b"}},
                                                           {'q', {"z_r", "zdd_w", "zdd_b"}},
                                                           {'q', {"z_r", "F_w", "zdd_b"}},
                                                           {'q', {"z_r", "zdd_b", "dz_b"}},
                                                           {'q', {"z_r", "zdd_w", "dz_b"}},
                                                           {'q', {"z_r", "F_w", "dz_b"}},
                                                           {'q', {"z_r", "zdd_w", "zdd_b", "dz_b"}},
                                                           {'b', {"x_act", "F"}},
                                                           {'b', {"x_cmd", "F"}}};
  const auto& [kind, kept] = one_of(sets, random);
  base.kinds = std::string(1, kind);
  const Channels keep = kept;
  const auto leave = [keep](Truth& truth) {
    for (const std::string& channel : channels_of(truth.kind))
      if (std::find(keep.begin(), keep.end(), channel) == keep.end()) truth.rough.missing.push_back(channel);
  };
  base.fits = [&](const Truth& truth) {
    Truth left = truth;
    leave(left);
    // Without x_cmd the machine is not seen; without x_act it may hide behind a lag of F.
    if (truth.kind == Kind::component_bench &&
        hides(truth, {"actuator_delay", "actuator_lag", "actuator_resonance", "actuator_rate_limit", "sensor_lag",
                      "sensor_delay", "sensor_gain"}))
      return false;
    return !hides(truth, {"force_sensor_inertia", "sensor_gain"}) && every_effect_shows(left);
  };
  Truth truth = drawn(base, random);
  leave(truth);
  return truth;
}

Truth no_road(Base base, Random& random) {
  base.kinds = "q";
  const bool none = random.chance(0.6);
  static const std::vector<Channels> sets{
      {"zdd_w", "zdd_b", "dz_b"}, {"zdd_w", "zdd_b", "dz_b", "F_w"}, {"zdd_w", "zdd_b", "dz_b", "F_w", "dz_w"}};
  Channels keep{"zdd_r", "zdd_w", "zdd_b", "F_w", "dz_w", "dz_b"};
  if (none) keep = one_of(sets, random);
  const auto leave = [keep](Truth& truth) {
    for (const std::string& channel : channels_of(truth.kind))
      if (std::find(keep.begin(), keep.end(), channel) == keep.end()) truth.rough.missing.push_back(channel);
  };
  base.fits = [&](const Truth& truth) {
    for (const Effect& effect : truth.effects) {
      if (effect.channel.empty() || std::find(keep.begin(), keep.end(), effect.channel) != keep.end()) continue;
      return false;
    }
    // Below the wheel nothing is determined without a road; an offset of an acceleration shows nowhere else.
    if (none && hides(truth, {"wheel_guide_friction", "wheel_guide_damping", "tyre_lift_off", "progressive_tyre",
                              "force_sensor_inertia", "sensor_offset"}))
      return false;
    if (none && std::any_of(truth.effects.begin(), truth.effects.end(),
                            [](const Effect& e) { return e.channel == "F_w" || e.channel == "dz_w"; }))
      return false;
    Truth left = truth;
    leave(left);
    return every_effect_shows(left);
  };
  Truth truth = drawn(base, random);
  leave(truth);
  return truth;
}

Truth rates(Base base, Random& random) {
  base.kinds = "qqb";
  static const std::vector<double> all{100.0, 125.0, 200.0, 250.0, 400.0, 500.0, 2000.0, 5000.0, 10000.0};
  static const std::vector<double> odd{97.0, 128.0, 333.0, 512.0, 1024.0, 2048.0};
  const int sort = random.below(3);
  const double rate = sort == 0 ? one_of(odd, random) : one_of(all, random);
  base.wanted.sample_rate = rate;
  base.wanted.duration = rate > 4000.0 ? 8.0 : 20.0;
  if (sort == 2) base.wanted.duration = random.uniform(3.5, 10.0);
  base.one_record = true;
  base.fits = [&](const Truth& truth) {
    // What is shorter than a sample, or a hold of less than three, need not be seen.
    for (const Effect& effect : truth.effects)
      for (const auto& [key, value] : effect.parameters) {
        if ((key == "delay" || key == "time_constant") && value * rate < 0.3) return false;
        if (key == "period" && value * rate < 3.0) return false;
      }
    return every_effect_shows(truth);
  };
  Truth truth = drawn(base, random);
  truth.rough.described_rate = 1000.0;
  truth.rough.stamp_decimals = sort == 0 && rate < 600.0 ? 3 : 6;
  return truth;
}

Truth gaps(Base base, Random& random) {
  base.one_record = true;
  Truth truth = drawn(base, random);
  const int sort = random.below(3);
  if (sort == 0) {
    truth.rough.not_a_number = random.logarithmic(5e-5, 1e-2);
  } else if (sort == 1) {
    truth.rough.lost = random.logarithmic(5e-5, 1e-2);
    truth.rough.faults.push_back({{"lost_rows", "gap"}, {}, {}});
  } else {
    truth.rough.gaps = 1 + random.below(4);
    truth.rough.gap_share = random.uniform(0.005, 0.045);
    truth.rough.faults.push_back({{"gap", "lost_rows"}, {}, {}});
  }
  return truth;
}

/// A clock of its own for some channels. Later than the others, or the others later than they. That of one channel runs
/// differently, too: if it were only late, it would be the effect sensor_delay.
void own_clock(Truth& truth, Random& random) {
  const Channels all = measured(truth);
  const Channels late = some(all, true, random);
  const double offset = random.logarithmic(0.5e-3, 4e-3);
  const bool alone = late.size() == 1, drifts = random.chance(0.7) || alone;
  const double drift = drifts ? random.logarithmic(alone ? 100e-6 : 20e-6, 200e-6) : 0.0;
  for (const std::string& channel : late) {
    truth.rough.recorder[channel].late = offset;
    truth.rough.recorder[channel].drift = drift;
  }
  if (truth.kind == Kind::quarter_car && !truth.noise.contains("z_r")) return;
  truth.rough.faults.push_back({{"clock_offset"}, late, {{"seconds", offset}}});
  if (drift * truth.records.front().duration > 5e-4)
    truth.rough.faults.push_back({{"clock_drift"}, late, {{"ppm", 1e6 * drift}}});
}

Truth daq(Base base, Random& random) {
  base.kinds = "qqb";
  base.one_record = true;
  const int sort = random.below(5);
  base.fits = [sort](const Truth& truth) {
    // A delay or a lag of one channel is a part of the same fault.
    return !hides(truth, {"sensor_delay", "sensor_lag", "sensor_hold", "actuator_delay"}) || sort > 1;
  };
  Truth truth = drawn(base, random);
  const Channels all = measured(truth);
  const Channels group = some(all, false, random);
  if (sort == 0) {
    own_clock(truth, random);
  } else if (sort == 1) {
    const double corner = random.logarithmic(60.0, 300.0);
    const Channels several = truth.kind == Kind::quarter_car && random.chance(0.5) ? Channels{"zdd_r", "zdd_w", "zdd_b"}
                                                                                   : some(all, true, random, 2);
    filter(truth, several, corner, random);
    truth.rough.faults.push_back({{"common_filter", "noise_colour"}, several, {{"corner_hz", corner}}});
  } else {
    for (const std::string& channel : group) {
      const double noise = truth.noise.at(channel);
      Recorder& recorder = truth.rough.recorder[channel];
      if (sort == 2) {
        recorder.hum = noise * random.uniform(1.0, 5.0);
        truth.rough.faults.push_back({{"mains_hum"}, {channel}, {{"amplitude", recorder.hum}}});
      } else if (sort == 3) {
        recorder.step = noise * random.uniform(2.0, 8.0);
        truth.rough.faults.push_back({{"quantisation"}, {channel}, {{"step", recorder.step}}});
      } else {
        recorder.outliers = 3 + random.below(30);
        recorder.outlier = noise * random.uniform(20.0, 100.0);
        truth.rough.faults.push_back({{"outliers"}, {channel}, {{"count", recorder.outliers}}});
      }
    }
  }
  return truth;
}

Truth drift(Base base, Random& random) {
  base.one_record = true;
  base.effects = std::min(base.effects, 1);
  base.fits = [](const Truth& truth) {
    return truth.actual.at("suspension.damping") > 200.0 && !hides(truth, {"top_mount"});
  };
  Truth truth = drawn(base, random);
  std::vector<std::string> paths{"suspension.damping", "suspension.damping", "suspension.stiffness"};
  if (truth.kind == Kind::quarter_car) paths.emplace_back("tyre.stiffness");
  const std::string path = one_of(paths, random);
  const double relative = random.sign() * random.uniform(0.08, 0.20);
  truth.rough.drift[path] = relative;
  truth.rough.faults.push_back({{"drift"}, {}, {{"per_cent_over_record", 100.0 * relative}}});
  return truth;
}

Truth events(Base base, Random& random) {
  base.kinds = "qqb";
  base.one_record = true;
  Truth truth = drawn(base, random);
  const double whole = truth.records.front().duration;
  const double start = truth.records.front().start;
  const bool bench = truth.kind == Kind::component_bench;
  const std::string where = bench ? "F" : (random.chance(0.5) ? "body" : "wheel");
  const bool push = random.chance(0.5);
  const int count = push ? 1 : 1 + random.below(4);
  for (int i = 0; i < count; ++i) {
    const double from = random.uniform(2.0, whole - 2.0);
    const double length = push ? random.uniform(0.2, 1.0) : random.logarithmic(5e-3, 30e-3);
    const double sign = random.sign();
    const double force = sign * (push ? random.uniform(60.0, 300.0) : random.uniform(200.0, 900.0));
    truth.rough.events.push_back({where, from, from + length, force});
    // A verdict counts time as the recording does.
    truth.rough.faults.push_back({{"event"}, {}, {{"from_s", start + from}, {"to_s", start + from + length}}});
  }
  return truth;
}

Truth neighbour_laws(Base base, Random& random) {
  const bool beside = base.effects == 2;
  const std::string kind = random.chance(0.5) ? "quarter_car" : (random.chance(0.5) ? "hil" : "component_bench");
  return drawn((beside ? "neighbour_beside:" : "neighbour:") + kind, random.next() % 1000000U, base);
}

Truth many(Base base, Random& random) {
  base.effects += 3;
  return drawn(base, random);
}

Truth sweeps(Base base, Random& random) {
  static const std::vector<std::string> forms{"sweep", "steps", "stepped_sines", "multisine", ""};
  base.wanted.form = one_of(forms, random);
  if (base.wanted.form.empty()) base.wanted.level = random.uniform(0.15, 0.4);
  base.fits = every_effect_shows;
  base.one_record = true;
  return drawn(base, random);
}

using Maker = Truth (*)(Base, Random&);
const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> all{{"noise_wrong", noise_wrong},
                                                              {"noise_absent", noise_absent},
                                                              {"noise_coloured", noise_coloured},
                                                              {"parameters_off", parameters_off},
                                                              {"few_sensors", few_sensors},
                                                              {"no_road", no_road},
                                                              {"rates", rates},
                                                              {"gaps", gaps},
                                                              {"daq", daq},
                                                              {"drift", drift},
                                                              {"events", events},
                                                              {"neighbour_laws", neighbour_laws},
                                                              {"many", many},
                                                              {"sweeps", sweeps}};
  return all;
}

}  // namespace

const std::vector<std::string>& conditions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, maker] : makers()) all.push_back(name);
    return all;
  }();
  return names;
}

Truth draw_rough(const std::string& condition, std::uint64_t seed) {
  for (const auto& [name, maker] : makers()) {
    if (name != condition) continue;
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (const char c : condition) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
    Random random(hash ^ (seed * 0x9E3779B97F4A7C15U));
    Base base;
    base.effects = static_cast<int>(seed % 3);
    base.wanted.duration = 20.0;
    Truth truth = maker(base, random);
    truth.id = "rough:" + condition + ":" + std::to_string(seed);
    truth.rough.condition = condition;
    return truth;
  }
  throw std::invalid_argument("no such condition: " + condition);
}

std::vector<std::string> recorded_channels(const Truth& truth) {
  Channels all = channels_of(truth.kind);
  std::erase_if(all, [&](const std::string& channel) {
    return std::find(truth.rough.missing.begin(), truth.rough.missing.end(), channel) != truth.rough.missing.end();
  });
  return all;
}

}  // namespace truth
