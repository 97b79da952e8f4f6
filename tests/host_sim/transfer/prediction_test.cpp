// What each source makes of the second rig's responses, against closed forms of a linear car.
#include "host_sim/transfer/predict/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"
#include "tests/host_sim/transfer/linear_pair.hpp"

namespace {

namespace transfer = host_sim::transfer;
namespace thresholds = transfer::thresholds;
using transfer::Outcome;
using transfer::Quantity;
using transfer::Source;

constexpr std::size_t draws = 400;
/// [1] Four standard deviations of a variance from 400 normal draws: 4 √(2/400); of complex ones 4 √(1/400).
constexpr double of_variance = 0.29, of_power = 0.2;

transfer::SecondRig driven(const firmware::RigDescription& car, double seconds = 60.0) {
  return transfer::on_road(car, linear_pair::road(car, seconds));
}
transfer::Prediction predicted(const firmware::RigDescription& from, const transfer::Posterior& posterior,
                               const transfer::SecondRig& second, std::size_t count = draws) {
  return transfer::predict_second_rig(from, posterior, second, 1, count, 96);
}
double quantity(const Outcome& outcome, Quantity which) { return outcome.quantity[static_cast<std::size_t>(which)]; }
double share(const transfer::Prediction& p, Quantity which, Source source) {
  return p.budget[static_cast<std::size_t>(which)][static_cast<std::size_t>(source)];
}
/// Relative variance of a quantity over the draws.
double spread(const transfer::Prediction& p, Quantity which) {
  std::vector<double> values;
  for (const Outcome& o : p.draws) values.push_back(quantity(o, which));
  return transfer::variance_of(values) / std::pow(transfer::mean_of(values), 2);
}

// Point. (1), (2): G_y F_s/z_r of a linear car. F_s is the force of the spring that travels, k dz_b; the car's damper
// is not in it. A mode that dies away in τ = 0.5 s leaks √(τ/T) of itself into a block of T = 4 s, and 30 blocks
// average that: √(0.5/4/30) = 6 % of what the lines are on average.
TEST(TransferPrediction, KnowsWhatAForceOfTheComponentDoes) {
  const auto from = linear_pair::bench(), to = linear_pair::car();
  const transfer::SecondRig second = driven(to);
  const transfer::Prediction p = predicted(from, linear_pair::known(from), second, 2);
  std::array<double, 3> error{}, size{};
  for (std::size_t k = 0; k < second.analysis->frequencies().size(); ++k) {
    const double f = second.analysis->frequencies()[k];
    if (f < 3.0) continue;
    const auto road = linear_pair::car_response(f, 1.0, 0.0), force = linear_pair::car_response(f, 0.0, 1.0);
    const auto own = linear_pair::stiffness * road.stroke;
    const std::array<transfer::Complex, 3> expected{force.load * own, force.body * own,
                                                    force.stroke * linear_pair::stiffness},
        found{p.force_effect.response[0][k], p.force_effect.response[1][k], p.force_effect.stroke[k]};
    for (std::size_t i = 0; i < 3; ++i) {
      error[i] += std::norm(found[i] - expected[i]);
      size[i] += std::norm(expected[i]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(std::sqrt(error[i] / size[i]), 0.06) << i;
}

// Point. (1): a discrepancy of 10 % between 2 and 9 Hz moves a line by 0.1 |G_y F_s/z_r| rms within the band, and by
// the simulation's own error outside.
TEST(TransferPrediction, CarriesADiscrepancyInItsBand) {
  const auto from = linear_pair::bench(), to = linear_pair::car();
  const transfer::SecondRig second = driven(to, 20.0);
  transfer::Posterior posterior = linear_pair::known(from);
  posterior.discrepancy.bands.push_back({2.0, 9.0, 0.1, 10.0});
  const transfer::Prediction p = predicted(from, posterior, second);
  ASSERT_EQ(p.draws.size(), draws);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < second.analysis->frequencies().size(); ++k) {
      const double f = second.analysis->frequencies()[k];
      double power = 0.0;
      for (const Outcome& o : p.draws) power += std::norm(o.response[i][k] - p.centre.response[i][k]) / draws;
      const double simulation = std::norm(thresholds::simulation_error * p.centre.response[i][k]);
      const double own = f >= 2.0 && f < 9.0 ? std::norm(0.1 * p.force_effect.response[i][k]) : 0.0;
      EXPECT_NEAR(power / (own + simulation), 1.0, of_power) << f << " Hz, response " << i;
    }
  }
  for (const Quantity q : {Quantity::rms_F_w, Quantity::rms_zdd_b, Quantity::weighted_zdd_b, Quantity::rms_dz_b}) {
    EXPECT_GT(share(p, q, Source::discrepancy), 0.99);
  }
}

// Law. (3): spectra follow the responses, rms values the integrals of spectra, the weighted acceleration that of W_k²
// times the spectrum. The error of the simulation, 1e-3 of each line, is in the responses alone.
TEST(TransferPrediction, ScalesLevelsWithTheSpectraOfADiscrepancy) {
  const auto from = linear_pair::bench(), to = linear_pair::car();
  const transfer::SecondRig second = driven(to, 20.0);
  const auto& f = second.analysis->frequencies();
  transfer::Posterior posterior = linear_pair::known(from);
  posterior.discrepancy.bands.push_back({0.0, 4.5, 0.1, 10.0});
  posterior.discrepancy.bands.push_back({4.5, 90.0, 0.2, 10.0});
  const transfer::Prediction p = predicted(from, posterior, second, 10);
  const auto at =
      static_cast<std::size_t>(std::find_if(f.begin(), f.end(), [](double x) { return x > 5.0; }) - f.begin());
  for (const Outcome& o : p.draws) {
    std::array<double, 3> before{}, after{};
    for (std::size_t k = 0; k < f.size(); ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        const double factor = std::norm(o.response[i][k] / p.centre.response[i][k]);
        EXPECT_NEAR(o.density[i][k] / (p.centre.density[i][k] * factor), 1.0, 0.02) << f[k];
        before[i] += p.centre.density[i][k];
        after[i] += o.density[i][k];
      }
      const double weight = std::pow(transfer::vertical_weighting(f[k]), 2);
      before[2] += weight * p.centre.density[1][k];
      after[2] += weight * o.density[1][k];
    }
    constexpr std::array<Quantity, 3> whose{Quantity::rms_F_w, Quantity::rms_zdd_b, Quantity::weighted_zdd_b};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(quantity(o, whose[i]) / quantity(p.centre, whose[i]), std::sqrt(after[i] / before[i]), 1e-9) << i;
    }
    EXPECT_NEAR(quantity(o, Quantity::dynamic_load_coefficient) * 330.0 * 9.81 / quantity(o, Quantity::rms_F_w), 1.0,
                1e-9);
    // The stroke: δ of the two bands back from a line of each.
    const auto delta = [&](std::size_t k) {
      return (o.response[0][k] - p.centre.response[0][k]) / p.force_effect.response[0][k];
    };
    const auto low = delta(at / 2), high = delta(at + 4);
    double stroke_before = 0.0, stroke_after = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) {
      stroke_before += p.force_effect.stroke_density[k];
      stroke_after +=
          p.force_effect.stroke_density[k] * std::norm(1.0 + (f[k] < 4.5 ? low : high) * p.force_effect.stroke[k]);
    }
    EXPECT_NEAR(quantity(o, Quantity::rms_dz_b) / quantity(p.centre, Quantity::rms_dz_b),
                std::sqrt(stroke_after / stroke_before), 0.01);
  }
}

// Point. Noise: a line of H has the variance S_n/(S_zz K), S_n = 2 σ² T; a level squared grows by σ².
TEST(TransferPrediction, AddsTheNoiseOfTheSensors) {
  const auto from = linear_pair::bench(), to = linear_pair::car("[noise]\nF_w = 60.0\nzdd_b = 0.2\n");
  const transfer::SecondRig second = driven(to, 20.0);
  const transfer::Prediction p = predicted(from, linear_pair::known(from), second);
  const std::array<double, 2> level{60.0, 0.2};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 4; k < second.analysis->frequencies().size(); k += 10) {
      double power = 0.0;
      for (const Outcome& o : p.draws) power += std::norm(o.response[i][k] - p.centre.response[i][k]) / draws;
      const double noise =
          2.0 * level[i] * level[i] * 1e-3 / (second.analysis->foot_power()[k] * second.analysis->averages());
      const double simulation = std::norm(thresholds::simulation_error * p.centre.response[i][k]);
      EXPECT_NEAR(power / (noise + simulation), 1.0, of_power) << second.analysis->frequencies()[k];
      double density = 0.0;
      for (const Outcome& o : p.draws) density += o.density[i][k] / draws;
      const double mean = p.centre.density[i][k] + 2.0 * level[i] * level[i] * 1e-3;
      // Of 400 draws that scatter by √((2 S S_n + S_n²)/K) at most √(1/K) of it.
      EXPECT_NEAR(density / mean, 1.0, 4.0 / std::sqrt(draws * second.analysis->averages()) + 1e-3);
    }
    const Quantity q = i == 0 ? Quantity::rms_F_w : Quantity::rms_zdd_b;
    double square = 0.0;
    for (const Outcome& o : p.draws) square += std::pow(quantity(o, q), 2) / draws;
    EXPECT_NEAR((square - std::pow(quantity(p.centre, q), 2)) / (level[i] * level[i]), 1.0, 0.2) << i;
    EXPECT_GT(share(p, q, Source::noise), 0.99);
  }
}

// Point. A tolerance r is uniform, of variance r²/3. Of the second rig's own parameters, and of the component's where
// no fit has moved them: the variance of a level is that times its slope, here by differences. The kurtosis of a
// uniform distribution is 1.8, so 400 draws know its variance to 4.5 %.
TEST(TransferPrediction, SpreadsOverTolerances) {
  const auto level = [](const firmware::RigDescription& from, const firmware::RigDescription& to) {
    return quantity(predicted(from, linear_pair::known(from), driven(to, 12.0), 1).centre, Quantity::rms_zdd_b);
  };
  const std::string tyre = "[tolerance]\n\"tyre.stiffness\" = 0.05\n\"suspension.stiffness\" = 0.5\n";
  const std::string spring = "[tolerance]\n\"suspension.stiffness\" = 0.05\n";
  const auto from = linear_pair::bench(), to = linear_pair::car();
  {
    auto above = to, below = to;
    above.rig.tyre.stiffness *= 1.01;
    below.rig.tyre.stiffness *= 0.99;
    const double slope = std::log(level(from, above) / level(from, below)) / 0.02;
    const transfer::Prediction p = predicted(from, linear_pair::known(from), driven(linear_pair::car(tyre), 12.0));
    EXPECT_NEAR(spread(p, Quantity::rms_zdd_b) / (slope * slope * 0.05 * 0.05 / 3.0), 1.0, 0.18);
    EXPECT_GT(share(p, Quantity::rms_zdd_b, Source::rig), 0.99);
  }
  auto above = from, below = from;
  above.rig.suspension.stiffness *= 1.01;
  below.rig.suspension.stiffness *= 0.99;
  const double slope = std::log(level(above, to) / level(below, to)) / 0.02;
  const auto open = linear_pair::bench(spring);
  const transfer::Prediction p = predicted(open, linear_pair::known(open), driven(to, 12.0));
  EXPECT_NEAR(spread(p, Quantity::rms_zdd_b) / (slope * slope * 0.05 * 0.05 / 3.0), 1.0, 0.18);
  EXPECT_GT(share(p, Quantity::rms_zdd_b, Source::component), 0.99);
}

// Point. What one standard deviation of the first rig's load cell moves the level by its slope; the second rig's sensors
// have their own certificates, (4): 1 % with k = 2 are 0.5 % of their channel, and of both channels where it is z_r.
TEST(TransferPrediction, CarriesTheCalibrationOfBothRigs) {
  const auto from = linear_pair::bench("[tolerance]\n\"suspension.stiffness\" = 0.2\n"), to = linear_pair::car();
  transfer::Posterior posterior = linear_pair::known(from);
  transfer::ComponentModel& model = posterior.models.front();
  model.parameters = host_sim::identification::tolerated_parameters(from);
  const double deviation = 0.02 * linear_pair::stiffness / model.parameters.at(0).scale;
  model.mode = Eigen::VectorXd::Zero(1);
  model.covariance = Eigen::MatrixXd::Constant(1, 1, deviation * deviation);
  model.draws = Eigen::MatrixXd::Zero(1, 1);
  model.calibration = Eigen::MatrixXd::Constant(1, 1, deviation);
  const transfer::Prediction of_first = predicted(from, posterior, driven(to, 12.0));
  const auto row = static_cast<Eigen::Index>(Quantity::rms_zdd_b);
  const double slope = transfer::sensitivity_of(from, posterior, driven(to, 12.0)).gradient(row, 0) * deviation;
  EXPECT_NEAR(spread(of_first, Quantity::rms_zdd_b) / (slope * slope), 1.0, of_variance);
  EXPECT_GT(share(of_first, Quantity::rms_zdd_b, Source::calibration), 0.99);

  const auto exact = linear_pair::bench();
  const auto certified = linear_pair::car("[calibration.F_w]\ngain = 0.01\n");
  const transfer::Prediction of_second = predicted(exact, linear_pair::known(exact), driven(certified, 12.0));
  EXPECT_NEAR(spread(of_second, Quantity::rms_F_w) / (0.005 * 0.005), 1.0, of_variance);
  EXPECT_GT(share(of_second, Quantity::rms_F_w, Source::calibration), 0.99);
  EXPECT_LT(spread(of_second, Quantity::rms_zdd_b), 1e-20);

  transfer::SecondRig measured = driven(linear_pair::car("[calibration.z_r]\ngain = 0.01\n"), 12.0);
  measured.measured.emplace_back();
  const transfer::Prediction of_input = predicted(exact, linear_pair::known(exact), measured);
  for (const Quantity q : {Quantity::rms_F_w, Quantity::rms_zdd_b}) {
    EXPECT_NEAR(spread(of_input, q) / (0.005 * 0.005), 1.0, of_variance);
  }
}

// Point. Two models, 0.7 and 0.3 likely: three of ten draws are of the second, and between them lies the variance
// p (1 − p) Δ².
TEST(TransferPrediction, AveragesOverModels) {
  const auto from = linear_pair::bench(), to = linear_pair::car();
  transfer::Posterior posterior = linear_pair::known(from);
  posterior.models.push_back(posterior.models.front());
  posterior.models[0].probability = 0.7;
  posterior.models[1].probability = 0.3;
  posterior.models[1].hypothesis.rig.suspension.stiffness *= 1.1;
  const transfer::SecondRig second = driven(to, 12.0);
  const transfer::Prediction p = predicted(from, posterior, second);
  const auto runs = second.run({transfer::with_component(to.rig, from.rig, posterior.models[1].hypothesis)});
  const double first = quantity(p.centre, Quantity::rms_zdd_b),
               other = quantity(second.analysis->of(runs.front()), Quantity::rms_zdd_b);
  double of_other = 0.0;
  for (const Outcome& o : p.draws) {
    of_other += std::abs(quantity(o, Quantity::rms_zdd_b) - other) < 0.5 * std::abs(other - first) ? 1.0 / draws : 0.0;
  }
  EXPECT_NEAR(of_other, 0.3, 4.0 * std::sqrt(0.21 / draws));
  EXPECT_NEAR(spread(p, Quantity::rms_zdd_b) / (0.21 * std::pow((other - first) / first, 2)), 1.0, of_variance);
  EXPECT_GT(share(p, Quantity::rms_zdd_b, Source::rival_effects), 0.99);
}

// Point. Draws of a component's posterior move the level by its slope times their spread; sensitivity_of() gives that
// slope for a standard deviation.
TEST(TransferPrediction, SpreadsOverThePosterior) {
  const auto from = linear_pair::bench("[tolerance]\n\"suspension.stiffness\" = 0.2\n"), to = linear_pair::car();
  transfer::Posterior posterior = linear_pair::known(from);
  transfer::ComponentModel& model = posterior.models.front();
  model.parameters = host_sim::identification::tolerated_parameters(from);
  ASSERT_EQ(model.parameters.size(), 1U);
  const double deviation = 0.02 * linear_pair::stiffness / model.parameters[0].scale;  // 2 % of the stiffness
  model.mode = Eigen::VectorXd::Zero(1);
  model.covariance = Eigen::MatrixXd::Constant(1, 1, deviation * deviation);
  model.draws.resize(1, 1000);
  for (int i = 0; i < 1000; ++i) model.draws(0, i) = i % 2 == 0 ? deviation : -deviation;
  const transfer::SecondRig second = driven(to, 12.0);
  const transfer::Prediction p = predicted(from, posterior, second);
  const transfer::Sensitivity s = transfer::sensitivity_of(from, posterior, second);
  ASSERT_EQ(s.gradient.cols(), 1);
  const auto row = static_cast<Eigen::Index>(Quantity::rms_zdd_b);
  const double slope = s.gradient(row, 0) * deviation;
  EXPECT_NEAR(spread(p, Quantity::rms_zdd_b) / (slope * slope), 1.0, 0.05);
  EXPECT_GT(share(p, Quantity::rms_zdd_b, Source::component), 0.99);
  auto stiffer = from;
  stiffer.rig.suspension.stiffness *= 1.02;
  const auto runs = second.run({transfer::with_component(to.rig, from.rig, {stiffer.rig, {}}), to.rig});
  const double change = std::log(quantity(second.analysis->of(runs[0]), Quantity::rms_zdd_b) /
                                 quantity(second.analysis->of(runs[1]), Quantity::rms_zdd_b));
  EXPECT_NEAR(change / slope, 1.0, 0.05);
}

}  // namespace
