// The rival: time waveform replication by the inverse of a measured frequency response.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_limits.hpp"

namespace replicate_rival {

/// H1 of a run, z̈_w over z_cmd, by Welch's method with 4 s of Hann window that overlap by half, straight between its
/// lines, at the bins of a transform of `length` samples.
[[nodiscard]] std::vector<std::complex<double>> measured_response(const firmware::Recording& run, std::size_t length);

/// u_1 = g H⁺ t, u_{k+1} = u_k + g H⁺ (t − y_k), in the band of the target, with the regularisation and the projection
/// onto the machine's limits that `rigtwin replicate` has: the difference is the model alone. Source: the iteration of
/// commercial systems as J. De Cuyper describes it (PhD thesis, KU Leuven, 2006), chapter 2.
class InverseResponse {
 public:
  InverseResponse(const host_sim::replicate::Target& target, const std::vector<std::complex<double>>& response,
                  const host_sim::replicate::DriveLimits& limits, double gain);

  [[nodiscard]] const std::vector<double>& drive() const { return drive_; }
  /// t − y in the band of the target; what an answer that ended early lacks is an error.
  [[nodiscard]] std::vector<double> error(const std::vector<double>& answer) const;
  [[nodiscard]] double target_rms() const { return inverse_.target_rms(0); }
  /// The rig's answer to drive(); makes the next.
  void take(const std::vector<double>& answer);

 private:
  const host_sim::replicate::Target& target_;
  host_sim::replicate::BandInverse inverse_;
  host_sim::replicate::LimitProjection limits_;
  double gain_;
  std::vector<double> drive_;
};

}  // namespace replicate_rival
