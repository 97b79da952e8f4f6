// Motion of an input between two samples.
#pragma once

#include <array>

namespace model {

/// A displacement with its first derivative: the command and the motion of a test machine.
template <class S>
struct Stroke {
  S position{};  ///< x [m]
  S velocity{};  ///< ẋ [m/s]
};

/// A displacement with two derivatives: the motion of a foot point.
template <class S>
struct Motion {
  S position{};      ///< z [m]
  S velocity{};      ///< ż [m/s]
  S acceleration{};  ///< z̈ [m/s²]
};

/// The factors of ExactDiscretisation::hermite for an input that moves from sample to sample.
template <class From, class To>
[[nodiscard]] constexpr auto driven_by(const From& from, const To& to) {
  return std::array{from.position, from.velocity, to.position, to.velocity};
}

/// Cubic Hermite polynomial between two samples a period h apart, s = 0 at `from`, s = 1 at `to`:
///
///   x(s) = (1 + 2s)(1 − s)² x₀ + s(1 − s)² h ẋ₀ + s²(3 − 2s) x₁ − s²(1 − s) h ẋ₁
///
/// It keeps position and velocity of both ends; its error is h⁴/384 · max|x⁗|.
template <class S>
[[nodiscard]] constexpr Stroke<S> hermite(const Stroke<S>& from, const Stroke<S>& to, S s, S h) {
  const S r = S(1) - s;
  const S slope = (to.position - from.position) / h;
  return {(S(1) + S(2) * s) * r * r * from.position + s * r * r * h * from.velocity +
              s * s * (S(3) - S(2) * s) * to.position - s * s * r * h * to.velocity,
          S(6) * s * r * slope + r * (S(1) - S(3) * s) * from.velocity + s * (S(3) * s - S(2)) * to.velocity};
}

}  // namespace model
