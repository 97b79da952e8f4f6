// Machine and component judged apart. The rigs are made by the model; what no catalogue holds is added to what they
// recorded.
#include "host_sim/identification/select/search_apart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "host_sim/identification/estimate/prediction.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

constexpr double time_constant = 0.022, delay = 0.0045, friction = 60.0;

/// A machine with a lag and a delay.
firmware::RigDescription slow_bench() {
  return sample::with_effect(sample::with_effect(sample::bench(), "actuator_lag", {time_constant}), "actuator_delay",
                             {delay});
}

/// A bench with what a search makes of its recording; `machine`: effects of the machine are candidates.
struct Apart {
  explicit Apart(firmware::Recording recording, bool machine = true) {
    std::vector<PreparedRecording> recordings;
    recordings.push_back(prepare_recording(sample::bench(), std::move(recording), Use::shared, false));
    const Hypothesis given = described_hypothesis(sample::bench(), recordings);
    problem.emplace(std::move(recordings), given);
    space = search_space(sample::bench(), problem->samples(), given);
    SearchOptions options;
    options.criterion.machine = machine;
    if (!machine) options.criterion.sensors = options.criterion.faults = false;
    found = search(*problem, space, options);
  }
  std::optional<IdentificationProblem> problem;
  SearchResult found;
  SearchSpace space;
};

std::vector<double> force_of(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  return read_all(problem, hypothesis).front()[index(Channel::F)];
}

// Law. Apart, F is that of the component on the machine that was given, and x_act that of the hypothesis; joined again,
// both are the hypothesis's.
TEST(SearchApart, ForceSaysNothingOfTheMachine) {
  const Apart made(sample::recorded(slow_bench(), 4.0));
  const Hypothesis plain = made.space.given;
  Hypothesis slow = plain;
  const std::vector<firmware::PlacedEffect> machine{{firmware::find_effect("actuator_lag"), std::nullopt, {0.05}}};
  firmware::put_effect(slow.rig, machine.front());
  const IdentificationProblem apart = made.problem->apart(machine);
  EXPECT_EQ(force_of(apart, plain), force_of(*made.problem, slow));
  EXPECT_EQ(force_of(apart, slow), force_of(*made.problem, slow));
  EXPECT_EQ(read_all(apart, plain).front()[index(Channel::x_act)],
            read_all(*made.problem, plain).front()[index(Channel::x_act)]);
  EXPECT_EQ(force_of(apart.joined(), plain), force_of(*made.problem, plain));
  // Side by side, too.
  const Eigen::VectorXd alone = residuals(apart, predict(apart, plain));
  for (const Eigen::VectorXd& lane :
       residuals_of_each(apart, {{plain, {}}, {plain, {}}, {plain, {}}}, false, nullptr)) {
    EXPECT_EQ((lane - alone).norm(), 0.0);
  }
}

// Law. A problem of one channel has its residuals alone.
TEST(SearchApart, OfOneChannelHasItsResiduals) {
  const Apart made(sample::recorded(slow_bench(), 4.0));
  const IdentificationProblem stroke = made.problem->of_channels({Channel::x_act});
  const Eigen::VectorXd both = residuals(*made.problem, predict(*made.problem, made.space.given));
  const Eigen::VectorXd one = residuals(stroke, predict(stroke, made.space.given));
  ASSERT_EQ(2 * one.size(), both.size());
  const std::size_t place = made.problem->channels().front() == Channel::x_act ? 0 : 1;
  double squares = 0.0;  // by bin: real and imaginary parts of both channels
  for (Eigen::Index k = 0; k < both.size(); ++k) {
    if (static_cast<std::size_t>(k / 2) % 2 == place) squares += both(k) * both(k);
  }
  EXPECT_NEAR(one.squaredNorm() / squares, 1.0, 1e-9);
}

// Law. Where the catalogue explains the stroke nothing is judged apart.
TEST(SearchApart, LeavesAloneWhatIsExplained) {
  Apart made(sample::recorded(slow_bench()));
  EXPECT_EQ(made.found.best.effects.size(), 2U);
  EXPECT_FALSE(search_apart(*made.problem, made.space, {}, made.found));
}

// Journey. Something shakes the machine by 0.3 mm at 1.7 Hz, where nothing is commanded, and a joint search that was
// not allowed machines has bent the component. Apart, lag and delay are what they are, and the component has its
// friction alone. 3 %: what a tenth of the motion leaks into a window of 6 s at a distance of 0.6 Hz, (1/(6 · 0.6))²/4
// = 2 %.
TEST(SearchApart, FindsTheMachineFromItsStroke) {
  firmware::Recording recording = sample::recorded(sample::with_effect(slow_bench(), "coulomb_friction", {friction}));
  for (std::size_t k = 0; k < recording.time.size(); ++k) {
    recording[Channel::x_act][k] += 0.3e-3 * std::sin(2.0 * std::numbers::pi * 1.7 * recording.time[k]);
  }
  Apart made(std::move(recording), false);
  ASSERT_TRUE(search_apart(*made.problem, made.space, {}, made.found));
  ASSERT_TRUE(made.problem->samples().front().machine);
  const auto value_of = [&](const char* name) {
    for (const firmware::PlacedEffect& effect : made.found.best.effects) {
      if (effect.entry->name == name) return effect.values.front();
    }
    return 0.0;
  };
  EXPECT_EQ(made.found.best.effects.size(), 3U);
  EXPECT_NEAR(value_of("actuator_lag"), time_constant, 0.03 * time_constant);
  EXPECT_NEAR(value_of("actuator_delay") + value_of("actuator_lag"), delay + time_constant, 0.03 * time_constant);
  EXPECT_NEAR(value_of("coulomb_friction"), friction, 0.03 * friction);
  ASSERT_EQ(made.found.causes.size(), made.found.best.effects.size());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(made.found.causes[i].gain, 0.0);
    ASSERT_FALSE(made.found.causes[i].rivals.empty());
    // One with more parameters may be better by thresholds::replaces_error, squared.
    EXPECT_GT(made.found.causes[i].rivals.front().penalised_chi_squared,
              0.96 * made.found.best.penalised_chi_squared({}));
  }
}

}  // namespace
