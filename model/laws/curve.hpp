// A monotone cubic through points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "model/laws/law_tables.hpp"
#include "model/numerics/inline.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// Cubics between points, straight on beyond the first and the last.
///
///   (1)  s_i = (y_{i+1} − y_i)/(x_{i+1} − x_i)
///   (2)  d_i = 0 where s_{i−1} s_i ≤ 0, else (w₁ + w₂)/(w₁/s_{i−1} + w₂/s_i),   w₁ = 2h_i + h_{i−1}, w₂ = h_i +
///   2h_{i−1} (3)  d_0 = s_0, d_n = s_{n−1} (4)  f = y_i + t (d_i + t (3 s_i − 2 d_i − d_{i+1} + t (d_i + d_{i+1} − 2
///   s_i)/h)/h)        t = x − x_i
///
/// The slopes (2) lie within the region |d| ≤ 3|s| of Fritsch and Carlson (Monotone piecewise cubic interpolation, SIAM
/// J. Numer. Anal. 1980), so f is monotone where the points are, and has no extremum between points. (2): Fritsch and
/// Butland, SIAM J. Sci. Stat. Comput. 1984. One point has an error ∝ h² beside a kink of the measured law, ∝ h³ else.
/// Two points are a straight line.
///
/// The interval is the number of points at or below x, counted in two rounds (8 comparisons with every fourth point,
/// then 4), without a branch: the same work for every x. From one step to the next x mostly stays in its interval, so
/// evaluations in a step look there first, at the price of two comparisons. In lanes every rig has points of its own;
/// there a step keeps the cubic of each lane, and looks for others only where some lane has left its interval.
template <class S, std::size_t capacity = curve_points>
class Curve {
  struct Piece {
    S from{}, value{}, slope{}, square{}, cube{};
  };
  struct Found {
    Piece piece{};
    S lower{}, upper{};  ///< the interval
  };

 public:
  /// Where x was last: the number of the interval; in lanes the cubic of each.
  using Place = std::conditional_t<lane_count<S> == 1, std::uint8_t, Found>;

  Curve() = default;

  /// `count` points, 2 … capacity; x ascending.
  template <class X, class Y>
  constexpr Curve(const X& x, const Y& y, std::size_t count) {
    knots_.fill(largest_number<S>());
    pieces_.fill(Piece{});
    const auto secant = [&](std::size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
    std::array<S, capacity> slope{};
    slope[0] = secant(0);
    slope[count - 1] = secant(count - 2);
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const S left = secant(i - 1), right = secant(i);
      const S before = x[i] - x[i - 1], after = x[i + 1] - x[i];
      const S w1 = S(2) * after + before, w2 = after + S(2) * before;
      slope[i] = select(left * right > S(0), S((w1 + w2) / (w1 / left + w2 / right)), S(0));
    }
    for (std::size_t i = 0; i < count; ++i) knots_[i] = x[i];
    pieces_[0] = {x[0], y[0], slope[0], S(0), S(0)};
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const S h = x[i + 1] - x[i], s = secant(i);
      pieces_[i + 1] = {x[i], y[i], slope[i], (S(3) * s - S(2) * slope[i] - slope[i + 1]) / h,
                        (slope[i] + slope[i + 1] - S(2) * s) / (h * h)};
      const S size = absolute(s);
      steepest_ = select(size > steepest_ / S(3), S(S(3) * size), steepest_);
    }
    pieces_[count] = {x[count - 1], y[count - 1], slope[count - 1], S(0), S(0)};
    first_ = x[0];
    last_ = x[count - 1];
  }

  [[nodiscard]] RIGTWIN_INLINE S operator()(S x) const { return value(piece(x), x); }
  /// The same. `place`: where x is probably; becomes where it is.
  [[nodiscard]] RIGTWIN_INLINE S near(S x, Place& place) const {
    if constexpr (lane_count<S> == 1) {
      const bool below = place > 0 && !(x >= knots_[place - 1U]);
      if (below || !(x < knots_[place])) place = static_cast<std::uint8_t>(interval(x));
      return value(pieces_[place], x);
    } else {
      if (!all_lanes(x >= place.lower && x < place.upper)) place = found(x);
      return value(place.piece, x);
    }
  }
  /// Lanes: f of another curve in each lane, curve_of(lane); all have the points x of this one.
  template <class CurveOf>
  [[nodiscard]] S of_each(S x, const CurveOf& curve_of) const {
    return value(pieces_of_each(interval(x), curve_of), x);
  }
  /// The x with f(x) + κ x = y, κ > 0, of a curve that nowhere falls. The interval is counted; in it Newton's method
  /// begins on the straight line between the ends and never leaves it. The work is the same for every y.
  [[nodiscard]] S where(S y, S kappa) const {
    S n = S(0);
    for (std::size_t i = 0; i < 4 * fours; ++i) {
      n += select(y >= pieces_[i + 1].value + kappa * knots_[i], S(1), S(0));
    }
    const auto length_of = [](std::size_t i, double from, double to) {  // outside of the table, where it is straight: 0
      return i > 0 && to < std::numeric_limits<double>::max() ? to - from : 0.0;
    };
    Piece p;
    S length;
    if constexpr (lane_count<S> == 1) {
      const auto i = static_cast<std::size_t>(n);
      p = pieces_[i];
      length = length_of(i, p.from, knots_[i]);
    } else {
      p = pieces_of_each(n, [this](std::size_t) -> const Curve& { return *this; });
      length = S::each([&](std::size_t lane) {
        const auto i = static_cast<std::size_t>(n[lane]);
        return length_of(i, p.from[lane], knots_[i][lane]);
      });
    }
    const S rest = y - p.value - kappa * p.from;
    const auto inside = length > S(0);
    S t = rest / (kappa + p.slope + length * (p.square + length * p.cube));
    constexpr int rounds = 4;  // leave 1e-8 of the force of a bent interval
    for (int i = 0; i < rounds; ++i) {
      const S value = t * (kappa + p.slope + t * (p.square + t * p.cube));
      t += (rest - value) / (kappa + p.slope + t * (S(2) * p.square + t * S(3) * p.cube));
      t = select(inside && t < S(0), S(0), select(inside && t > length, length, t));
    }
    return p.from + t;
  }
  /// df/dx
  [[nodiscard]] S slope(S x) const {
    const Piece p = piece(x);
    const S t = x - p.from;
    return p.slope + t * (S(2) * p.square + t * S(3) * p.cube);
  }
  /// At least the largest |slope|.
  [[nodiscard]] S steepest() const { return steepest_; }
  [[nodiscard]] S first() const { return first_; }  ///< the x of the first point
  [[nodiscard]] S last() const { return last_; }

 private:
  static constexpr std::size_t fours = (capacity + 3) / 4;

  [[nodiscard]] RIGTWIN_INLINE static S value(const Piece& p, S x) {
    const S t = x - p.from;
    return (p.value + t * p.slope) + t * t * (p.square + t * p.cube);
  }
  /// The number of points ≤ x; in lanes as numbers.
  [[nodiscard]] RIGTWIN_INLINE auto interval(S x) const {
    if constexpr (lane_count<S> == 1) {
      std::size_t n = 0;
      for (std::size_t i = 1; i < fours; ++i) n += static_cast<std::size_t>(x >= knots_[4 * i - 1]);
      n *= 4;
      const S* const block = &knots_[n];
      n += static_cast<std::size_t>(x >= block[0]) + static_cast<std::size_t>(x >= block[1]) +
           static_cast<std::size_t>(x >= block[2]) + static_cast<std::size_t>(x >= block[3]);
      return n;
    } else {
      S n = S(0);
      for (std::size_t i = 0; i < 4 * fours; ++i) n += select(x >= knots_[i], S(1), S(0));
      return n;
    }
  }
  [[nodiscard]] RIGTWIN_INLINE decltype(auto) piece(S x) const {
    if constexpr (lane_count<S> == 1) {
      return (pieces_[interval(x)]);
    } else {
      return pieces_of_each(interval(x), [this](std::size_t) -> const Curve& { return *this; });
    }
  }
  template <class CurveOf>
  [[nodiscard]] static Piece pieces_of_each(const S& intervals, const CurveOf& curve_of) {
    const auto of_lane = [&](std::size_t lane) -> const Piece& {
      return curve_of(lane).pieces_[static_cast<std::size_t>(intervals[lane])];
    };
    return {S::each([&](std::size_t lane) { return of_lane(lane).from[lane]; }),
            S::each([&](std::size_t lane) { return of_lane(lane).value[lane]; }),
            S::each([&](std::size_t lane) { return of_lane(lane).slope[lane]; }),
            S::each([&](std::size_t lane) { return of_lane(lane).square[lane]; }),
            S::each([&](std::size_t lane) { return of_lane(lane).cube[lane]; })};
  }
  [[nodiscard]] RIGTWIN_NOINLINE Found found(S x) const {
    const S n = interval(x);
    const auto knot = [&](std::size_t lane, std::size_t i) { return knots_[i][lane]; };
    return {piece(x), S::each([&](std::size_t lane) {
              const auto i = static_cast<std::size_t>(n[lane]);
              return i == 0 ? -std::numeric_limits<double>::max() : knot(lane, i - 1);
            }),
            S::each([&](std::size_t lane) { return knot(lane, static_cast<std::size_t>(n[lane])); })};
  }

  std::array<S, 4 * fours + 1> knots_{};  ///< the last one ends the interval of an infinite x
  std::array<Piece, 4 * fours + 1> pieces_{};
  S first_{}, last_{}, steepest_{};
};

}  // namespace model
