// Sampled loops with a lever or an air spring under a skyhook: their slopes at rest, with and without compensation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <tuple>
#include <vector>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/compensation/method_comparison.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/sampled_loop.hpp"
#include "model/rig/lever_at_rest.hpp"
#include "tests/host_sim/stability/rigs.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace nonlinear_loop {
namespace {

namespace stability = host_sim::stability;
namespace compensation = host_sim::compensation;
using compensation::CompensatedLoop;
using model::Channel;
using stability_tests::described;
using stability_tests::Rig;

Rig levered(Rig rig) {
  rig.lever.count = 3;
  rig.lever.at = {-0.1, 0.02, 0.1};
  rig.lever.ratio = {0.6, 0.8, 0.9};
  return rig;
}

/// An actuator of second order where `damping` is not zero.
Rig on_air(double damping) {
  Rig rig = stability_tests::air_spring_rig(0.010, 700.0, 2000.0);
  rig.air_spring.actuator_damping = damping;
  return rig;
}

std::vector<Rig> rigs() {
  Rig stuck = on_air(0.0), leaner = on_air(0.0), without_skyhook = on_air(0.0);
  stuck.effects.add(model::StuckArea<double>{0.03});
  leaner.effects.add(model::GasExponent<double>{1.2});
  without_skyhook.air_spring.skyhook = 0.0;
  without_skyhook.effects.add(model::GasExponent<double>{1.2});
  return {levered(stability_tests::linear_rig()),
          on_air(0.0),
          on_air(0.7),
          levered(on_air(0.0)),
          stuck,
          leaner,
          without_skyhook};
}

/// A description of the paper's air spring or of its absorber behind a lever, whose loops need virtual damping.
firmware::RigDescription undamped(const std::string& name, double damping, const std::string& more) {
  const std::string text = support::with(support::TemporaryFolder::read(support::rig_file(name)),
                                         "virtual_damping = 1140.0", "virtual_damping = " + std::to_string(damping));
  return firmware::parse_rig(text + more, "rig.toml");
}

constexpr const char* lever_text = "\n[lever]\nat = [-0.1, 0.02, 0.1]\nratio = [0.85, 0.95, 1.0]\n";

// Law. With a short period the step is the continuous rig with half a period more delay, in the tyre's load, the
// component's travel and the machine's: two codes for one loop. What is left is of the order of 2 π f T = 1 % at 20 Hz
// and 10 kHz for the skyhook's command, which is held too.
TEST(NonlinearLoop, TendsToTheContinuousRig) {
  constexpr double period = 1e-4;
  for (const Rig& rig : rigs()) {
    const auto loop = compensation::compensated_loop(stability::sampled_part(rig), period, nullptr);
    const auto linear = stability::linearise(rig);
    const stability::RoadResponse response(linear, linear.delay() + 0.5 * period, linear.machine_delay);
    for (const double hz : {0.5, 1.5, 5.0, 12.0, 20.0}) {
      const double omega = host_sim::full_turn * hz;
      const auto y = loop.response(omega);
      const auto expect_near = [&](CompensatedLoop::Output output, Channel channel) {
        const auto truth = response(channel, omega);
        EXPECT_LT(std::abs(y(output) - truth), 0.01 * std::abs(truth)) << model::name(channel) << ' ' << hz;
      };
      expect_near(CompensatedLoop::wheel_load, Channel::F_w);
      expect_near(CompensatedLoop::wanted, Channel::x_cmd);
      expect_near(CompensatedLoop::reached, Channel::x_act);
    }
  }
}

// Law. The body's equation, m_b z̈_b = i F + F₀ i′ d + b̃ ḋ, d = z_w − z_b: F has the skyhook's part, and a lever turns
// it.
TEST(NonlinearLoop, ForceMovesTheBody) {
  for (const Rig& rig : rigs()) {
    const auto linear = stability::linearise(rig);
    const stability::RoadResponse response(linear, 0.0, 0.0);
    const model::LeverAtRest lever = model::lever_at_rest(rig);
    for (const double hz : {0.5, 5.0, 12.0}) {
      const double omega = host_sim::full_turn * hz;
      const auto inertia = rig.body.mass * response(Channel::zdd_b, omega);
      const auto force = lever.ratio * response(Channel::F, omega) +
                         (lever.stiffness + std::complex<double>(0.0, omega * rig.machine.virtual_damping)) *
                             response(Channel::dz_b, omega);
      EXPECT_LT(std::abs(inertia - force), 1e-9 * std::abs(inertia)) << hz;
    }
  }
}

// Law. The matrix takes a nonlinear step where the model takes it (step_matrix compares them and throws where they
// part), and half a period of hold comes on top of the delay; more of it where more is held: the spring F₀ i′ of a
// lever, up to another half where a skyhook's command is.
TEST(NonlinearLoop, StepIsAMatrix) {
  for (const Rig& rig : rigs()) {
    EXPECT_NO_THROW((void)stability::step_matrix(stability::sampled_part(rig), 1e-3, 0.0105));
    const auto a = stability::analyse(described(rig));
    ASSERT_TRUE(a.sampled && a.sampled->added_delay);
    EXPECT_TRUE(a.sampled->stable());
    EXPECT_GT(*a.sampled->added_delay, 0.48e-3);
    EXPECT_LT(*a.sampled->added_delay, rig.air_spring.fitted ? 1.02e-3 : 0.6e-3);
  }
}

// Journey. A skyhook and a lever beside a compensation: what the analysis says is what the loop does. Without one the
// energy guard stops both.
TEST(NonlinearLoop, IsCompensated) {
  const auto reason = [](const firmware::RigDescription& rig) {
    const firmware::RoadChoice road{"iso8608:A", 27.78, 1, std::nullopt, std::nullopt};
    const std::size_t samples = firmware::samples_of(4.0, rig.sample_rate);
    const auto motion = firmware::excitation(
        rig.rig, firmware::motion_over(road, rig, samples, host_sim::read_recording), rig.sample_rate);
    return host_sim::run_closed_loop(rig, motion, {}).trip.reason;
  };
  for (const auto& [name, damping, more] :
       {std::tuple{"paper_hil_aas", 100.0, ""}, std::tuple{"paper_hil_fdva", 0.0, lever_text}}) {
    EXPECT_EQ(reason(undamped(name, damping, more)), firmware::Reason::energy) << name;
    const auto rig = undamped(name, damping, more + std::string("\n[compensation]\nkind = \"adaptive_time_series\"\n"));
    EXPECT_TRUE(compensation::compensated_stability(rig, 0.0).stable) << name;
    EXPECT_EQ(reason(rig), firmware::Reason::reference_ended) << name;
    const auto late =
        undamped(name, damping, more + std::string("\n[compensation]\nkind = \"inverse\"\ndelay = 0.0\n"));
    EXPECT_THROW(compensation::refuse_unstable_compensation(late), firmware::InputError) << name;
    // Against the continuous loop without delay: the inverse of the machine leaves 5 % of the peak, as in a plain loop.
    const auto compared = compensation::compare_methods(rig);
    const auto method = [&](const char* wanted) {
      return *std::find_if(compared.methods.begin(), compared.methods.end(),
                           [&](const auto& m) { return m.name == wanted; });
    };
    EXPECT_FALSE(method("none").over_changes[0].stable) << name;
    EXPECT_LT(method("inverse").over_changes[0].peak_error, 0.05) << name;
    EXPECT_LT(method("inverse").over_changes[4].peak_error, 0.07) << name;  // a component 3 % stiffer
  }
}

}  // namespace
}  // namespace nonlinear_loop
