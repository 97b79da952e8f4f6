// A signal some time ago.
#pragma once

#include <array>
#include <cstddef>

#include "model/numerics/motion.hpp"
#include "model/numerics/require.hpp"

namespace model {

/// A delay as a number of samples, whole part and fraction in 0 … 1.
template <class S>
struct SampleDelay {
  std::size_t whole{};
  S fraction{};
};

/// A delay [samples] that is a whole number but for the rounding of delay / period is that whole number.
template <class S>
[[nodiscard]] constexpr SampleDelay<S> split(S delay) {
  const S rounding = S(1e-9);
  const auto whole = static_cast<std::size_t>(delay + rounding);
  const S fraction = delay - S(whole);
  return {whole, fraction < rounding ? S(0) : fraction};
}

/// Ring buffer that gives the value a signal had a whole or fractional number of samples ago.
///
///   (1)  y(k) = u(k − d)                               d whole: exact
///   (2)  y(k) = Σ_i u(k − n + 1 − i) L_i(r), i = 0…3    d = n + r: cubic Lagrange through the four nearest samples
///
/// (2) is exact for cubic signals; its error is at most 3/128 h⁴ max|u⁗| inside the line and 1/24 h⁴ max|u⁗| for
/// d < 1, where no newer neighbour exists yet and the four newest samples are used. A Stroke is interpolated by its
/// own velocities instead (cubic Hermite, h⁴/384 max|u⁗|), which no kink outside the interval can disturb.
///
/// The delay may be changed while running: it slides to the new value by at most `slide` samples a sample, so the
/// time that is read never jumps and never runs backwards (slide < 1).
///
/// The hold of a sampled loop is not included. A loop that reads once a period h and holds the value until the next
/// reading adds h/2 on average: a ring of n samples in such a loop acts like a continuous delay of n h + h/2
/// (tests/model: with 1 ms steps the linear component at b̃ = 0, critical delay 15.25 ms, is stable with 14 samples and
/// unstable with 15).
///
/// Capacity: a power of two; delays up to Capacity − 4 samples. A longer one is a broken assumption here:
/// find_fault() refuses rigs with such a delay.
template <class Value, std::size_t Capacity, class S = double>
class DelayLine {
 public:
  static_assert(Capacity >= 8 && (Capacity & (Capacity - 1)) == 0, "the ring is indexed by masking");
  static constexpr std::size_t longest = Capacity - 4;  ///< [samples]: the older neighbours must be in the ring
  static constexpr double slide = 0.125;                ///< [samples a sample] while the delay is changing

  /// As if `value` had always been there; `delay` in samples, in force at once.
  void start(const Value& value, S delay) {
    ring_.fill(value);
    set(delay);
    delay_ = target_;
    sliding_ = false;
    split();
  }

  /// From now on slide to `delay` samples.
  void set(S delay) {
    require(delay >= S(0) && delay <= S(longest), "delay within the capacity of the line");
    target_ = delay;
    sliding_ = delay_ != target_;
  }

  /// From now on `delay` samples, at once: the time that is read may jump.
  void jump(S delay) {
    require(delay >= S(0) && delay <= S(longest), "delay within the capacity of the line");
    target_ = delay_ = delay;
    sliding_ = false;
    split();
  }

  /// Takes the value of this instant; then read() is the value one delay before it. `h`: sample period [s].
  void push(const Value& newest) {
    newest_ = (newest_ + 1) & mask;
    ring_[newest_] = newest;
    if (sliding_) move();
  }

  [[nodiscard]] Value read(S h) const {
    if (!between_samples_) return ago(at_.whole);
    return between(h, static_cast<const Value*>(nullptr));
  }

  /// The sample pushed `samples` pushes ago; 0 is the newest.
  [[nodiscard]] const Value& ago(std::size_t samples) const { return ring_[(newest_ - samples) & mask]; }
  [[nodiscard]] Value& ago(std::size_t samples) { return ring_[(newest_ - samples) & mask]; }

  [[nodiscard]] S delay() const { return delay_; }

 private:
  static constexpr std::size_t mask = Capacity - 1;

  void move() {
    const S left = target_ - delay_;
    if (left > S(slide)) {
      delay_ += S(slide);
    } else if (left < S(-slide)) {
      delay_ -= S(slide);
    } else {
      delay_ = target_;
      sliding_ = false;
    }
    split();
  }

  void split() {
    at_ = model::split(delay_);
    between_samples_ = at_.fraction != S(0);
  }

  template <class V>
  [[nodiscard]] V between(S /*h*/, const V* /*scalar*/) const {
    const std::size_t first = at_.whole == 0 ? 0 : at_.whole - 1;
    const S r = at_.whole == 0 ? at_.fraction - S(1) : at_.fraction;  // nodes at −1, 0, 1, 2
    const S a = r + S(1), c = r - S(1), d = r - S(2);
    return (-r * c * d / S(6)) * ago(first) + (a * c * d / S(2)) * ago(first + 1) +
           (-a * r * d / S(2)) * ago(first + 2) + (a * r * c / S(6)) * ago(first + 3);
  }

  [[nodiscard]] Stroke<S> between(S h, const Stroke<S>* /*stroke*/) const {
    return hermite(ago(at_.whole + 1), ago(at_.whole), S(1) - at_.fraction, h);
  }

  std::array<Value, Capacity> ring_{};
  std::size_t newest_ = 0;
  SampleDelay<S> at_{};
  S delay_{};
  S target_{};
  bool sliding_ = false;          ///< delay_ is on its way to target_
  bool between_samples_ = false;  ///< the delay is not a whole number
};

}  // namespace model
