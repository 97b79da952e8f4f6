// Every wording of a law's shape, with the numbers that it must hold.
#include "host_sim/identification/learn/describe_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/identification/learn/surface_fit.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/law_figure.hpp"
#include "host_sim/identification/report/shape_words.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using testing::StartsWith;

/// A law of a bench with its values known to 0.1 in their coordinates.
DescribedLaw described(const PlacedLaw& law, double friction = 0.0) {
  const firmware::RigDescription bench = sample::bench();
  std::vector<PreparedRecording> recordings = sample::prepared(bench, bench);
  const Hypothesis given = described_hypothesis(bench, recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  Fit fit;
  fit.hypothesis = given;
  if (friction > 0.0)
    firmware::put_effect(fit.hypothesis.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {friction}});
  fit.hypothesis.laws = {law};
  put_laws(fit.hypothesis.laws, fit.hypothesis.rig);
  fit.parameters = law_parameters(fit.hypothesis.laws);
  const auto n = static_cast<Eigen::Index>(fit.parameters.size());
  Uncertainty known;
  known.half_widths = Eigen::VectorXd::Constant(n, 0.025);
  known.covariance = Eigen::MatrixXd::Identity(n, n) * 1e-4;
  known.step_shift = Eigen::VectorXd::Zero(n);
  return describe_laws(problem, fit, known).front();
}

DescribedLaw described(LawFamily family, CurveOver over, std::vector<double> values, std::vector<double> at = {},
                       double gap = 0.0, double friction = 0.0) {
  PlacedLaw law;
  law.family = family;
  law.over = over;
  law.rms = over == CurveOver::velocity ? 0.1 : 0.01;
  law.largest = 4.0 * law.rms;
  law.rms_velocity = 0.1;
  law.largest_velocity = 0.4;
  law.size = 100.0;
  law.at = std::move(at);
  law.values = std::move(values);
  law.gap = gap;
  return described(law, friction);
}

std::string of_effect(const char* name, std::vector<double> values) {
  const firmware::RigDescription bench = sample::bench();
  return shape_words({firmware::find_effect(name), std::nullopt, std::move(values)}, bench.rig);
}

// Point. Families by hand. The bench has 1000 N s/m and 30 kN/m, r is 0.1 m/s or 10 mm; the exponent is known to
// ln 1.61 ± 0.025, ± 0.04.
TEST(DescribeLaw, SaysEachShapeInWordsWithNumbers) {
  const auto v = CurveOver::velocity, x = CurveOver::deflection, both = CurveOver::both;
  EXPECT_EQ(described(LawFamily::power, v, {50.0, 1.61}).words, "grows with |v|^1.61 ± 0.04");
  // 1000 + 5 to 1000 + 125.6 N s/m, 12 % more
  EXPECT_THAT(described(LawFamily::two_slopes, v, {0.5, 12.56}).words, StartsWith("rebound 12 % harder than compress"));
  EXPECT_EQ(described(LawFamily::falling, v, {25.0, 0.01}, {}, 0.0, 85.0).words,
            "breaks away at 85 N, falls to 60 N by 20 mm/s (Stribeck)");
  EXPECT_EQ(described(LawFamily::knee, x, {10.0, 90.0, 0.031}).words, "stiffens from 31 mm on");
  EXPECT_EQ(described(LawFamily::knee, v, {90.0, -10.0, 0.05}).words, "gives way from 50 mm/s on");
  EXPECT_EQ(described(LawFamily::soft_sign, v, {40.0, 0.02}).words, "friction of 40 N that sets in over 20 mm/s");
  const DescribedLaw sliders = described(LawFamily::sliders, x, {40.0}, {2e-3}, 4.4e-3);
  EXPECT_THAT(sliders.words, StartsWith("hysteresis of 40 N independent of frequency (elastic sliders)"));
  EXPECT_THAT(sliders.words, testing::HasSubstr("4.4 mm of lost motion"));
  EXPECT_EQ(described(LawFamily::maxwell, x, {40.0}, {0.02}).words, "relaxes within 20 ms");
  // 9 N at r, where the spring has 300 N
  const DescribedLaw load = described(LawFamily::follows_load, both, {9.0, 0.01});
  EXPECT_EQ(load.words, "friction follows the load: 3 % of it");
  EXPECT_NEAR(load.numbers[0].upper - load.numbers[0].value, 0.025 * 100.0 / 300.0, 1e-12);  // 0.025 of 100 N
  // 4 N at r and 0.1 m/s: 40 N s/m; at 4 r with a square 640
  EXPECT_EQ(described(LawFamily::along_stroke, both, {4.0, 2.0}).words,
            "damping grows along the stroke: 640 N s/m more at 40 mm, with |x|^2");
}

// Point. A surface by hand, 500 x + 3000 x v N with r = 10 mm and q = 0.1 m/s: 60 N s/m more or less at 2 r, and 10 N
// of spring. One value, a share of x v that is 1 at 40 mm and 0.4 m/s, has a standard deviation of 0.01 of 100 N.
TEST(DescribeLaw, SaysASurfaceByItsDampingOverTheStroke) {
  const ExcitedRange stroke{-0.04, 0.04, 0.01, 0.04}, speed{-0.4, 0.4, 0.1, 0.4};
  PlacedLaw law = surface_through(stroke, speed, [](double x, double v) { return 500.0 * x + 3000.0 * x * v; });
  SurfaceBasis basis{
      surface_of(law),
      {surface_of(surface_through(stroke, speed, [](double x, double v) { return x * v / (0.04 * 0.4); }))}};
  law.basis = std::make_shared<const SurfaceBasis>(std::move(basis));
  law.values = {0.0};
  law.size = 100.0;
  const DescribedLaw surface = described(law);
  EXPECT_EQ(surface.shape, "surface");
  EXPECT_EQ(surface.words, "adds −60 N s/m of damping at −20 mm, 0 at rest, 60 at 20 mm");
  ASSERT_EQ(surface.numbers.size(), 5U);
  EXPECT_NEAR(surface.numbers[2].value, 60.0, 1e-9);
  EXPECT_NEAR(surface.numbers[2].upper - surface.numbers[2].value, 1.96 * 0.01 * 100.0 * 0.02 / (0.04 * 0.4), 1e-3);
  EXPECT_NEAR(surface.numbers[4].value, 10.0, 1e-9);
  EXPECT_NEAR(surface.numbers[4].upper, 10.0, 1e-9);
  // The page shows it over the velocity, too: at 2 r and 0.4 m/s 10 + 24 N, known to 1.96 · 0.01 · 100 N · ½.
  ASSERT_EQ(surface.sections.size(), 3U);
  EXPECT_NEAR(surface.sections[2].force.back(), 34.0, 1e-9);
  EXPECT_NEAR(surface.sections[2].upper.back(), 34.0 + 0.98, 1e-3);
  host_sim::report::Report page("page");
  add_laws(page, {surface});
  EXPECT_NE(page.html().find("The same law over the velocity"), std::string::npos);
}

// Point. Curves whose slope falls all along, by hand: 1000 + 500 N s/m at rest, a quarter of the 500 at 0.1 m/s, a
// twenty-fifth at 0.4. Powers of both sides that differ by less than 1 % are one.
TEST(DescribeLaw, SaysSlopesThatChangeAllAlong) {
  const DescribedLaw levelling = described(LawFamily::levelling, CurveOver::velocity, {50.0, 0.1});
  EXPECT_EQ(levelling.shape, "degressive");
  EXPECT_EQ(levelling.words, "degressive all along: 1500 N s/m at rest, 1020 at 400 mm/s");
  EXPECT_NEAR(levelling.numbers[0].value, 1500.0, 1e-9);
  EXPECT_NEAR(levelling.numbers[1].value, 0.1 * (std::sqrt(2.0) - 1.0), 1e-12);
  EXPECT_EQ(described(LawFamily::levelling, CurveOver::deflection, {-50.0, 0.01}).shape, "progressive");

  const DescribedLaw alike = described(LawFamily::two_powers, CurveOver::velocity, {50.0, 50.1, 1.5});
  EXPECT_EQ(alike.shape, "power law");
  EXPECT_THAT(alike.words, StartsWith("grows with |v|^1.50"));
  EXPECT_EQ(described(LawFamily::two_powers, CurveOver::velocity, {50.0, 60.0, 1.5}).shape, "asymmetric power law");
}

// Point. A free curve is named by its slopes where both sides agree, by its sides where only they differ, else not. Its
// points are known to 0.025 of 100 N: slopes over 0.1 m/s to 35 N s/m.
TEST(DescribeLaw, NamesAFreeCurveByItsSlopes) {
  const std::vector<double> at{-0.4, -0.3, -0.2, -0.1, -0.05, 0.0, 0.05, 0.1, 0.2, 0.3, 0.4};
  const auto curve = [&](auto force) {
    std::vector<double> values;
    for (const double x : at) values.push_back(force(x));
    return described(LawFamily::points, CurveOver::velocity, values, at);
  };
  const auto sign = [](double x) { return x < 0.0 ? -1.0 : 1.0; };
  const DescribedLaw falls = curve([&](double x) { return sign(x) * 100.0 * std::sqrt(std::abs(x)); });
  EXPECT_EQ(falls.shape, "degressive");
  EXPECT_THAT(falls.words, StartsWith("degressive all along: 1320 N s/m at rest"));  // 1000 + √0.1·100/0.1
  EXPECT_EQ(curve([](double x) { return 2000.0 * x * std::abs(x); }).shape, "progressive");
  const DescribedLaw sides = curve([](double x) { return x < 0.0 ? 200.0 * x : 0.0; });
  EXPECT_EQ(sides.shape, "asymmetric");
  EXPECT_EQ(sides.words, "rebound 20 % harder than compression");
  const DescribedLaw bumps = curve([](double x) { return 30.0 * std::sin(x / 0.05); });
  EXPECT_EQ(bumps.shape, "curve");
  EXPECT_EQ(bumps.words, "no simple shape");
}

// Point. Effects of the catalogue have the same words.
TEST(DescribeLaw, SaysEffectsOfTheCatalogueInTheSameWords) {
  EXPECT_EQ(of_effect("asymmetric_damper", {-113.2}), "rebound 12 % harder than compression");  // 1056.6/943.4
  EXPECT_EQ(of_effect("stribeck_friction", {60.0, 25.0 / 60.0, 0.01}),
            "breaks away at 85 N, falls to 60 N by 20 mm/s (Stribeck)");
  EXPECT_EQ(of_effect("position_ripple", {5e-3, 3.0, -4.0}), "ripples every 5 mm by 5 N (cogging)");
  EXPECT_EQ(of_effect("bouc_wen", {1e5, 40.0, 0.5}), "hysteresis of 40 N independent of frequency");
  EXPECT_EQ(of_effect("relaxation", {1e4, 0.02}), "relaxes within 20 ms");
  EXPECT_EQ(of_effect("bump_stop", {0.031, 1e5}), "stiffens from 31 mm on");
  EXPECT_EQ(of_effect("actuator_delay", {0.01}), "");
  RecordingFault fade{"drift", {}, {{"per_cent_over_record", {-11.0, -12.0, -10.0}}}, 0.9};
  fade.path = "suspension.damping";
  EXPECT_THAT(words(fade), testing::HasSubstr("fades by 11 % over the record"));
  EXPECT_EQ(words(NextStep{"hysteresis", "lag", {0.5, 0.02, 12.0}}, model::RigKind::component_bench),
            "to tell hysteresis from lag, run 0.5 Hz at ± 20 mm (a second of it separates them 12 times as well as one "
            "recorded here)");
}

}  // namespace
