// Contacts that must be closed while the drive has power.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/result.hpp"

namespace hal {

/// Door, pressure, temperature: up to 32 normally closed contacts. What each one is called belongs to the
/// configuration.
///
/// A contact that opened between two reads counts as open once. Any fault: the lines cannot be read; the caller takes
/// all of them for open.
class Interlocks {
 public:
  static constexpr std::size_t capacity = 32;

  explicit Interlocks(std::size_t count) : count_(count) {
    require(count <= capacity, "a rig has at most 32 interlocks");
  }
  virtual ~Interlocks() = default;

  /// Bit i: interlock i is open, or was since the last read.
  [[nodiscard]] Result<std::uint32_t> open() { return do_read(); }

  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  virtual Result<std::uint32_t> do_read() = 0;

  std::size_t count_;
};

/// For a rig without interlocks.
class NoInterlocks final : public Interlocks {
 public:
  NoInterlocks() : Interlocks(0) {}

 private:
  Result<std::uint32_t> do_read() override { return std::uint32_t{0}; }
};

}  // namespace hal
