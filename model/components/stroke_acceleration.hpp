// The acceleration of a stroke that is known by position and velocity.
#pragma once

#include "model/numerics/motion.hpp"

namespace model {

/// Acceleration at the end of each step of a stroke x that is given at the samples by position and velocity.
///
///   (1)  c_k = (2 ẋ_{k−1} + 4 ẋ_k)/h − 6 (x_k − x_{k−1})/h²         end of the cubic through both samples
///   (2)  a_k = c_k + (c_k − 2 c_{k−1} + c_{k−2})/12
///
/// (1) falls short of ẍ by h² x⁗/12 − h³ x⁽⁵⁾/30; (2) adds h² x⁗/12 of one sample before. What is left is h³ x⁽⁵⁾/20,
/// at 25 Hz and 1 kHz 2e-4 of ẍ. It lets the acceleration jump from sample to sample, as it does behind a held force,
/// with a gain of at most 4/3. The first step takes c_{k−1} = c_{k−2} = c_k.
template <class S>
class StrokeAcceleration {
 public:
  void step(const Stroke<S>& before, const Stroke<S>& now, S period) {
    const S cubic = (S(2) * before.velocity + S(4) * now.velocity) / period -
                    S(6) * (now.position - before.position) / (period * period);
    if (!begun_) last_ = earlier_ = cubic;
    begun_ = true;
    value_ = cubic + (cubic - S(2) * last_ + earlier_) / S(12);
    earlier_ = last_;
    last_ = cubic;
  }

  [[nodiscard]] S value() const { return value_; }  ///< of the newest step [m/s²]; 0 before the first

 private:
  S value_{}, last_{}, earlier_{};
  bool begun_ = false;
};

}  // namespace model
