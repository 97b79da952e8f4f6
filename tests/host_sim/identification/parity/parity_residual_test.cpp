// Where a fault sits, before anything is fitted. The recordings come from tests/truth, which shares no code with the
// model.
#include "host_sim/identification/parity/parity_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/parity/fault_location.hpp"
#include "host_sim/identification/parity/smooth_window.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using identification::likely_fault_location;
using identification::ParityResidual;
using identification::SmoothWindow;

std::vector<ParityResidual> relations(const std::string& group, std::uint64_t seed = 1, bool varied = false) {
  truth::Wanted wanted;
  wanted.duration = 16.0;
  wanted.varied = varied;
  const truth::Truth truth = truth::draw(group, seed, wanted);
  const RigDescription description = parse_rig(truth::rig_toml(truth), "rig.toml");
  std::vector<identification::PreparedRecording> recordings;
  for (const truth::Record& record : truth::simulate(truth)) {
    recordings.push_back(identification::prepare_recording(
        description, parse_recording_csv(truth::csv(truth, record), "rec.csv"), identification::Use::fitted, false));
  }
  return identification::parity_residuals(description, recordings);
}

// Point. φ ∗ 1 = 1; φ′ and φ″ make iω and −ω² of what φ makes of a sine, up to the spline's leakage near the sample
// rate: (f/(1000 − f))⁴ = 4e-7 in φ′, and 1e-4 in φ″ at 25 Hz.
TEST(SmoothWindow, DifferentiatesThroughItself) {
  const SmoothWindow window(1e-3);
  EXPECT_NEAR(std::abs(window.gain(0, 0.0) - 1.0), 0.0, 1e-6);
  for (const double f : {0.5, 5.0, 25.0}) {
    const std::complex<double> i_omega(0.0, 2.0 * std::numbers::pi * f), smooth = window.gain(0, f);
    EXPECT_NEAR(std::abs(window.gain(1, f) / (i_omega * smooth) - 1.0), 0.0, 1e-4) << f;
    EXPECT_NEAR(std::abs(window.gain(2, f) / (i_omega * i_omega * smooth) - 1.0), 0.0, 2e-4) << f;
  }
  std::vector<double> sine(400);
  const double omega = 2.0 * std::numbers::pi * 5.0;
  for (std::size_t k = 0; k < sine.size(); ++k) sine[k] = std::sin(omega * 1e-3 * static_cast<double>(k));
  EXPECT_NEAR(window(sine, 1)[200], omega * std::cos(omega * 0.2) * window.gain(0, 5.0).real(), 1e-3 * omega);
  EXPECT_EQ(window(sine, 0).front(), 0.0);
}

// Law. Deviations inside the tolerances and noise leave every relation standing.
TEST(ParityResidual, HoldsWhereNothingIsHidden) {
  for (const char* group : {"none:quarter_car", "none:hil", "none:component_bench"}) {
    const auto list = relations(group);
    EXPECT_EQ(list.size(),
              std::string(group) == "none:quarter_car" ? 6U : (std::string(group) == "none:hil" ? 3U : 2U));
    for (const ParityResidual& r : list)
      EXPECT_FALSE(r.significant()) << group << " " << r.relation << " " << r.significance;
    EXPECT_EQ(likely_fault_location(list), "") << group;
  }
  // At 2 kHz, with a deflection sensor so noisy that the ends of a block differ in their velocity by more than the
  // accelerations at 0.5 Hz.
  for (const ParityResidual& r : relations("none:quarter_car", 8, true))
    EXPECT_FALSE(r.significant()) << r.relation << " varied";
  // An offset, which the window would let through to the next line.
  for (const ParityResidual& r : relations("single:quarter_car:sensor_offset:zdd_b")) {
    EXPECT_FALSE(r.significant()) << r.relation << " with an offset, " << r.significance;
  }
  // An absorber's losses at their bounds: a force that is not linear in them.
  for (const ParityResidual& r : relations("none:component_bench", 5))
    EXPECT_FALSE(r.significant()) << r.relation << " seed 5";
}

// Each part of a car, each of its sensors: the fault is seen where it is, though nobody has said what it is.
TEST(ParityResidual, PointsAtTheFaultyPlace) {
  for (const auto& [group, place] :
       {std::pair("single:quarter_car:coulomb_friction", "suspension"),
        std::pair("single:quarter_car:body_guide_damping", "body guide"),
        std::pair("single:quarter_car:wheel_guide_friction", "wheel guide"),
        std::pair("single:quarter_car:progressive_tyre", "tyre"), std::pair("single:hil:progressive_tyre", "tyre"),
        std::pair("single:quarter_car:sensor_gain:F_w", "sensor F_w"),
        std::pair("single:quarter_car:sensor_lag:zdd_w", "sensor zdd_w"),
        std::pair("single:quarter_car:sensor_gain:zdd_b", "sensor zdd_b"),
        std::pair("single:quarter_car:sensor_delay:dz_b", "sensor dz_b"),
        std::pair("single:quarter_car:sensor_saturation:dz_w", "sensor dz_w"),
        std::pair("single:quarter_car:sensor_gain:zdd_r", "sensor zdd_r"),
        std::pair("unknown:quarter_car:hysteresis", "suspension"),
        std::pair("unknown:component_bench:jitter", "sensor x_act or machine")}) {
    EXPECT_EQ(likely_fault_location(relations(group)), place) << group;
  }
}

// What the catalogue does not hold is at least described.
TEST(ParityResidual, SaysWhatTheRestLooksLike) {
  const auto looks = [](const char* group) {
    std::string words;
    for (const ParityResidual& r : relations(group)) words += r.description;
    return words;
  };
  EXPECT_NE(looks("unknown:quarter_car:cubic_damping").find("the cube of the velocity"), std::string::npos);
  EXPECT_NE(looks("unknown:component_bench:asymmetric_damper").find("whichever its direction"), std::string::npos);
  EXPECT_NE(looks("single:component_bench:coulomb_friction").find("as dry friction"), std::string::npos);
}

// Point. Two relations A and B, places a (in A), ab (in both alike), b (in B): loud in A alone is a, in both ab; in
// both but unlike what any one place makes of them is nobody's.
TEST(LikelyPlace, IsTheOneThatExplainsAllRelations) {
  const auto of = [](double in_a, double in_b, bool twin = false) {
    ParityResidual a, b;
    a.locations = {{"a", {}}, {"ab", {}}};
    b.locations = {{"b", {}}, {"ab", {}}};
    if (twin) a.locations.push_back({"a's twin", {}});
    for (auto& location : a.locations) location.gain[3] = 2.0;
    for (auto& location : b.locations) location.gain[3] = 1.0;
    a.excess[3] = in_a;
    b.excess[3] = in_b;
    a.significance = 10.0 * in_a;
    b.significance = 10.0 * in_b;
    a.ratio = 1.0 + in_a;
    b.ratio = 1.0 + in_b;
    return likely_fault_location({a, b});
  };
  EXPECT_EQ(of(100.0, 0.0), "a");
  EXPECT_EQ(of(0.0, 100.0), "b");
  EXPECT_EQ(of(100.0, 50.0), "ab");
  EXPECT_EQ(of(100.0, 0.5), "a");
  EXPECT_EQ(of(50.0, 200.0), "b") << "94 % of the squares";
  EXPECT_EQ(of(100.0, 150.0), "");
  EXPECT_EQ(of(100.0, 0.0, true), "a or a's twin");
  EXPECT_EQ(of(0.0, 0.0), "");
}

}  // namespace
