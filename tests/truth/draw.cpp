#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/truth/catalogue.hpp"
#include "tests/truth/random.hpp"
#include "tests/truth/truth.hpp"

namespace truth {
namespace {

using std::numbers::pi;
constexpr std::array kinds{Kind::quarter_car, Kind::hil, Kind::component_bench};

char letter(Kind kind) { return kind == Kind::quarter_car ? 'q' : (kind == Kind::hil ? 'h' : 'b'); }
bool exists(const Candidate& candidate, Kind kind) { return candidate.kinds.find(letter(kind)) != std::string::npos; }

/// Three digits, as a data sheet has.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::round(value / unit) * unit;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// One thing that hides, before its parameters become those of the contract.
struct Hidden {
  Candidate candidate;
  std::string channel;
  std::map<std::string, double> drawn;
  double sign = 1.0;
};

double noise_of(const Truth& truth, const std::string& channel) {
  const auto found = truth.noise.find(channel);
  return found == truth.noise.end() ? 0.0 : found->second;
}

/// Writes what hides into the truth. `rms` of the channels without it, for saturations.
void put(Truth& truth, const std::vector<Hidden>& all, const std::map<std::string, double>& rms) {
  truth.effects.clear();
  truth.unknown.clear();
  truth.unknown_channel.clear();
  truth.unknown_parameters.clear();
  const double whole = truth.records.front().warm + truth.records.front().duration;
  for (const Hidden& hidden : all) {
    std::map<std::string, double> p = hidden.drawn;
    const std::string& name = hidden.candidate.name;
    const double noise = noise_of(truth, hidden.channel);
    if (name == "sensor_gain")
      p["gain"] = 1.0 + hidden.sign * p["gain"];
    else if (name == "sensor_offset")
      p["offset"] *= hidden.sign * noise;
    else if (name == "sensor_saturation")
      p["limit"] *= rms.contains(hidden.channel) ? rms.at(hidden.channel) : 1e9;
    else if (name == "mains_hum")
      p["hum"] *= noise, p["hum_frequency"] = 50.0;
    else if (name == "quantisation")
      p["rounding"] *= noise;
    else if (name == "spikes")
      p["spikes"] *= noise;
    else if (name == "gain_drift" || name == "clock_drift")
      p[name] /= whole;
    else if (name == "zero_drift")
      p["zero_drift"] *= hidden.sign * noise / whole;
    else if (name == "bent_sensor") {
      const double size = rms.contains(hidden.channel) ? rms.at(hidden.channel) : 1e9;
      p["bend"] *= hidden.sign / (size * size);
    } else if (name == "progressive_spring" || name == "progressive_tyre") {
      // A softening spring must not turn negative within its travel.
      p["cubic_stiffness"] *= hidden.sign < 0.0 ? (name == "progressive_tyre" ? -0.1 : -0.2) : 1.0;
    } else if (name == "parasitic_mass") {
      const double turn = 2.0 * pi * p["parasitic_frequency"];
      p["parasitic_stiffness"] = p["parasitic_mass"] * turn * turn;
      p["parasitic_damping"] = 2.0 * p["parasitic_ratio"] * p["parasitic_mass"] * turn;
      p.erase("parasitic_frequency");
      p.erase("parasitic_ratio");
    }
    if (name == "lugre_friction" && hidden.drawn.contains("bristle"))
      p["bristle_excess"] = std::min(p["bristle_excess"], p["bristle"]);
    if (hidden.candidate.words.empty()) {
      truth.effects.push_back({name, hidden.channel, p});
    } else {
      truth.unknown = hidden.candidate.words;
      truth.unknown_channel = hidden.channel;
      truth.unknown_parameters = p;
    }
  }
}

/// A short run without noise of the truth's first record.
Record glance(Truth truth) {
  RecordPlan plan = truth.records.front();
  const double whole = plan.duration + plan.warm;
  plan.duration = 4.0;
  plan.warm = 0.0;
  truth.records = {plan};
  // What changes through the record shall change as far within the glance.
  for (auto& [key, value] : truth.unknown_parameters)
    if (key.ends_with("_drift")) value *= whole / plan.duration;
  return simulate(truth, {5, false}).front();
}

double rms_of(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// What leaving a thing out changes, in noise rms: of the channel it shows most in, and of all channels together.
struct Change {
  double largest = 0.0;
  double together = 0.0;
  bool bounded = true;
};

Change change_between(const Truth& truth, const Record& with, const Record& without) {
  Change change;
  double sum = 0.0;
  for (const auto& [channel, values] : with.channels) {
    const std::vector<double>& others = without.channels.at(channel);
    double power = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      power += (values[i] - others[i]) * (values[i] - others[i]);
      size = std::max(size, std::abs(values[i]));
    }
    const double limit = channel[0] == 'F' ? 9500.0 : (channel.starts_with("zdd") ? 400.0 : 0.12);
    if (!(size < limit)) change.bounded = false;
    const double noise = noise_of(truth, channel);
    if (noise <= 0.0) continue;
    const double ratio = std::sqrt(power / static_cast<double>(values.size())) / noise;
    change.largest = std::max(change.largest, ratio);
    sum += ratio * ratio;
  }
  change.together = std::sqrt(sum);
  return change;
}

/// Another rig altogether: between two thirds and one and a half times everything but the FDVA's geometry, which sets
/// its resonance and moves by a tenth; tolerances half to twice as wide.
void vary_rig(Truth& truth, Random& random) {
  for (auto& [path, value] : truth.nominal) {
    if (path.ends_with("ducts")) continue;
    const double spread = path.starts_with("fdva.") ? 1.1 : 1.5;
    value = value > 0.0 ? rounded(value * random.logarithmic(1.0 / spread, spread)) : 0.0;
  }
  for (auto& [path, relative] : truth.tolerance) relative = rounded(relative * random.logarithmic(0.5, 2.0));
}

/// Other sensors: a third to three times the noise, each by itself; 500 Hz, 1 or 2 kHz.
void vary_sensors(Truth& truth, Random& random) {
  for (auto& [channel, rms] : truth.noise) rms = rounded(rms * random.logarithmic(1.0 / 3.0, 3.0));
  truth.sample_rate = 500.0 * static_cast<double>(1 << random.below(3));
}

/// Another road: class A to C, driven faster or slower, cut elsewhere; another command.
void vary_road(RecordPlan& plan, Kind kind, bool any_level, Random& random) {
  const bool bench = kind == Kind::component_bench;
  if (any_level) plan.level *= random.logarithmic(0.5, 2.0);
  plan.corner = (bench ? 2.0 : 0.35) * random.logarithmic(0.5, 2.0);
  plan.cut = (bench ? 25.0 : 40.0) * random.logarithmic(0.6, 1.6);
}

void draw_rig(Truth& truth, Random& random, double tyre_level, const Wanted& wanted) {
  const Kind kind = truth.kind;
  const bool bench = kind == Kind::component_bench;
  const bool paper = random.chance(0.5);  // the paper's values, or a few per cent around them
  const auto near = [&](double value, double spread) {
    return paper ? value : rounded(value * (1.0 + random.uniform(-spread, spread)));
  };
  auto& n = truth.nominal;
  if (!bench) {
    n["body.mass"] = near(290.0, 0.1);
    n["wheel.mass"] = near(40.0, 0.12);
    n["tyre.stiffness"] = near(200e3, 0.1);
    n["tyre.damping"] = near(100.0, 0.2);
  }
  n["suspension.stiffness"] = near(31500.0, 0.15);
  // Beside an FDVA: little on a bench; none in the loop, which the virtual damping keeps quiet; the paper's in a car.
  n["suspension.damping"] = near(1140.0, 0.1);
  if (truth.fdva && bench) n["suspension.damping"] = 300.0;
  if (truth.fdva && kind == Kind::hil) n["suspension.damping"] = random.chance(0.5) ? 0.0 : 300.0;
  if (kind == Kind::hil) n["machine.virtual_damping"] = truth.fdva ? 1140.0 : (random.chance(0.5) ? 1140.0 : 700.0);
  if (truth.fdva) {
    n["fdva.piston_area"] = 30e-4;
    n["fdva.duct_diameter"] = 12e-3;
    n["fdva.duct_length"] = 0.6361571127;
    n["fdva.oil_density"] = 860.0;
    n["fdva.oil_viscosity"] = 32e-6;
    n["fdva.minor_loss"] = 1.5;
    n["fdva.coupling_stiffness"] = near(55e3, 0.05);
    n["fdva.ducts"] = 6.0;
    n["fdva.open_ducts"] = 1.0 + random.below(6);
  }
  auto& tolerance = truth.tolerance;
  if (!bench) tolerance = {{"body.mass", 0.01}, {"wheel.mass", 0.01}, {"tyre.stiffness", 0.03}, {"tyre.damping", 0.3}};
  tolerance["suspension.stiffness"] = 0.03;
  if (bench) tolerance["suspension.damping"] = 0.1;
  if (truth.fdva) {
    tolerance["fdva.coupling_stiffness"] = 0.03;
    tolerance["fdva.oil_density"] = 0.02;
    tolerance["fdva.oil_viscosity"] = 0.2;
    tolerance["fdva.minor_loss"] = 0.2;
  }
  if (wanted.varied && tyre_level == 0.0) vary_rig(truth, random);
  truth.actual = n;
  for (const auto& [path, relative] : tolerance) truth.actual[path] *= 1.0 + relative * random.uniform(-0.95, 0.95);

  if (kind == Kind::quarter_car) {
    truth.noise = {{"z_r", 2e-5}, {"zdd_r", 0.05}, {"zdd_w", 0.05}, {"zdd_b", 0.05},
                   {"F_w", 10.0}, {"dz_w", 5e-5},  {"dz_b", 5e-5}};
    truth.range = {{"F_w", {-1e4, 1e4}}, {"zdd_w", {-98.0, 98.0}}, {"zdd_b", {-98.0, 98.0}}};
    if (tyre_level > 0.0) truth.range.clear();
  } else {
    truth.noise = {{"F", 10.0}, {"x_act", 2e-5}};
  }
  if (wanted.varied) vary_sensors(truth, random);
  if (wanted.sample_rate > 0.0) truth.sample_rate = wanted.sample_rate;

  const int count = random.chance(0.3) ? 2 : 1;
  for (int i = 0; i < count; ++i) {
    RecordPlan plan;
    plan.duration = count == 1 ? wanted.duration : std::round(wanted.duration * 2.0 / 3.0);
    plan.level = bench ? random.uniform(0.005, 0.008) : random.uniform(0.85, 1.1);
    if (tyre_level > 0.0) plan.level = tyre_level;
    if (wanted.varied) vary_road(plan, kind, tyre_level == 0.0, random);
    if (i == 1) plan.level *= 0.6;
    plan.level *= wanted.level;
    plan.form = wanted.form;
    plan.road_seed = random.next() % 1000000U;
    plan.noise_seed = random.next() % 1000000U;
    plan.warm = random.chance(0.5) ? 10.0 : 0.0;
    plan.start = random.chance(0.3) ? std::round(random.uniform(1.0, 1000.0) * 100.0) / 100.0 : 0.0;
    if (bench) {
      plan.modulation_depth = random.uniform(0.3, 0.5);
      plan.modulation_period = random.uniform(12.0, 18.0);
      plan.modulation_phase = random.uniform(0.0, 2.0 * pi);
    }
    truth.records.push_back(plan);
  }
  truth.units_in_header = random.chance(0.3);
  truth.lag_takes_noise = random.chance(0.25);
}

Hidden draw_hidden(const Candidate& candidate, const std::string& channel, const Truth& truth, Random& random) {
  Hidden hidden{candidate, channel, {}, 1.0};
  for (const Candidate::Parameter& p : candidate.parameters) hidden.drawn[p.key] = random.logarithmic(p.low, p.high);
  if (candidate.either_sign) hidden.sign = random.sign();
  if (candidate.name == "sensor_hold") {  // of less than two samples nothing would be held
    hidden.candidate.least = std::max(candidate.least, 2.6 / truth.sample_rate);
    hidden.drawn["period"] = std::max(hidden.drawn["period"], hidden.candidate.least);
  }
  // More than the tolerance of the damping it adds to, or nothing would need it.
  const auto tolerance = truth.tolerance.find("suspension.damping");
  if (candidate.name == "viscous_damping" && tolerance != truth.tolerance.end()) {
    hidden.candidate.least = std::max(40.0, 3.0 * tolerance->second * truth.nominal.at("suspension.damping"));
    hidden.drawn["damping"] = std::max(hidden.drawn["damping"], hidden.candidate.least);
  }
  return hidden;
}

/// May the two be in one rig, and be told apart in principle?
bool go_together(const Hidden& a, const Hidden& b) {
  if (a.candidate.name == b.candidate.name && a.channel == b.channel) return false;
  if (!a.channel.empty() && a.channel == b.channel) return false;
  const auto both = [&](const char* one, const char* other) {
    return (a.candidate.name == one && b.candidate.name == other) ||
           (a.candidate.name == other && b.candidate.name == one);
  };
  // Laws of velocity that the catalogue does not hold are simulated without a mount before them, and beside none of
  // their kind.
  const auto law_of_velocity = [](const Candidate& c) {
    return c.name == "coulomb_friction" || c.name == "viscous_damping" || c.name == "quadratic_damping" ||
           c.name == "relaxation" || c.name == "top_mount" || c.name == "backlash" || c.name.starts_with("actuator") ||
           c.name == "moving_mass";
  };
  if (!a.candidate.words.empty() && law_of_velocity(b.candidate)) return false;
  if (!b.candidate.words.empty() && law_of_velocity(a.candidate)) return false;
  return !both("top_mount", "backlash") && !both("top_mount", "coulomb_friction");
}

/// Every candidate of a kind with its channel.
std::vector<std::pair<Candidate, std::string>> candidates_of(Kind kind, bool outside) {
  std::vector<std::pair<Candidate, std::string>> all;
  for (const Candidate& c : outside ? outside_effects() : rig_effects())
    if (exists(c, kind)) all.emplace_back(c, "");
  for (const Candidate& c : outside ? outside_sensors() : sensor_effects()) {
    if (!exists(c, kind)) continue;
    for (const std::string& channel : suspects(kind)) {
      if (c.name == "cross_talk" && channel != "zdd_b" && channel != "zdd_r") continue;
      all.emplace_back(c, channel);
    }
  }
  return all;
}

/// By how much weaker than usual an effect may become and still be that effect: a hold needs more than a sample, times
/// must stay above the step of the simulation, a resonance within sight of the band.
double widening(const Candidate& candidate) {
  if (candidate.name == "sensor_hold") return 1.25;
  if (candidate.name == "actuator_resonance") return 3.0;
  if (candidate.strength == "time_constant" || candidate.strength == "delay") return 10.0;
  return 30.0;
}

/// Scales one hidden thing until it is as large as wanted.
void scale(Truth& truth, std::vector<Hidden>& all, std::size_t which, const std::map<std::string, double>& rms,
           const Wanted& wanted, Random& random) {
  const double samples = [&] {
    double sum = 0.0;
    for (const RecordPlan& plan : truth.records) sum += plan.duration * truth.sample_rate;
    return sum;
  }();
  const double weak_wish = random.logarithmic(35.0, 90.0);
  double too_small = 0.0;  // of the strength; 0: not known yet
  double too_large = 0.0;
  std::vector<Hidden> others = all;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
  put(truth, others, rms);
  const Record without = glance(truth);

  Hidden& hidden = all[which];
  const Candidate& c = hidden.candidate;
  for (int tries = 0; tries < (wanted.weak ? 20 : 10); ++tries) {
    put(truth, all, rms);
    const Change change = change_between(truth, glance(truth), without);
    truth.size = change.largest;
    if (c.strength.empty()) return;  // lift-off: the level of the road makes it
    double factor = 1.0;
    if (!change.bounded) {
      factor = 0.6;
    } else if (wanted.weak) {
      const double sigmas = change.together * std::sqrt(samples);
      if (sigmas > 30.0 && sigmas < 100.0) return;
      factor = std::clamp(weak_wish / std::max(sigmas, 1e-9), 0.03, 5.0);
    } else {
      if (change.largest >= 3.0 && change.largest <= 300.0) return;
      factor = std::clamp((change.largest < 3.0 ? 5.0 : 200.0) / std::max(change.largest, 1e-9), 0.3, 3.0);
    }
    double& value = hidden.drawn[c.strength];
    const double before = value;
    const double widen = wanted.weak ? widening(c) : 1.0;
    (factor < 1.0 ? too_large : too_small) = before;
    value *= c.exponent > 0 ? factor : 1.0 / factor;
    // Some grow from nothing to much within a tenth of their strength: a limit that is just reached.
    if (wanted.weak && too_small > 0.0 && too_large > 0.0) value = std::sqrt(too_small * too_large);
    value = std::clamp(value, c.exponent > 0 ? c.least / widen : c.least, c.exponent > 0 ? c.most : c.most * widen);
    if (value != before) continue;
    if (change.bounded && change.largest < 3.0 && hidden.sign < 0.0 && !wanted.weak) {
      hidden.sign = 1.0;  // softening by as much as a spring can bear is too little
    } else {
      return;
    }
  }
  put(truth, all, rms);
}

}  // namespace

std::vector<std::string> groups() {
  std::vector<std::string> all;
  for (const Kind kind : kinds)
    for (const auto& [candidate, channel] : candidates_of(kind, false))
      all.push_back("single:" + name_of(kind) + ":" + candidate.name + (channel.empty() ? "" : ":" + channel));
  for (const Kind kind : kinds) all.push_back("pair:" + name_of(kind));
  for (const Kind kind : kinds) all.push_back("triple:" + name_of(kind));
  for (const Kind kind : kinds) all.push_back("none:" + name_of(kind));
  for (const Kind kind : kinds) {
    std::string last;
    for (const auto& [candidate, channel] : candidates_of(kind, true)) {
      if (candidate.name != last) all.push_back("unknown:" + name_of(kind) + ":" + candidate.name);
      last = candidate.name;
    }
  }
  return all;
}

Truth draw(const std::string& group, std::uint64_t seed, const Wanted& wanted) {
  // The group's own stream of numbers (FNV-1a), so that neighbouring groups do not share roads.
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const char c : group) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  Random random(hash ^ (seed * 0x9E3779B97F4A7C15U));

  std::vector<std::string> parts = split(group);
  const std::string what = parts.front();
  parts.erase(parts.begin());
  const std::map<std::string, int> sizes{
      {"none", 0},      {"single", 1},    {"unknown", 1},          {"pair", 2}, {"triple", 3}, {"quadruple", 4},
      {"quintuple", 5}, {"neighbour", 1}, {"neighbour_beside", 2}, {"law", 1}};
  if (!sizes.contains(what)) throw std::invalid_argument("no such group: " + group);

  std::vector<Kind> possible(kinds.begin(), kinds.end());
  for (const Kind kind : kinds)
    if (!parts.empty() && parts.front() == name_of(kind)) possible = {kind};
  if (possible.size() == 1) parts.erase(parts.begin());
  const std::string name = parts.empty() ? "" : parts.front();
  const std::string channel = parts.size() > 1 ? parts[1] : "";
  const auto fitting = [&](Kind kind) {
    std::vector<std::pair<Candidate, std::string>> fit;
    if (what == "law") {
      for (const Candidate& c : laws())
        if (exists(c, kind) && (name.empty() || c.name == name)) fit.emplace_back(c, "");
      return fit;
    }
    for (const auto& [c, its_channel] : candidates_of(kind, what == "unknown"))
      if ((name.empty() ? c.joins : c.name == name) && (channel.empty() || channel == its_channel))
        fit.emplace_back(c, its_channel);
    return fit;
  };
  std::erase_if(possible, [&](Kind kind) { return what != "none" && fitting(kind).empty(); });
  if (possible.empty() || (what == "none" && !name.empty())) throw std::invalid_argument("no such group: " + group);

  Truth truth;
  truth.group = what;
  truth.id = group + ":" + std::to_string(seed);
  truth.kind = possible[static_cast<std::size_t>(random.below(static_cast<int>(possible.size())))];
  truth.fdva = name == "seal_friction" || random.chance(0.5);
  // fading or lopsided damping needs some
  const auto needs_damping = [](const std::string& n) {
    return n == "fading_damping" || n == "asymmetric_damper" || n == "stroke_damping" || n == "bypass_damper";
  };

  // Which effects.
  std::vector<std::pair<Candidate, std::string>> chosen;
  const auto fit = fitting(truth.kind);
  std::vector<std::pair<Candidate, std::string>> near;
  for (const Candidate& c : neighbour_laws())
    if (exists(c, truth.kind)) near.emplace_back(c, "");
  while (static_cast<int>(chosen.size()) < sizes.at(what)) {
    const auto& from = chosen.empty() && what.starts_with("neighbour") ? near : fit;
    const auto& one = from[static_cast<std::size_t>(random.below(static_cast<int>(from.size())))];
    if (one.first.name == "seal_friction" && !truth.fdva) continue;
    const bool fits = std::all_of(chosen.begin(), chosen.end(), [&one](const auto& other) {
      return go_together({other.first, other.second, {}, 1.0}, {one.first, one.second, {}, 1.0});
    });
    if (!fits) continue;
    chosen.push_back(one);
  }
  double tyre_level = 0.0;
  for (const auto& [c, its_channel] : chosen)
    if (c.name == "tyre_lift_off") tyre_level = random.uniform(2.9, 3.6) * (truth.kind == Kind::hil ? 1.25 : 1.0);
  draw_rig(truth, random, tyre_level, wanted);

  std::vector<Hidden> hidden;
  for (const auto& [c, its_channel] : chosen) {
    if (needs_damping(c.name) && truth.actual["suspension.damping"] <= 0.0)
      truth.nominal["suspension.damping"] = truth.actual["suspension.damping"] = 300.0;
    hidden.push_back(draw_hidden(c, its_channel, truth, random));
  }
  std::map<std::string, double> rms;
  if (!hidden.empty())
    for (const auto& [name_of_column, values] : glance(truth).channels) rms[name_of_column] = rms_of(values);
  double smallest = 0.0;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    scale(truth, hidden, i, rms, wanted, random);
    smallest = i == 0 ? truth.size : std::min(smallest, truth.size);
  }
  truth.size = smallest;
  return truth;
}

}  // namespace truth
