// Filters of finite length and their window.
#include "host_sim/signal/weighted_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_sim/signal/kaiser.hpp"

namespace {

// Point. I₀ by its series Σ (x/2)^{2k}/k!²; nothing at and beyond the ends.
TEST(KaiserWindow, IsBesselsFunction) {
  const auto bessel = [](double x) {
    double term = 1.0, sum = 1.0;
    for (int k = 1; k < 60; ++k) sum += term *= std::pow(x / (2.0 * k), 2);
    return sum;
  };
  const double beta = 0.1102 * 91.3;
  EXPECT_EQ(host_sim::kaiser_window(0.0), 1.0);
  // 60 terms of one sign: rounding alone.
  EXPECT_NEAR(host_sim::kaiser_window(-0.6) / (bessel(0.8 * beta) / bessel(beta)), 1.0, 1e-13);
  EXPECT_EQ(host_sim::kaiser_window(1.0), 0.0);
  EXPECT_NEAR(host_sim::kaiser_length(0.1), 92.05 / 2.872, 0.01);
}

// Law. The same bits as a plain sum in the order of the weights, over several pieces of the cache; what was there
// before stays in the sum.
TEST(WeightedSums, AreAddedInOrder) {
  const std::vector<double> weights{0.1, -0.7, 3.3, 1e-3};
  std::vector<double> values;
  for (int k = 0; k < 3000; ++k) values.push_back(std::sin(0.37 * k));
  std::vector<double> sums(values.size() - weights.size() + 1, 0.25);
  host_sim::add_weighted_sums(weights.data(), weights.size(), values.data(), sums.data(), sums.size());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    double expected = 0.25;
    for (std::size_t i = 0; i < weights.size(); ++i) expected += weights[i] * values[k + i];
    ASSERT_EQ(sums[k], expected) << k;
  }
}

}  // namespace
