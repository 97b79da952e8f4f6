// Several numbers side by side in one vector register.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "model/numerics/inline.hpp"
#include "model/numerics/motion.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// The registers of the compiler's vector extension.
template <std::size_t N>
struct LaneRegister;
template <>
struct LaneRegister<4> {
  using Numbers [[gnu::vector_size(32)]] = double;
  using Bits [[gnu::vector_size(32)]] = long long;
};
template <>
struct LaneRegister<8> {
  using Numbers [[gnu::vector_size(64)]] = double;
  using Bits [[gnu::vector_size(64)]] = long long;
};

/// In which lanes a comparison holds. There is no way back to a bool but any_lane(), all_lanes() and same(): a `?:` or
/// an `if` on values that differ from lane to lane does not compile.
template <std::size_t N>
class LaneMask {
 public:
  using Bits = typename LaneRegister<N>::Bits;  ///< −1 where it holds, else 0

  RIGTWIN_INLINE explicit LaneMask(Bits bits) : bits_(bits) {}
  [[nodiscard]] RIGTWIN_INLINE const Bits& bits() const { return bits_; }
  [[nodiscard]] RIGTWIN_INLINE bool operator[](std::size_t lane) const { return bits_[lane] != 0; }

  [[nodiscard]] RIGTWIN_INLINE friend LaneMask operator&&(const LaneMask& a, const LaneMask& b) {
    return LaneMask(a.bits_ & b.bits_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend LaneMask operator||(const LaneMask& a, const LaneMask& b) {
    return LaneMask(a.bits_ | b.bits_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend LaneMask operator!(const LaneMask& a) { return LaneMask(~a.bits_); }

  [[nodiscard]] RIGTWIN_INLINE friend bool any_lane(const LaneMask& a) {
#if defined(__AVX512F__)
    if constexpr (N == 8) return _mm512_test_epi64_mask(__m512i(a.bits_), __m512i(a.bits_)) != 0;
#endif
#if defined(__AVX2__)
    if constexpr (N == 4) return _mm256_testz_si256(__m256i(a.bits_), __m256i(a.bits_)) == 0;
#endif
    long long bits = 0;
    for (std::size_t i = 0; i < N; ++i) bits |= a.bits_[i];
    return bits != 0;
  }
  [[nodiscard]] RIGTWIN_INLINE friend bool all_lanes(const LaneMask& a) { return !any_lane(!a); }
  [[nodiscard]] RIGTWIN_INLINE friend bool same(const LaneMask& a) { return a[0]; }

 private:
  Bits bits_;
};

/// N numbers with the arithmetic of one: each lane gets exactly the bits that it would get alone. A product and a sum
/// are never one instruction (-ffp-contract=off).
///
/// One rig a lane, for simulations of several rigs with the same effects and other values. A source that uses Lanes is
/// compiled for the processors that have such registers and nowhere else: side_by_side.hpp in host_sim/comparison.
template <std::size_t N>
class Lanes {
 public:
  using Numbers = typename LaneRegister<N>::Numbers;
  using Bits = typename LaneRegister<N>::Bits;
  using Mask = LaneMask<N>;

  RIGTWIN_INLINE Lanes() : numbers_{} {}
  RIGTWIN_INLINE explicit Lanes(Numbers numbers) : numbers_(numbers) {}
  template <class Number>
  requires std::is_arithmetic_v<Number> RIGTWIN_INLINE explicit Lanes(Number number)
      : numbers_(static_cast<double>(number) - Numbers{}) {}  // − 0 changes no number, + 0 would change −0

  /// number_of(lane) in each lane.
  template <class NumberOf>
  [[nodiscard]] RIGTWIN_INLINE static Lanes each(const NumberOf& number_of) {
    return each(number_of, std::make_index_sequence<N>{});
  }

  [[nodiscard]] RIGTWIN_INLINE const Numbers& numbers() const { return numbers_; }
  [[nodiscard]] RIGTWIN_INLINE double operator[](std::size_t lane) const { return numbers_[lane]; }

  [[nodiscard]] RIGTWIN_INLINE friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return Lanes(a.numbers_ + b.numbers_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return Lanes(a.numbers_ - b.numbers_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return Lanes(a.numbers_ * b.numbers_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return Lanes(a.numbers_ / b.numbers_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Lanes operator-(const Lanes& a) { return Lanes(-a.numbers_); }
  RIGTWIN_INLINE Lanes& operator+=(const Lanes& a) { return *this = *this + a; }
  RIGTWIN_INLINE Lanes& operator-=(const Lanes& a) { return *this = *this - a; }
  RIGTWIN_INLINE Lanes& operator*=(const Lanes& a) { return *this = *this * a; }
  RIGTWIN_INLINE Lanes& operator/=(const Lanes& a) { return *this = *this / a; }

  [[nodiscard]] RIGTWIN_INLINE friend Mask operator<(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ < b.numbers_));
  }
  [[nodiscard]] RIGTWIN_INLINE friend Mask operator>(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ > b.numbers_));
  }
  [[nodiscard]] RIGTWIN_INLINE friend Mask operator<=(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ <= b.numbers_));
  }
  [[nodiscard]] RIGTWIN_INLINE friend Mask operator>=(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ >= b.numbers_));
  }
  [[nodiscard]] RIGTWIN_INLINE friend Mask operator==(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ == b.numbers_));
  }
  [[nodiscard]] RIGTWIN_INLINE friend Mask operator!=(const Lanes& a, const Lanes& b) {
    return Mask(Bits(a.numbers_ != b.numbers_));
  }

  [[nodiscard]] RIGTWIN_INLINE friend Lanes select(const Mask& condition, const Lanes& a, const Lanes& b) {
    return Lanes(condition.bits() ? a.numbers_ : b.numbers_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Lanes absolute(const Lanes& a) {
    constexpr long long all_but_sign = 0x7fff'ffff'ffff'ffff;
    return Lanes(reinterpret_cast<Numbers>(reinterpret_cast<Bits>(a.numbers_) & (Bits{} + all_but_sign)));
  }

 private:
  template <class NumberOf, std::size_t... I>
  [[nodiscard]] RIGTWIN_INLINE static Lanes each(const NumberOf& number_of, std::index_sequence<I...>) {
    return Lanes(Numbers{number_of(I)...});
  }

  Numbers numbers_;
};

/// Turns N samples of N lanes, `rows`, into N lanes of N samples.
template <std::size_t N>
RIGTWIN_INLINE void transpose(std::array<Lanes<N>, N>& rows) {
  using Numbers = typename Lanes<N>::Numbers;
  std::array<Numbers, N> r, t;
  for (std::size_t i = 0; i < N; ++i) r[i] = rows[i].numbers();
  if constexpr (N == 4) {
    for (std::size_t i = 0; i < 4; i += 2) {
      t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 4, 2, 6);
      t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 5, 3, 7);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      rows[i] = Lanes<N>(__builtin_shufflevector(t[i], t[i + 2], 0, 1, 4, 5));
      rows[i + 2] = Lanes<N>(__builtin_shufflevector(t[i], t[i + 2], 2, 3, 6, 7));
    }
  } else {
    for (std::size_t i = 0; i < 8; i += 2) {  // single numbers
      t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
      t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (std::size_t half = 0; half < 8; half += 4) {  // pairs: lanes 0 and 4, 1 and 5, 2 and 6, 3 and 7
      for (std::size_t i = half; i < half + 2; ++i) {
        r[i] = __builtin_shufflevector(t[i], t[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        r[i + 2] = __builtin_shufflevector(t[i], t[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {  // fours
      rows[i] = Lanes<N>(__builtin_shufflevector(r[i], r[i + 4], 0, 1, 2, 3, 8, 9, 10, 11));
      rows[i + 4] = Lanes<N>(__builtin_shufflevector(r[i], r[i + 4], 4, 5, 6, 7, 12, 13, 14, 15));
    }
  }
}

template <std::size_t N>
[[nodiscard]] RIGTWIN_INLINE Stroke<Lanes<N>> select(const LaneMask<N>& condition, const Stroke<Lanes<N>>& a,
                                                     const Stroke<Lanes<N>>& b) {
  return {select(condition, a.position, b.position), select(condition, a.velocity, b.velocity)};
}

template <std::size_t N>
inline constexpr std::size_t lane_count<Lanes<N>> = N;

}  // namespace model

namespace Eigen {
template <std::size_t N>
struct NumTraits<model::Lanes<N>> : GenericNumTraits<model::Lanes<N>> {
  using Real = model::Lanes<N>;
  using NonInteger = model::Lanes<N>;
  using Nested = model::Lanes<N>;
  using Literal = model::Lanes<N>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
}  // namespace Eigen
