// The pieces of the reference, each by construction. That it agrees with the product is what rigtwin_reference says.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/recording/recording_csv.hpp"
#include "tests/reference/agreement.hpp"
#include "tests/reference/diagnose.hpp"

namespace reference {
namespace {

struct Case {
  Description description;
  std::vector<firmware::Recording> recordings;
};

Case drawn(const char* group, std::uint64_t seed, double duration) {
  const truth::Truth truth = truth::draw(group, seed, {.duration = duration});
  Case drawn{firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  for (const truth::Record& record : truth::simulate(truth)) {
    drawn.recordings.push_back(firmware::parse_recording_csv(truth::csv(truth, record), "rec.csv"));
  }
  return drawn;
}

// Point. (2) is χ² up to the noise and continues it with slope 1; far above only the share that is explained counts.
TEST(Reference, CountsNoiseAsChiSquaredAndADiscrepancyByItsShare) {
  EXPECT_EQ(counted({80.0, 100.0}), 80.0);
  EXPECT_NEAR(counted({100.0 + 1e-6, 100.0}), 100.0 + 1e-6, 1e-12);
  const double halved = counted({1e8, 100.0}) - counted({0.5e8, 100.0});
  EXPECT_NEAR(halved, directions * std::numbers::ln2, 1e-5);
}

// Law. (3) is the derivative of (2).
TEST(Reference, WeighsAsTheCountGrows) {
  for (const double power : {50.0, 101.0, 120.0, 1e4}) {
    const double difference = counted({power + 1e-4, 100.0}) - counted({power - 1e-4, 100.0});
    EXPECT_NEAR(weight({power, 100.0}), difference / 2e-4, 1e-6) << power;
  }
}

// Point. With one parameter whose error is σ the terms are −2 ln of the share √(2π) σ of the width; two count twice.
TEST(Reference, ChargesAParameterForTheWidthThatTheRecordingsTakeAway) {
  const double sigma = 1e-3, width = 2.0;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1) / (sigma * sigma);
  const double expected = -2.0 * std::log(std::sqrt(2.0 * std::numbers::pi) * sigma / width);
  EXPECT_NEAR(occam(one, {width}), expected, 1e-5);
  EXPECT_NEAR(occam(Eigen::MatrixXd::Identity(2, 2) / (sigma * sigma), {width, width}), 2.0 * expected, 1e-5);
}

// Point. At the mean of the noise's power nothing is outside; seven standard deviations above it something is.
TEST(Reference, SeesADiscrepancyByItsPower) {
  std::vector<Cell> cells(50, {200.0, 200.0});
  EXPECT_LT(unexplained(cells), outside_share);
  cells[7].power = 200.0 + 7.0 * std::sqrt(2.0 * 200.0);
  EXPECT_GT(unexplained(cells), 0.95);
}

// Point. Shares follow exp(−½ v), and end at 1000 : 1.
TEST(Reference, SharesBelief) {
  const auto shares = posterior({10.0, 10.0 + 2.0 * std::log(4.0), 24.0});
  EXPECT_NEAR(shares[0], 0.8, 1e-12);
  EXPECT_NEAR(shares[1], 0.2, 1e-12);
  EXPECT_EQ(shares[2], 0.0);
}

// Law. With what is in the rig nothing is left but unit variance, in every band: the noise of the channels, that of the
// input through the model, and their correlation. ±5 standard deviations, and 2 % for a covariance that is known from a
// hundred lines. z̈_r counts less by intent.
TEST(Reference, WhitensToUnitVariance) {
  for (const char* group : {"none:quarter_car", "none:component_bench"}) {
    const Case rig = drawn(group, 8101, 20.0);
    const Model described{std::vector<double>(rig.description.tolerance.size()), {}};
    const Problem problem(rig.description, rig.recordings, 1e6, described);
    const auto cells = problem.cells(problem.fit(described, {}, 10).residual);
    const bool car = rig.description.rig.kind == model::RigKind::quarter_car;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double ratio = cells[i].power / cells[i].count, doubt = 5.0 * std::sqrt(2.0 / cells[i].count) + 0.02;
      EXPECT_LT(ratio, 1.0 + doubt) << group << ", channel " << i / bands << ", band " << i % bands;
      if (!car || i >= bands) {
        EXPECT_GT(ratio, 1.0 - doubt) << group << ", channel " << i / bands << ", band " << i % bands;
      }
    }
  }
}

// Journey. Nothing in a rig without a cause, the cause with its size in another.
TEST(Reference, NamesWhatHides) {
  const Case none = drawn("none:component_bench", 8101, 20.0);
  EXPECT_TRUE(diagnose(none.description, none.recordings).causes.empty());
  const Case lag = drawn("single:component_bench:sensor_lag:F", 8101, 20.0);
  const Verdict verdict = diagnose(lag.description, lag.recordings);
  ASSERT_FALSE(verdict.causes.empty());
  EXPECT_EQ(words(verdict.causes.front().cause), "sensor_lag of F");
  EXPECT_GT(verdict.causes.front().confidence, 0.9);
  EXPECT_LT(verdict.unexplained, 0.5);
}

// Point. What the table calls the same, and who is right.
TEST(Reference, ComparesNames) {
  std::vector<Compared> all(2);
  all[0] = {{"single:hil:top_mount", 1}, "top_mount", {"top_mount"}, {"top_mount"}, {"top_mount"}};
  all[1] = {{"pair:hil", 2}, "two", {"a", "b"}, {"a"}, {"a", "b"}};
  EXPECT_EQ(agreement(all), 0.5);
  EXPECT_NE(text(all).find("pair:hil:2: reference right"), std::string::npos);
}

}  // namespace
}  // namespace reference
