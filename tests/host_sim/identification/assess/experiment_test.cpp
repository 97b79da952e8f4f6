// Which experiment tells two explanations apart: each kind of experiment where it is the one that must win.
#include "host_sim/identification/assess/experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using identification::Hypothesis;
using identification::IdentificationProblem;
using model::Channel;

constexpr double period = 1e-3;
constexpr std::size_t samples = 8000;

/// A recording of what the rig answers to a foot point (or a command) of one sine, with these channels.
IdentificationProblem recorded(const RigDescription& description, double amplitude, double hz,
                               const std::vector<Channel>& channels) {
  const bool bench = description.rig.kind == model::RigKind::component_bench;
  Recording recording;
  recording.sample_period = period;
  recording.time = sample_times(samples, 1.0 / period);
  auto& input = recording[bench ? Channel::x_cmd : Channel::z_r];
  for (std::size_t k = 0; k < samples; ++k) {
    input.push_back(amplitude * std::sin(2.0 * std::numbers::pi * hz * period * static_cast<double>(k)));
  }
  const SimulationInput driven = simulation_input(description.rig, recording);
  const Response response = host_sim::simulate(description.rig, driven, resting(description.rig, driven));
  firmware::Gaussian gaussian(1, 0);  // noise as declared: what is found to be quieter is believed to be
  for (const Channel channel : channels) {
    for (const double value : response[index(channel)]) {
      recording[channel].push_back(value + description.noise[index(channel)].value_or(0.0) * gaussian());
    }
  }
  return IdentificationProblem(
      {prepare_recording(description, std::move(recording), identification::Use::fitted, false)});
}

Hypothesis with(const RigDescription& description, const char* effect, std::vector<double> values) {
  Hypothesis hypothesis{description.rig, {}};
  put_effect(hypothesis.rig, {find_effect(effect), std::nullopt, std::move(values)});
  return hypothesis;
}

RigDescription car() {
  RigDescription description = support::rig("paper_rig_fdva");
  for (const Channel channel : {Channel::z_r, Channel::dz_b, Channel::dz_w}) {
    description.noise[model::index(channel)] = 1e-5;
  }
  description.noise[model::index(Channel::zdd_w)] = description.noise[model::index(Channel::zdd_b)] = 0.01;
  return description;
}

// A spring that stiffens with the cube of its deflection shows at large deflections: three times the amplitude is 27
// times the force, 9 times as much as a linear rival can follow.
TEST(BestExperiment, IsALargerOneWhereTheForceGrowsWithTheCube) {
  RigDescription d = support::rig("paper_bench_fdva");
  d.noise[model::index(Channel::F)] = 10.0;
  d.noise[model::index(Channel::x_act)] = 1e-5;
  const IdentificationProblem all = recorded(d, 3e-3, 2.0, {Channel::x_act, Channel::F});
  Hypothesis stiffer{d.rig, {}};
  stiffer.rig.suspension.stiffness += 0.75 * 1e7 * 9e-6;  // the first harmonic of the cube
  const std::string words = identification::best_experiment(all, with(d, "progressive_spring", {1e7}), stiffer);
  EXPECT_TRUE(words.starts_with("three times the level of excitation")) << words;
}

// A stiff mount lets what is fast pass: at 1 Hz it is as good as rigid.
TEST(BestExperiment, IsAnotherBandWhereOnlyFastMotionTells) {
  const RigDescription d = car();
  const IdentificationProblem all =
      recorded(d, 5e-3, 1.0, {Channel::dz_b, Channel::dz_w, Channel::zdd_w, Channel::zdd_b});
  const std::string words =
      identification::best_experiment(all, with(d, "top_mount", {8e5}), with(d, "top_mount", {1.6e6}));
  EXPECT_TRUE(words.starts_with("excitation from ")) << words;
  EXPECT_EQ(words.find("0.5 to 3 Hz"), std::string::npos) << words;
}

// Dry friction in the component or on the body's guide: the same force where the wheel stands still, and where only the
// body is measured. What it takes to tell them apart is a sensor elsewhere, or the component alone.
TEST(BestExperiment, IsASensorOrARigThatOnlyOneSuspectReaches) {
  const RigDescription d = car();
  const IdentificationProblem all = recorded(d, 2e-3, 0.7, {Channel::zdd_b});
  const std::string words =
      identification::best_experiment(all, with(d, "coulomb_friction", {20.0}), with(d, "body_guide_friction", {20.0}));
  EXPECT_TRUE(words.starts_with("a sensor of ") || words.starts_with("the component alone on a bench")) << words;
}

// What two equal explanations say is equal in every experiment.
TEST(BestExperiment, IsNoneWhereNothingSeparates) {
  const RigDescription d = car();
  const IdentificationProblem all = recorded(d, 5e-3, 1.0, {Channel::dz_b});
  const Hypothesis same{d.rig, {}};
  EXPECT_TRUE(identification::best_experiment(all, same, same).starts_with("a longer recording"));
}

/// The bench's component with branches of one kind.
Hypothesis with_branch(const RigDescription& description, identification::LawFamily family, double force, double at) {
  Hypothesis hypothesis{description.rig, {}};
  identification::PlacedLaw law;
  law.family = family;
  law.over = identification::CurveOver::deflection;
  law.rms = 2e-3;
  law.at = {at};
  law.values = {force};
  hypothesis.laws = {law};
  put_laws(hypothesis.laws, hypothesis.rig);
  return hypothesis;
}

// Hysteresis and lag that lose as much in a cycle of 5 Hz: slowly, the lag is gone and the hysteresis is not. What is
// proposed is slower, and neither farther nor faster than the component has been moved.
TEST(BestSine, IsASlowOneBetweenHysteresisAndLag) {
  RigDescription d = support::rig("paper_bench_fdva");
  d.noise[model::index(Channel::F)] = 10.0;
  d.noise[model::index(Channel::x_act)] = 1e-5;
  constexpr double amplitude = 3e-3, hz = 5.0;
  const IdentificationProblem all = recorded(d, amplitude, hz, {Channel::x_act, Channel::F});
  const Hypothesis slider = with_branch(d, identification::LawFamily::sliders, 40.0, 0.5e-3);
  const Hypothesis lag = with_branch(d, identification::LawFamily::maxwell, 60.0, 0.02);
  const auto test = identification::best_sine(all, slider, lag);
  ASSERT_TRUE(test);
  EXPECT_LT(test->frequency, hz);
  EXPECT_LE(test->amplitude, 1.1 * amplitude);  // the noise of x_act beside it
  EXPECT_GE(test->separates, 2.0);
  EXPECT_FALSE(identification::best_sine(all, slider, slider));
}

}  // namespace
