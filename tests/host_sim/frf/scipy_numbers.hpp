// tests/golden/frf_scipy.txt: two signals and SciPy's spectra of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "host_sim/frf/cross_spectra.hpp"
#include "tests/support/rig_texts.hpp"

namespace support {

struct ScipyNumbers {
  struct Line {
    double frequency, xx, yy;
    host_sim::frf::Complex xy;
  };
  struct Spectra {
    host_sim::frf::BlockScheme scheme;
    std::vector<Line> lines;
  };
  double rate = 0.0;
  std::vector<double> x, y;
  std::vector<Spectra> spectra;
};

inline ScipyNumbers scipy_numbers() {
  std::ifstream file(source / "tests/golden/frf_scipy.txt");
  EXPECT_TRUE(file);
  const auto named = [](const std::string& word, const auto& names) {
    return static_cast<unsigned char>(std::find(names.begin(), names.end(), word) - names.begin());
  };
  std::string word;
  std::getline(file, word);
  EXPECT_NE(word.find("scipy"), std::string::npos) << "says where it is from";
  ScipyNumbers numbers;
  std::size_t count = 0;
  file >> word >> numbers.rate >> count;
  numbers.x.resize(count), numbers.y.resize(count);
  for (std::size_t n = 0; n < count; ++n) file >> numbers.x[n] >> numbers.y[n];
  std::string window, trend;
  for (std::size_t length = 0, hop = 0, lines = 0; file >> word >> window >> length >> hop >> trend >> lines;) {
    numbers.spectra.push_back({{length, hop, static_cast<host_sim::WindowShape>(named(window, host_sim::window_names)),
                                static_cast<host_sim::Detrend>(named(trend, host_sim::detrend_names))},
                               {}});
    for (std::size_t k = 0; k < lines; ++k) {
      double f = 0.0, xx = 0.0, yy = 0.0, real = 0.0, imaginary = 0.0;
      file >> f >> xx >> yy >> real >> imaginary;
      numbers.spectra.back().lines.push_back({f, xx, yy, {real, imaginary}});
    }
  }
  return numbers;
}

}  // namespace support
