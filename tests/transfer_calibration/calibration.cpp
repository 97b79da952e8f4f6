#include "tests/transfer_calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <random>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/transfer/common/statistics.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"
#include "host_sim/transfer/transfer.hpp"
#include "tests/truth/truth.hpp"

namespace transfer_calibration {

namespace id = host_sim::identification;
namespace transfer = host_sim::transfer;

namespace {

constexpr double prior_seconds = 12.0;

/// The absorber of the paper on a bench, and the car it is carried to.
constexpr const char* component = R"([suspension]
stiffness = 31500.0
damping = 0.0
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
constexpr const char* bench = R"(kind = "component_bench"
sample_rate = 1000.0
[noise]
F = 10.0
x_act = 2e-5
[limits]
speed = 1.5
[tolerance]
"suspension.stiffness" = 0.05
"fdva.oil_viscosity" = 0.15
"fdva.coupling_stiffness" = 0.03
"fdva.minor_loss" = 0.3
)";
constexpr const char* car = R"(kind = "quarter_car"
sample_rate = 1000.0
[body]
mass = 290.0
[wheel]
mass = 40.0
[tyre]
stiffness = 200e3
damping = 100.0
)";

double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11U) * 0x1p-53; }

firmware::FootPointMotion road_of(const firmware::RigDescription& rig, std::uint64_t seed) {
  firmware::IsoRoad road;
  road.seed = seed;
  road.bandwidth = 30.0;
  return firmware::excitation(
      rig.rig, firmware::drive_over(road, rig.sample_rate, static_cast<std::size_t>(prior_seconds * rig.sample_rate)),
      rig.sample_rate);
}

/// One rig from the prior: shares of the draws below the truth, by name.
std::map<std::string, double> one_of_prior(std::uint64_t seed) {
  const firmware::RigDescription from = firmware::parse_rig(std::string(bench) + component, "bench.toml");
  firmware::RigDescription to = firmware::parse_rig(std::string(car) + component, "car.toml");
  to.rig.suspension.damping = 1140.0;
  std::seed_seq words{static_cast<std::uint32_t>(seed), 91U};
  std::mt19937_64 engine(words);
  firmware::RigDescription actual = from;
  for (const auto& [path, bound] : from.tolerance) {
    *firmware::find_parameter(actual.rig, path) *= 1.0 + bound * (2.0 * uniform(engine) - 1.0);
  }
  host_sim::RunOptions options;
  options.seed = seed;
  host_sim::Run run = host_sim::run_closed_loop(actual, road_of(from, seed), options);
  run.recording.source = "bench.csv";
  std::vector<id::Record> records;
  records.push_back({std::move(run.recording), id::Use::fitted});
  id::PreparedData data = id::prepare(from, std::move(records));
  const id::Hypothesis given = id::described_hypothesis(from, data.recordings);
  id::IdentificationProblem problem(std::move(data.recordings), given);
  const id::SearchSpace space = id::search_space(from, problem.samples(), given);
  transfer::Posterior posterior;
  posterior.models.push_back(transfer::laplace_model(problem, space, id::fit(problem, given, space.common), 1.0));
  posterior.discrepancy.widening =
      Eigen::MatrixXd::Zero(posterior.models[0].mode.size(), posterior.models[0].mode.size());
  (void)transfer::sample_model(problem, 1.0, posterior.discrepancy, {800, seed, {}}, posterior.models[0]);

  const transfer::ComponentModel& model = posterior.models[0];
  std::map<std::string, double> shares;
  const auto count = static_cast<double>(model.draws.cols());
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    if (model.parameters[i].path.empty()) continue;
    const double truth =
        model.parameters[i].coordinate(*firmware::find_parameter(actual.rig, model.parameters[i].path));
    const Eigen::VectorXd row = model.draws.row(static_cast<Eigen::Index>(i));
    shares[model.parameters[i].path] = static_cast<double>((row.array() < truth).count()) / count;
  }
  const transfer::SecondRig second = transfer::on_road(to, road_of(to, seed + 1));
  std::vector<model::RigParameters<double>> rigs{transfer::with_component(to.rig, from.rig, {actual.rig, {}})};
  constexpr Eigen::Index predicted = 63;
  for (Eigen::Index k = 0; k < predicted; ++k) {
    rigs.push_back(
        transfer::with_component(to.rig, from.rig, model.at(model.draws.col(k * model.draws.cols() / predicted))));
  }
  std::vector<double> loads;
  for (const auto& runs : second.run(rigs)) loads.push_back(second.analysis->of(runs).quantity[0]);
  double below = 0.0;
  for (std::size_t k = 1; k < loads.size(); ++k) below += loads[k] < loads[0] ? 1.0 : 0.0;
  shares["rms_F_w"] = below / static_cast<double>(predicted);
  return shares;
}

bool of_component(const std::string& path) { return path.starts_with("suspension.") || path.starts_with("fdva."); }

/// The second rig of tests/truth with the component of the first.
truth::Truth second_with(const truth::Truth& first, std::uint64_t seed, Hidden hidden, const truth::Wanted& wanted) {
  const std::string group =
      hidden == Hidden::second_rig
          ? (seed / 10 % 2 == 0 ? "single:quarter_car:body_guide_friction" : "single:quarter_car:force_sensor_inertia")
          : "none:quarter_car";
  truth::Truth second = truth::draw(group, seed, wanted);
  second.fdva = first.fdva;
  for (auto* map : {&second.nominal, &second.actual, &second.tolerance}) {
    std::erase_if(*map, [](const auto& entry) { return of_component(entry.first); });
  }
  const auto copy = [](const auto& source, auto& target) {
    for (const auto& [path, value] : source) {
      if (of_component(path)) target[path] = value;
    }
  };
  copy(first.nominal, second.nominal);
  copy(first.actual, second.actual);
  copy(first.tolerance, second.tolerance);
  const double beside = first.nominal.at("machine.virtual_damping");
  second.nominal["suspension.damping"] += beside;
  second.actual["suspension.damping"] += beside;
  second.tolerance.erase("suspension.damping");
  for (const truth::Effect& effect : first.effects) {
    if (transfer::travels("effects." + effect.name + ".")) second.effects.push_back(effect);
  }
  if (hidden == Hidden::component) {  // a car that is known, so that the bands are those of the component
    std::erase_if(second.tolerance, [](const auto& entry) { return !of_component(entry.first); });
    for (auto& [path, value] : second.actual) {
      if (!of_component(path)) value = second.nominal.at(path);
    }
  }
  second.unknown = first.unknown;
  second.unknown_parameters = first.unknown_parameters;
  second.records.resize(1);
  return second;
}

/// The first rig; its seed says what hides in it.
truth::Truth first_with(std::uint64_t seed, Hidden hidden, const truth::Wanted& wanted) {
  constexpr std::array<const char*, 3> known{"none:hil", "single:hil:actuator_delay", "single:hil:coulomb_friction"};
  constexpr std::array<const char*, 12> laws{
      "law:hil:power_law_low",  "law:hil:power_law_high",     "law:hil:smooth_friction",
      "law:hil:lugre_friction", "law:hil:stribeck_friction",  "law:hil:cubic_damping",
      "law:hil:hysteresis",     "law:hil:leaf_friction",      "law:hil:lopsided_spring",
      "law:hil:blow_off",       "unknown:hil:stroke_damping", "unknown:hil:parasitic_mass"};
  const char* const group = hidden == Hidden::component ? laws[seed / 10 % laws.size()] : known[seed % known.size()];
  truth::Truth first = truth::draw(group, seed, wanted);
  first.records.resize(1);
  return first;
}

std::vector<id::Record> records_of(const truth::Truth& truth, const char* name) {
  std::vector<id::Record> records;
  for (const truth::Record& record : truth::simulate(truth)) {
    records.push_back({firmware::parse_recording_csv(truth::csv(truth, record), name), id::Use::shared});
  }
  return records;
}

}  // namespace

void Ranks::add(double share) {
  ++counts[std::min(bins - 1, static_cast<std::size_t>(share * static_cast<double>(bins)))];
}

std::size_t Ranks::count() const {
  std::size_t sum = 0;
  for (const std::size_t c : counts) sum += c;
  return sum;
}

double Ranks::chi_squared() const {
  const double expected = static_cast<double>(count()) / static_cast<double>(bins);
  double sum = 0.0;
  for (const std::size_t c : counts) sum += std::pow(static_cast<double>(c) - expected, 2) / expected;
  return sum;
}

double Ranks::p() const { return transfer::chi_squared_tail(chi_squared(), static_cast<double>(bins - 1)); }

PriorResult calibrate_on_prior(std::size_t rigs, std::uint64_t seed) {
  std::vector<std::map<std::string, double>> shares(rigs);
  id::for_all(rigs, [&](std::size_t i) { shares[i] = one_of_prior(seed + 1000 * i); });
  PriorResult result;
  for (const auto& one : shares) {
    for (const auto& [name, share] : one) result.ranks[name].add(share);
  }
  return result;
}

TruthCase transfer_truth(std::uint64_t seed, Hidden hidden, double duration) {
  TruthCase one;
  one.seed = seed;
  try {
    truth::Wanted wanted;
    wanted.duration = duration;
    wanted.sample_rate = 1000.0;
    const truth::Truth first = first_with(seed, hidden, wanted);
    const truth::Truth second = second_with(first, seed + 1, hidden, wanted);
    if (hidden == Hidden::second_rig) one.outside = second.effects.front().name;
    if (hidden == Hidden::component) one.outside = first.unknown;
    transfer::TransferInput input;
    input.from = firmware::parse_rig(truth::rig_toml(first), "first.toml");
    input.to = firmware::parse_rig(truth::rig_toml(second), "second.toml");
    input.first = records_of(first, "first.csv");
    input.second = records_of(second, "second.csv");
    input.draws = 800;
    input.seed = seed;
    const firmware::RigDescription from = input.from;
    transfer::Transfer found = transfer::transfer_component(std::move(input));
    one.coverage50 = found.validation->coverage50;
    one.coverage95 = found.validation->coverage95;
    double inside = 0.0, count = 0.0;
    for (std::size_t q = 0; q < transfer::quantity_count; ++q) {
      const double measured = found.validation->measured.quantity[q];
      if (!std::isfinite(measured) || static_cast<transfer::Quantity>(q) == transfer::Quantity::peak_dz_b) continue;
      const transfer::Bands b = found.prediction.quantity(static_cast<transfer::Quantity>(q));
      inside += measured >= b.low95 && measured <= b.high95 ? 1.0 : 0.0;
      count += 1.0;
    }
    one.load = count > 0.0 ? inside / count : 0.0;
    one.holds = found.holds();
    one.said = !one.holds || std::any_of(found.both.second_only.begin(), found.both.second_only.end(),
                                         [&](const auto& e) { return e.name == one.outside; });
    one.confounded = found.posterior.confounded;
    for (const auto& band : found.validation->bands) one.deviation = std::max(one.deviation, band.deviation);
    for (const auto& effect : found.both.travels) one.travels += (one.travels.empty() ? "" : ", ") + effect.name;
    const std::size_t laws = found.posterior.diagnosed().hypothesis.laws.size();
    if (laws > 0) one.travels += (one.travels.empty() ? "" : ", ") + std::to_string(laws) + " learned law";
    one.coverage50_without = one.coverage50;
    one.coverage95_without = one.coverage95;
    if (!found.posterior.discrepancy.any()) return one;
    for (const auto& band : found.posterior.discrepancy.bands) {
      one.discrepancy = std::max(one.discrepancy, band.relative);
    }
    found.posterior.discrepancy.bands.clear();
    const transfer::Validation without = transfer::validate(
        transfer::predict_second_rig(from, found.posterior, found.second, seed, transfer::thresholds::predictive_draws,
                                     transfer::thresholds::source_draws),
        found.second);
    one.coverage50_without = without.coverage50;
    one.coverage95_without = without.coverage95;
  } catch (const std::exception& error) {
    one.failure = error.what();
  }
  return one;
}

}  // namespace transfer_calibration
