// Noise is estimated under a signal.
#include "host_sim/identification/prepare/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;
using sample::sine;

// Point. Sixth differences of a sine leave (2 sin(ωh/2))⁶ of it: nothing at 20 Hz and 1 kHz. The median of K variances
// from 64 samples each scatters by some 1.25 √(2/64)/√K, and lies 1 % low; 5 % are many times that.
TEST(EstimatedNoise, SeesNoiseUnderASignal) {
  auto signal = sine(1.0, 20.0, 60'000);
  support::NormalNoise noise(7);
  for (double& v : signal) v += 1e-3 * noise();
  EXPECT_NEAR(identification::estimated_noise(signal) / 1e-3, 1.0, 0.05) << "seed 7";
}

}  // namespace
