// The valves of the ducts.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/result.hpp"

namespace hal {

/// Which of up to six ducts are open.
class Openings {
 public:
  static constexpr std::size_t capacity = 6;

  constexpr Openings() = default;  ///< none open

  /// The first `count` ducts open, the others closed.
  [[nodiscard]] static constexpr Openings first(std::size_t count) {
    require(count <= capacity, "a valve bank has at most six ducts");
    return Openings((1U << count) - 1U);
  }

  /// Bit i is duct i.
  [[nodiscard]] static constexpr Openings from_bits(unsigned bits) {
    require(bits < (1U << capacity), "a valve bank has at most six ducts");
    return Openings(bits);
  }

  [[nodiscard]] constexpr Openings with(std::size_t duct, bool open) const {
    require(duct < capacity, "a valve bank has at most six ducts");
    return Openings(open ? bits_ | (1U << duct) : bits_ & ~(1U << duct));
  }

  [[nodiscard]] constexpr bool is_open(std::size_t duct) const {
    return duct < capacity && ((bits_ >> duct) & 1U) != 0;
  }
  [[nodiscard]] constexpr unsigned bits() const { return bits_; }

  /// True when every open duct is among the first `installed` ones.
  [[nodiscard]] constexpr bool within(std::size_t installed) const { return (bits_ >> installed) == 0; }

  friend constexpr bool operator==(Openings, Openings) = default;

 private:
  constexpr explicit Openings(unsigned bits) : bits_(static_cast<std::uint8_t>(bits)) {}

  std::uint8_t bits_ = 0;
};

/// The valves of up to six ducts, each open or closed, all written in one call.
///
/// The safe position is part of the construction: what the valves fall to without power or heartbeat, so that program
/// and hardware agree about it. A back-end takes its lines over with the safe position on them and gives them back so.
/// timeout, disconnected, refused: the valves may stand anywhere; make the rig safe and write again.
class ValveBank {
 public:
  /// 0 ≤ installed ≤ 6; the safe position opens installed ducts only.
  ValveBank(std::size_t installed, Openings safe_position) : installed_(installed), safe_position_(safe_position) {
    require(installed <= Openings::capacity, "a valve bank has at most six ducts");
    require(safe_position.within(installed), "the safe position opens installed ducts only");
  }
  virtual ~ValveBank() = default;

  /// Every valve to its place. A duct that is not installed cannot be opened: refused, and no valve is touched.
  [[nodiscard]] Result<void> write(Openings openings) {
    if (!openings.within(installed_)) return Fault::refused;
    return do_write(openings);
  }

  [[nodiscard]] std::size_t installed() const { return installed_; }
  [[nodiscard]] Openings safe_position() const { return safe_position_; }

 private:
  virtual Result<void> do_write(Openings openings) = 0;

  std::size_t installed_;
  Openings safe_position_;
};

}  // namespace hal
