// Arithmetic on two numbers at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "model/numerics/inline.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// Two numbers side by side, with the arithmetic of one: each half gets exactly the bits it would get alone. For double
/// it is the register of the narrowest vector unit (SSE2, NEON); machines without one compute the halves in turn.
template <class S>
class Pair {
 public:
  Pair() = default;
  RIGTWIN_INLINE Pair(S first, S second) : halves_{first, second} {}
  [[nodiscard]] RIGTWIN_INLINE static Pair both(S value) { return {value, value}; }

  [[nodiscard]] RIGTWIN_INLINE S operator[](std::size_t i) const { return halves_[i]; }

  [[nodiscard]] RIGTWIN_INLINE friend Pair operator+(const Pair& a, const Pair& b) {
    return {a[0] + b[0], a[1] + b[1]};
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair operator-(const Pair& a, const Pair& b) {
    return {a[0] - b[0], a[1] - b[1]};
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair operator*(const Pair& a, const Pair& b) {
    return {a[0] * b[0], a[1] * b[1]};
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair abs(const Pair& a) { return {absolute(a[0]), absolute(a[1])}; }

 private:
  std::array<S, 2> halves_;
};

#if defined(__GNUC__)
template <>
class Pair<double> {
 public:
  Pair() = default;
  RIGTWIN_INLINE Pair(double first, double second) : halves_{first, second} {}
  [[nodiscard]] RIGTWIN_INLINE static Pair both(double value) { return {value, value}; }

  [[nodiscard]] RIGTWIN_INLINE double operator[](std::size_t i) const { return halves_[i]; }

  [[nodiscard]] RIGTWIN_INLINE friend Pair operator+(const Pair& a, const Pair& b) {
    return Pair(a.halves_ + b.halves_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair operator-(const Pair& a, const Pair& b) {
    return Pair(a.halves_ - b.halves_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair operator*(const Pair& a, const Pair& b) {
    return Pair(a.halves_ * b.halves_);
  }
  [[nodiscard]] RIGTWIN_INLINE friend Pair abs(const Pair& a) {
    constexpr std::int64_t all_but_sign = 0x7fff'ffff'ffff'ffff;
    return Pair(reinterpret_cast<Halves>(reinterpret_cast<Bits>(a.halves_) & Bits{all_but_sign, all_but_sign}));
  }

 private:
  using Halves [[gnu::vector_size(16)]] = double;
  using Bits [[gnu::vector_size(16)]] = std::int64_t;
  RIGTWIN_INLINE explicit Pair(Halves halves) : halves_(halves) {}

  Halves halves_;
};
#endif

/// A column of N numbers, N even, as pairs.
template <class S, int N>
class Packed {
 public:
  static_assert(N % 2 == 0, "pairs");
  static constexpr std::size_t pairs = N / 2;

  Packed() = default;
  template <class Column>
  RIGTWIN_INLINE explicit Packed(const Column& column) {
    for (std::size_t i = 0; i < pairs; ++i) {
      const auto row = static_cast<int>(2 * i);
      pair_[i] = {column(row), column(row + 1)};
    }
  }

  [[nodiscard]] RIGTWIN_INLINE S operator[](std::size_t i) const { return pair_[i / 2][i % 2]; }

  RIGTWIN_INLINE void add(const Packed& column, S factor) {
    add(column, Pair<S>::both(factor), std::make_index_sequence<pairs>{});
  }
  template <class Column>
  RIGTWIN_INLINE void store(Column&& column) const {
    for (std::size_t i = 0; i < N; ++i) column(static_cast<int>(i)) = (*this)[i];
  }

  [[nodiscard]] RIGTWIN_INLINE friend Packed operator+(const Packed& a, const Packed& b) {
    return sum(a, b, std::make_index_sequence<pairs>{});
  }
  [[nodiscard]] RIGTWIN_INLINE friend Packed operator*(const Packed& column, S factor) {
    return scaled(column, Pair<S>::both(factor), std::make_index_sequence<pairs>{});
  }

 private:
  template <std::size_t... I>
  RIGTWIN_INLINE void add(const Packed& column, const Pair<S>& factor, std::index_sequence<I...>) {
    ((pair_[I] = pair_[I] + column.pair_[I] * factor), ...);
  }
  template <std::size_t... I>
  RIGTWIN_INLINE static Packed sum(const Packed& a, const Packed& b, std::index_sequence<I...>) {
    Packed result;
    ((result.pair_[I] = a.pair_[I] + b.pair_[I]), ...);
    return result;
  }
  template <std::size_t... I>
  RIGTWIN_INLINE static Packed scaled(const Packed& column, const Pair<S>& factor, std::index_sequence<I...>) {
    Packed result;
    ((result.pair_[I] = column.pair_[I] * factor), ...);
    return result;
  }

  std::array<Pair<S>, pairs> pair_;
};

/// K columns, each multiplied by one factor and summed in their order: the product of a matrix with a column, with the
/// same bits whatever the vector width.
template <class S, int N, int K>
class PackedColumns {
 public:
  using Factors = std::array<S, static_cast<std::size_t>(K)>;

  PackedColumns() = default;
  template <class Matrix>
  PackedColumns(const Matrix& matrix) {  // NOLINT(google-explicit-constructor): the same matrix, packed
    for (int k = 0; k < K; ++k) column_[static_cast<std::size_t>(k)] = Packed<S, N>(matrix.col(k));
  }

  [[nodiscard]] RIGTWIN_INLINE Packed<S, N> times(const Factors& factors) const {
    Packed<S, N> sum = column_[0] * factors[0];
    add<1>(sum, factors, std::make_index_sequence<static_cast<std::size_t>(K) - 1>{});
    return sum;
  }
  RIGTWIN_INLINE void add_to(Packed<S, N>& sum, const Factors& factors) const {
    add<0>(sum, factors, std::make_index_sequence<static_cast<std::size_t>(K)>{});
  }

 private:
  template <std::size_t First, std::size_t... I>
  RIGTWIN_INLINE void add(Packed<S, N>& sum, const Factors& factors, std::index_sequence<I...>) const {
    (sum.add(column_[First + I], factors[First + I]), ...);
  }

  std::array<Packed<S, N>, static_cast<std::size_t>(K)> column_;
};

}  // namespace model
