// The rig as its Kalman filter computes it: the small motion of the model's own step, and laws over a road.
#include "firmware/description/filtered_rig.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/description/semi_active_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/kalman/estimator_equations.hpp"
#include "model/rig/rig_model.hpp"

namespace filtered_rig_test {
namespace {

using firmware::EstimatorEquations;
using firmware::EstimatorMatrix;
using firmware::EstimatorVector;
using model::CoreIndex;

constexpr const char* car =
    "kind = \"quarter_car\"\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\nstiffness = "
    "200e3\ndamping = 100.0\n[noise]\nzdd_b = 0.05\nzdd_w = 0.05\ndz_b = 2.5e-4\n[estimator]\nkind = \"kalman\"\n";
constexpr const char* spring = "[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n";
constexpr const char* lever = "[lever]\nat = [-0.1, 0.1]\nratio = [0.7, 0.9]\n";
constexpr const char* absorber =
    "[fdva]\npiston_area = 30e-4\nduct_diameter = 12e-3\nduct_length = 0.6361571127\noil_density = 860.0\n"
    "oil_viscosity = 32e-6\nminor_loss = 0.0\ncoupling_stiffness = 55e3\nducts = 6\nopen_ducts = 2\n";
constexpr const char* straight_damper =
    "[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 1.0]\nvalue = [-300.0, 300.0]\n";

firmware::RigDescription described(const std::string& more) {
  return firmware::parse_rig(std::string(car) + more, "rig.toml");
}

/// Most that a state of the filter is off, of the largest of its size, when model and filter move freely for 60 ms from
/// a deflection of a micrometre: a difference of the model's step at rest.
double departure(const firmware::RigDescription& description) {
  const auto settings = firmware::kalman_settings(description);
  const EstimatorEquations equations(settings, firmware::filtered_rig(description, settings));
  const model::RigModel<> model(description.rig, 1e-3);
  const int open = description.rig.has_fdva ? description.rig.fdva.open_ducts : 0;
  const EstimatorMatrix step =
      model::ExactDiscretisation<double, firmware::estimator_states>(equations.matrix(open), 1e-3).transition();
  model::Column<double, model::plain_core_states> core = model::Column<double, model::plain_core_states>::Zero();
  constexpr double small = 1e-6;
  core(CoreIndex::wheel_position) = small;
  auto x = model.start(core, {}, {});
  EstimatorVector y = EstimatorVector::Zero();
  const std::vector<int> entries{CoreIndex::wheel_position, CoreIndex::wheel_velocity, CoreIndex::body_position,
                                 CoreIndex::body_velocity};
  for (int i = 0; i < model::core_states; ++i) {
    if (equations.core(i) >= 0) y(equations.core(i)) = x.core(i);
  }
  std::vector<double> off(entries.size()), size(entries.size());
  for (int k = 0; k < 60; ++k) {
    model.step(x, {});
    y = (step * y).eval();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      off[i] = std::max(off[i], std::abs(y(equations.core(entries[i])) - x.core(entries[i])));
      size[i] = std::max(size[i], std::abs(x.core(entries[i])));
    }
  }
  double most = 0.0;
  for (std::size_t i = 0; i < entries.size(); ++i) most = std::max(most, off[i] / size[i]);
  return most;
}

// Law. The filter's matrix is the small motion of the model, for parts that are linear at rest and for pairs of them. A
// law acts explicitly in a step of the model: an error ∝ h³ (lever, air spring) or h² (curves) of some 1e-3 in 60 ms.
TEST(FilteredRig, MovesAsTheModelDoesNearRest) {
  const std::vector<std::pair<std::string, std::string>> parts{
      {"spring", spring},
      {"lever", std::string(spring) + lever},
      {"absorber", std::string(spring) + absorber},
      {"lever and absorber", std::string(spring) + lever + absorber},
      {"curve", std::string(spring) + straight_damper},
      {"surface", std::string(spring) +
                      "[laws.surface]\nplace = \"suspension\"\nover = [\"deflection\", \"velocity\"]\nat = [-0.1, 0.1]"
                      "\nat_2 = [-1.0, 1.0]\nvalue = [[-700.0, -100.0], [100.0, 700.0]]\n"},
      {"tyre curve", std::string(spring) + "[laws.tread]\nplace = \"tyre\"\nover = \"deflection\"\nat = [-0.1, 0.1]\n"
                                           "value = [-3000.0, 3000.0]\n"},
      {"guide", std::string(spring) + "[laws.slide]\nplace = \"wheel_guide\"\nover = \"velocity\"\nat = [-1.0, 1.0]\n"
                                      "value = [-400.0, 400.0]\n"},
      {"Maxwell branch", std::string(spring) + "[laws.rubber]\nplace = \"suspension\"\nbranches = [{ stiffness = 8e3, "
                                               "time_constant = 0.02 }]\n"},
      {"air spring",
       "[suspension]\nstiffness = 0.0\ndamping = 1140.0\n[air_spring]\npressure = 7e5\narea = 40.64e-4\n"
       "volume = 0.588e-3\n"},
      {"lever and air spring", std::string("[suspension]\nstiffness = 0.0\ndamping = 1140.0\n[air_spring]\npressure = "
                                           "7e5\narea = 50.8e-4\nvolume = 0.735e-3\n") +
                                   lever}};
  for (const auto& [name, text] : parts) EXPECT_LT(departure(described(text)), 5e-3) << name;
}

// Point. Over a road a law counts with E{f v}/E{v²}: a cubic damper with 3 σ² v, so that its damping and the velocity
// that it leaves belong together; less damped, the same law damps more.
TEST(FilteredRig, LinearisesALawOverTheRoad) {
  std::string at, value;
  for (int i = -16; i <= 16; ++i) {
    const double v = 0.1 * i;
    at += (i > -16 ? ", " : "") + std::to_string(v);
    value += (i > -16 ? ", " : "") + std::to_string(4000.0 * v * v * v);
  }
  const std::string law =
      "[laws.cubic]\nplace = \"suspension\"\nover = \"velocity\"\nat = [" + at + "]\nvalue = [" + value + "]\n";
  const auto damping = [&](const std::string& description) {
    const auto rig = described(description);
    return firmware::filtered_rig(rig, firmware::kalman_settings(rig)).suspension.damping;
  };
  const double beside = damping(std::string(spring) + law) - 1140.0;
  const double bare = damping("[suspension]\nstiffness = 31500.0\ndamping = 600.0\n" + law) - 600.0;
  // σ of 1140 N s/m over the class B road is 0.169 m/s: 3 · 4000 · 0.169² = 343 N s/m, less what this damping takes.
  EXPECT_NEAR(beside, 300.0, 60.0);
  EXPECT_GT(bare, 1.2 * beside);
}

// Fault. A skyhook's force is no input of the filter.
TEST(FilteredRig, RefusesASkyhook) {
  const auto rig = described(
      "[suspension]\nstiffness = 0.0\ndamping = 1140.0\n[air_spring]\npressure = 7e5\narea = 40.64e-4\nvolume = "
      "0.588e-3\nskyhook = 1000.0\n");
  EXPECT_THROW((void)firmware::companion(rig), firmware::InputError);
}

}  // namespace
}  // namespace filtered_rig_test
