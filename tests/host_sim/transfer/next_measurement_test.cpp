// What the first rig has shown, and what it should show next.
#include "host_sim/transfer/predict/next_measurement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/transfer/predict/overlap.hpp"
#include "tests/host_sim/transfer/linear_pair.hpp"

namespace {

namespace id = host_sim::identification;
namespace transfer = host_sim::transfer;

/// A diagnosis that has found nothing, of a bench whose deflection is this motion.
id::Identified nothing_found(const firmware::RigDescription& rig, firmware::Recording recording) {
  linear_pair::Problem p = linear_pair::problem_of(rig, std::move(recording));
  id::Identified first{std::move(p.problem), std::move(p.space), {}, {}, {}};
  first.diagnosis.rig = rig;
  return first;
}

/// 30 s of a sine [m, Hz] that fades in.
firmware::FootPointMotion sine(double amplitude, double frequency, double seconds = 30.0) {
  std::vector<double> z;
  for (std::size_t k = 0; k < static_cast<std::size_t>(seconds * linear_pair::rate); ++k) {
    const double t = static_cast<double>(k) / linear_pair::rate, fade = std::min(0.5 * t, 1.0);
    z.push_back(amplitude * fade * fade * std::sin(2.0 * std::numbers::pi * frequency * t));
  }
  return firmware::through_samples(z, linear_pair::rate);
}

id::Identified shown(double amplitude, double frequency) {
  const auto rig = linear_pair::bench();
  host_sim::Run run = host_sim::run_closed_loop(rig, sine(amplitude, frequency), {});
  run.recording.source = "bench.csv";
  return nothing_found(rig, std::move(run.recording));
}

// Point. (1): a sine of 2 Hz on both rigs is seen in full, one of 8 Hz on the second not at all. (2): the time for
// which a sine is below half of its amplitude is a third; the fade-in adds a little.
TEST(TransferOverlap, ComparesFrequenciesAndTravel) {
  const auto car = linear_pair::car();
  constexpr double road = 4e-3;
  const auto second_at = [&](double f) { return transfer::on_road(car, sine(road, f)); };
  const double stroke = road * std::abs(linear_pair::car_response(2.0, 1.0, 0.0).stroke);
  const transfer::Overlap same = transfer::overlap_of(shown(1.2 * stroke, 2.0), second_at(2.0), car.rig);
  EXPECT_GT(same.in_frequency, 0.99);
  EXPECT_GT(same.in_travel, 0.99);
  EXPECT_LE(same.lowest, 2.0);
  EXPECT_GE(same.highest, 2.0);
  EXPECT_LT(transfer::overlap_of(shown(stroke, 2.0), second_at(8.0), car.rig).in_frequency, 0.05);
  const transfer::Overlap small = transfer::overlap_of(shown(0.5 * stroke, 2.0), second_at(2.0), car.rig);
  EXPECT_NEAR(small.in_travel, 1.0 / 3.0, 0.06);
  EXPECT_DOUBLE_EQ(small.least(), small.in_travel);
}

// Point. (1), (2): a spring known from 20 s, all fitted, is known √(1 + 3/4 · 3) better after another minute of the
// same motion, of which three quarters are fitted: 0.555 remain. With half of the noise the minute counts four times,
// with twice the level as well: 0.316. The whole band of the wheel load has its other sources too.
TEST(TransferNextMeasurement, CountsWhatAMinuteWouldTell) {
  const auto rig = linear_pair::bench("[tolerance]\n\"suspension.stiffness\" = 0.2\n");
  const id::Identified first = nothing_found(rig, linear_pair::recorded(rig, 20.0));
  transfer::Posterior posterior;
  posterior.models.push_back(transfer::laplace_model(
      first.problem, first.space, id::fit(first.problem, first.space.given, first.space.common), 1.0));
  ASSERT_EQ(posterior.models[0].mode.size(), 1);
  transfer::Sensitivity sensitivity{{0}, Eigen::MatrixXd::Constant(3, 1, 2.0)};
  transfer::Budget load{};
  load[static_cast<std::size_t>(transfer::Source::component)] = 0.75;
  load[static_cast<std::size_t>(transfer::Source::noise)] = 0.25;
  const auto next = transfer::next_measurements(rig, first, posterior, sensitivity, load);
  const auto remaining = [&](const std::string& what) {
    const auto at = std::find_if(next.list.begin(), next.list.end(), [&](const auto& n) { return n.what == what; });
    EXPECT_NE(at, next.list.end()) << what;
    return at == next.list.end() ? transfer::NextMeasurement{} : *at;
  };
  const auto same = remaining("the same for another minute"), louder = remaining("twice the level"),
             quieter = remaining("a sensor of F with half of the noise");
  EXPECT_NEAR(same.remaining, 1.0 / std::sqrt(1.0 + 0.75 * 3.0), 0.04);
  EXPECT_NEAR(louder.remaining, 1.0 / std::sqrt(1.0 + 4.0 * 0.75 * 3.0), 0.04);
  EXPECT_NEAR(quieter.remaining, louder.remaining, 0.03);
  EXPECT_NEAR(same.band, std::sqrt(0.25 + 0.75 * same.remaining * same.remaining), 1e-9);
  EXPECT_TRUE(std::is_sorted(next.list.begin(), next.list.end(),
                             [](const auto& a, const auto& b) { return a.remaining < b.remaining; }));
}

}  // namespace
