// Bode and Nyquist data with the true delay.
#pragma once

#include <string>
#include <vector>

#include "host_sim/stability/roots/linear_rig.hpp"
#include "model/components/channel.hpp"

namespace host_sim::stability {

/// The closed loop driven by the road.
class RoadResponse {
 public:
  /// \param delay    of the whole loop [s]; `machine_delay` is the part between x_cmd and x_act, the rest lies behind F
  RoadResponse(const LinearRig& rig, double delay, double machine_delay);

  /// Output ÷ z_r at ω > 0. Outputs: z_w, z_b, zdd_w, zdd_b, dz_w, dz_b, F_w, x_cmd, x_act, and F, the component's
  /// force at the machine. Solves (jω − A − B H(jω) e^{−jωτ} C) X = B_r [1, jω].
  [[nodiscard]] Complex operator()(model::Channel output, double omega) const;

  [[nodiscard]] static std::vector<model::Channel> outputs();

 private:
  StateSpace car_;
  double lever_ratio_;
  std::optional<Eigen::Index> area_force_;
  Polynomial machine_over_, machine_under_, component_over_, component_under_, behind_over_, behind_under_;
  double delay_, machine_delay_;
};

/// A response over frequency: |G| and its unwrapped phase, which begins in −π … π at the lowest frequency.
struct ResponseCurve {
  std::string name, unit;
  std::vector<double> magnitude;
  std::vector<double> phase;  ///< [rad]
};

struct BodeData {
  std::vector<double> frequency_hz;
  ResponseCurve loop;                  ///< L = (Q/P) e^{−sτ}, 1 + L = 0 on the border
  std::vector<ResponseCurve> outputs;  ///< output ÷ z_r
};

/// `count` logarithmically spaced frequencies, with additional ones around weakly damped roots.
[[nodiscard]] std::vector<double> frequencies(double from_hz, double to_hz, std::size_t count,
                                              const std::vector<Complex>& roots);

/// \param delay  of the loop [s]; `machine_delay`: see RoadResponse
[[nodiscard]] BodeData bode(const LinearRig& rig, double delay, double machine_delay,
                            const std::vector<double>& frequency_hz);

/// Phase of response(ω) along ascending ω, unwrapped: each interval is halved until no part turns by more than π/4.
template <class Response>
[[nodiscard]] std::vector<double> unwrapped_phase(const Response& response, const std::vector<double>& omega);

/// Highest |output ÷ z_r| between two frequencies.
struct Peak {
  double frequency_hz{};
  double magnitude{};
};
[[nodiscard]] Peak peak(const RoadResponse& response, model::Channel output, double from_hz, double to_hz);

/// L(s) along Re s = `offset`, slightly right of the axis, because L may have poles on the axis (a free body: 1/s).
struct NyquistData {
  double offset{};             ///< [1/s]
  std::vector<double> omega;   ///< [rad/s], 0 … the radius beyond which |L| < 1
  std::vector<Complex> loop;   ///< L(offset + jω); the other half is its mirror image
  int encirclements{};         ///< of −1, counter-clockwise, by both halves: the turns of 1 + L
  int open_loop_unstable{};    ///< poles of L right of the line
  int closed_loop_unstable{};  ///< open_loop_unstable − encirclements: roots right of the line
};
[[nodiscard]] NyquistData nyquist(const DelayEquation& equation, const std::vector<Complex>& roots);

template <class Response>
std::vector<double> unwrapped_phase(const Response& response, const std::vector<double>& omega) {
  std::vector<double> phase;
  const auto turn = [&](const auto& self, double low, Complex at_low, double high, Complex at_high,
                        int depth) -> double {
    const double middle = 0.5 * (low + high);
    const Complex at_middle = response(middle);
    const double first = std::arg(times(at_middle, std::conj(at_low)));
    const double second = std::arg(times(at_high, std::conj(at_middle)));
    constexpr double eighth = 0.78539816339744831;
    if (depth == 0 || (std::abs(first) < eighth && std::abs(second) < eighth)) return first + second;
    return self(self, low, at_low, middle, at_middle, depth - 1) +
           self(self, middle, at_middle, high, at_high, depth - 1);
  };
  Complex before;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const Complex now = response(omega[i]);
    phase.push_back(i == 0 ? std::arg(now) : phase.back() + turn(turn, omega[i - 1], before, omega[i], now, 30));
    before = now;
  }
  return phase;
}

}  // namespace host_sim::stability
