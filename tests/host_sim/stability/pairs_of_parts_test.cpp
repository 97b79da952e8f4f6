// Parts that are right alone, two at a time: each pair rests where it begins, and its analysis is that of the step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/sides_of_rest.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace pairs_of_parts_test {
namespace {

using model::Channel;
using stability_tests::Rig;

struct Part {
  std::string name;
  std::function<void(Rig&)> fit;
};

void fit_lever(Rig& rig, double below, double above) {
  rig.lever.count = 3;
  rig.lever.at = {-0.08, 0.0, 0.08};
  rig.lever.ratio = {0.8 - 0.08 * below, 0.8, 0.8 + 0.08 * above};
}

const std::vector<Part>& parts() {
  static const std::vector<Part> all{
      {"lever", [](Rig& r) { fit_lever(r, 0.6, 0.6); }},
      {"lever with a kink at rest", [](Rig& r) { fit_lever(r, 1.5, 0.0); }},
      {"air spring", [](Rig& r) { r.air_spring = stability_tests::air_spring_rig(0.0, 0.0, 0.0).air_spring; }},
      {"air spring with skyhook",
       [](Rig& r) { r.air_spring = stability_tests::air_spring_rig(0.0, 0.0, 1000.0).air_spring; }},
      {"absorber",
       [](Rig& r) {
         r.has_fdva = true;
         r.fdva = stability_tests::fdva_rig().fdva;
       }},
      {"curve",
       [](Rig& r) {
         auto& curve = r.laws.curves[r.laws.curve_count++];
         curve.count = 3;
         curve.at = {-1.0, 0.0, 1.0};
         curve.value = {-300.0, 0.0, 150.0};
       }},
      {"Maxwell branch",
       [](Rig& r) { r.laws.branches[r.laws.branch_count++] = {.stiffness = 5e3, .time_constant = 0.02}; }},
      {"slider", [](Rig& r) { r.laws.branches[r.laws.branch_count++] = {.stiffness = 5e3, .slip_force = 30.0}; }},
      {"damper of two slopes", [](Rig& r) { r.effects.add(model::AsymmetricDamper<double>{300.0}); }},
      {"delay that varies", [](Rig& r) { r.delay_variation = {.swing = 1e-3, .time = 3.0, .jitter = 2e-4}; }},
      {"lag of the machine", [](Rig& r) { r.effects.add(model::ActuatorLag<double>{0.002}); }},
      {"lag of F", [](Rig& r) { r.effects.add(Channel::F, model::SensorLag<double>{0.001}); }},
      {"relaxation",
       [](Rig& r) {
         r.effects.add(model::Relaxation<double>{8e3, 0.01});
       }},
      {"top mount", [](Rig& r) { r.effects.add(model::TopMount<double>{4e5}); }},
  };
  return all;
}

/// All 91 pairs take 9 s (they pass): here those of the kink, and half of those of the air spring.
bool looked_at(std::size_t a, std::size_t b) { return a == 1 || b == 1 || (a == 2 && b % 2 == 0); }

/// Nothing moves that is left alone: 1e-12 m are rounding beside the pressure of an air spring.
void expect_rest(const Rig& rig, const std::string& who) {
  const model::RigModel<> model(rig, 1e-3);
  auto x = model.start();
  for (int k = 0; k < 300; ++k) model.step(x, {});
  EXPECT_LT(std::abs(model.deflection(x).position), 1e-12) << who;
}

// Law. No pair ends in an internal error: the matrix of a step is checked against the step, the roots against their
// count, and one kink takes no other part's slope. What is refused says why.
TEST(PairsOfParts, AreAnalysedAndRestWhereTheyBegin) {
  for (std::size_t a = 0; a < parts().size(); ++a) {
    for (std::size_t b = a + 1; b < parts().size(); ++b) {
      if (!looked_at(a, b)) continue;
      const std::string who = parts()[a].name + " and " + parts()[b].name;
      Rig rig = stability_tests::linear_rig(0.005, 1140.0);
      parts()[a].fit(rig);
      parts()[b].fit(rig);
      if (model::find_fault(rig, 1e-3, model::RigModel<>::Line::longest)) continue;  // said in one line
      expect_rest(rig, who + ", hil");
      try {
        const auto found = host_sim::stability::analyse(stability_tests::described(rig));
        ASSERT_TRUE(found.sampled) << who;
        EXPECT_TRUE(found.stable_as_run()) << who;  // 5 ms, 1140 N s/m: far from every border
      } catch (const firmware::InputError& refused) {
        ADD_FAILURE() << who << ": " << refused.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << who << ": internal error: " << error.what();
      }
      rig.kind = model::RigKind::quarter_car;
      rig.machine = {};
      rig.delay_variation = {};
      rig.effects.get<model::ActuatorDelay>().active = rig.effects.get<model::ActuatorLag>().active = false;
      rig.effects.get<model::SensorLag>(Channel::F).active = false;
      if (!model::find_fault(rig, 1e-3, model::RigModel<>::Line::longest)) expect_rest(rig, who + ", quarter_car");
    }
  }
}

/// dz_b and F of a rig that a road of a few 0.1 µm shakes, less those at rest.
std::vector<double> small_motion(const Rig& rig) {
  const model::RigModel<> model(rig, 1e-3);
  auto x = model.start();
  const double at_rest = model.signals(x)[model::index(Channel::F)];
  std::vector<double> moved;
  for (int k = 1; k <= 400; ++k) {
    const double t = 1e-3 * k, rise = 1e-7 * (1.0 - std::cos(30.0 * t)), rate = 3e-6 * std::sin(30.0 * t);
    model.step(x, {.foot_point = {rise, rate, 9e-5 * std::cos(30.0 * t)}});
    moved.push_back(31500.0 * model.deflection(x).position);
    moved.push_back(model.signals(x)[model::index(Channel::F)] - at_rest);
  }
  return moved;
}

// Law. What is analysed is the small motion of the rig: the linear part of every pair whose parts all have one moves as
// the pair does near rest, by differences of the model's step.
TEST(PairsOfParts, LinearPartIsTheSmallMotion) {
  int compared = 0;
  for (std::size_t a = 0; a < parts().size(); ++a) {
    for (std::size_t b = a + 1; b < parts().size(); ++b) {
      Rig rig = stability_tests::linear_rig(0.005, 1140.0);
      parts()[a].fit(rig);
      parts()[b].fit(rig);
      rig.delay_variation = {};
      rig.fdva.minor_loss = 0.0;  // of the square of the motion
      if (model::find_fault(rig, 1e-3, model::RigModel<>::Line::longest)) continue;
      if (host_sim::stability::sides_of_rest(rig).size() > 1) continue;
      if (!host_sim::stability::linearise(rig).left_out.empty()) continue;
      const auto whole = small_motion(rig), linear = small_motion(host_sim::stability::sampled_part(rig));
      double off = 0.0, size = 0.0;
      for (std::size_t i = 0; i < whole.size(); ++i) {
        off = std::max(off, std::abs(whole[i] - linear[i]));
        size = std::max(size, std::abs(whole[i]));
      }
      // Laws act explicitly in a step, their slopes exactly; the heat of an air spring is a branch behind it.
      EXPECT_LT(off, 0.02 * size) << parts()[a].name << " and " << parts()[b].name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 40);
}

}  // namespace
}  // namespace pairs_of_parts_test
