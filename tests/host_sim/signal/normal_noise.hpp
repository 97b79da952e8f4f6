// White normal noise of a seed.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace sample {

inline std::vector<double> noise(std::size_t count, double sigma, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<double> signal(count);
  for (double& x : signal) x = normal(random);
  return signal;
}

}  // namespace sample
