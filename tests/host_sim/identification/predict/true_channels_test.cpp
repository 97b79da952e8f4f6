// What a rig would have recorded, and what no rig would.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/identification/predict/sensor_readings.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim;
using model::Channel;

// Fault. A fit may ask for what is no rig, by itself or where a parameter drifts to: it gets no numbers, and the rig
// beside it gets its own.
TEST(TrueChannels, AreNoNumbersOfNoRig) {
  const firmware::RigDescription bench = sample::bench();
  const auto recordings = sample::prepared(bench, bench);
  const identification::PreparedRecording& r = recordings.front();
  const identification::Hypothesis given = identification::described_hypothesis(bench, recordings);
  identification::Hypothesis none = given, drifting = given;
  none.rig.suspension.stiffness = std::nan("");
  drifting.faults = {{.kind = identification::FaultKind::drift,
                      .path = "suspension.damping",
                      .values = {-3.0, 0.0},
                      .fitted = {true, false}}};
  const auto f = index(Channel::F);
  for (const auto& hypothesis : {none, drifting}) {
    const Response alone = identification::true_channels(hypothesis, r, r.input, given.starts[0], 100, {1});
    ASSERT_EQ(alone[f].size(), 100U);
    EXPECT_TRUE(std::isnan(alone[f][99]));
  }
  const auto two = identification::true_channels_of_each(
      {{&none, none.starts.data(), &r.input}, {&given, given.starts.data(), &r.input}}, r, 100, {1});
  EXPECT_TRUE(std::isnan(two[0][f][99]));
  EXPECT_EQ(two[1][f], identification::true_channels(given, r, r.input, given.starts[0], 100, {1})[f]);
}

// F_w carries wheel and body, m_w z̈_w + m_b z̈_b, also where the wheel's motion is prescribed and a cubic between its
// samples. At 40 Hz and 1 kHz the end of that cubic has (ωh)²/12 = 0.5 % too much acceleration, which is corrected; the
// stiff tyre of the simulation lags by ω² m_w/k = 3e-5 of it.
TEST(TrueChannels, KnowTheLoadOfAPrescribedWheel) {
  const firmware::RigDescription car = firmware::parse_rig(std::string(support::quarter_car_text), "car.toml");
  constexpr double h = 1e-3, omega = 2.0 * std::numbers::pi * 40.0, amplitude = 1e-3;
  SimulationInput input;
  input.period = h;
  input.wheel_prescribed = true;
  identification::PreparedRecording recording;
  for (std::size_t k = 0; k < 2000; ++k) {
    const double phase = omega * h * static_cast<double>(k);
    input.motion.push_back({amplitude * std::sin(phase), amplitude * omega * std::cos(phase),
                            -amplitude * omega * omega * std::sin(phase)});
  }
  identification::Hypothesis hypothesis;
  hypothesis.rig = car.rig;
  const InitialState start = resting(car.rig, input);
  const Response response = identification::true_channels(hypothesis, recording, input, start, 0, {1});
  const double most = car.rig.wheel.mass * amplitude * omega * omega;
  for (std::size_t k = 1; k < input.size(); ++k) {
    const double carried =
        car.rig.wheel.mass * input.motion[k].acceleration + car.rig.body.mass * response[index(Channel::zdd_b)][k];
    ASSERT_NEAR(response[index(Channel::F_w)][k], carried, 1e-4 * most) << k;
  }
}

}  // namespace
