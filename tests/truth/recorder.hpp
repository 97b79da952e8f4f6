#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/truth/random.hpp"
#include "tests/truth/truth.hpp"

namespace truth {

/// A Butterworth low-pass fed at equal steps, order 1 … 4: sections of first and second order by the bilinear transform
/// with the corner where it belongs. Begins in rest at the first value.
class LowPass {
 public:
  LowPass(double corner, int order, double step);
  double push(double value);

 private:
  struct Section {
    std::array<double, 3> in, out;  ///< of the difference equation, newest first
    std::array<double, 3> u{}, y{};
    double push(double value);
  };
  std::vector<Section> sections_;
  bool begun_ = false;
};

/// The recorder of one channel, between sensor and file: low-pass → clock of its own → hum → outliers → rounding.
/// Fed at every node of the fine grid if it filters or has a clock, else at the samples.
class Recording {
 public:
  Recording(const Recorder& recorder, double node, double sample, Random random);  ///< `node`, `sample`: steps [s]

  [[nodiscard]] bool every_node() const { return recorder_.corner > 0.0 || has_clock(); }
  void push(double value, bool at_sample);
  /// The value of a row: `since_start` [s] since the first sample of the record.
  [[nodiscard]] double row(double value, double since_start);
  /// Single samples far off, at places of their own choice.
  void strike(std::vector<double>& rows);
  [[nodiscard]] double rounded(double value) const;

 private:
  [[nodiscard]] bool has_clock() const { return recorder_.late > 0.0 || recorder_.drift > 0.0; }

  Recorder recorder_;
  double node_;
  LowPass low_pass_;
  Random random_;
  double hum_phase_;
  std::vector<double> history_;
};

/// rms of white noise, of one value a sample, behind a recorder's low-pass, relative to before.
[[nodiscard]] double noise_behind(const Recorder& recorder, double sample_rate);

}  // namespace truth
