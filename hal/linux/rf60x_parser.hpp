// The stream of a RIFTEK RF60x laser triangulation sensor, byte by byte.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/time.hpp"

namespace hal::linux {

/// Frames of the binary protocol. A result D, 16 bit, comes as four bytes, lowest four bits first:
///
///   bit 7 = 1   bit 6 = SB: the sensor has renewed D   bits 5:4 = CNT: number of the frame, modulo 4   bits 3:0 of D
///   (1)  distance = D S / 4000h,   S measuring range, D = 0 … 4000h
///
/// The protocol has no check sum: what can be checked is bit 7, the same SB and CNT in all four bytes, CNT one further
/// than in the frame before, D at most 4000h, and that no gap in time tears a frame. Whatever fails is counted and
/// dropped; a frame begins where CNT changes. Static, no heap, a few comparisons a byte. Source: RIFTEK RF603/RF605
/// user's manuals, sections on the serial protocol.
class Rf60xParser {
 public:
  static constexpr std::uint16_t full_scale = 0x4000;

  struct Counts {
    std::uint64_t frames = 0;        ///< whole ones
    std::uint64_t not_renewed = 0;   ///< of them those that say an old result again (SB = 0)
    std::uint64_t garbage = 0;       ///< bytes without bit 7
    std::uint64_t torn = 0;          ///< frames of fewer or more than four bytes, or of unequal flags
    std::uint64_t lost = 0;          ///< frames missing by the count of CNT, modulo 4
    std::uint64_t out_of_range = 0;  ///< D beyond 4000h
  };

  /// \param longest_pause between two bytes of one frame
  explicit Rf60xParser(Time longest_pause = milliseconds(3)) : longest_pause_(longest_pause) {}

  struct Frame {
    std::uint16_t counts = 0;  ///< D
    bool renewed = false;      ///< SB
    Time begun{};              ///< when its first byte was taken
  };

  /// The frame that this byte, received at `time`, completes.
  [[nodiscard]] std::optional<Frame> take(std::uint8_t byte, Time time);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  static constexpr int no_count = -1;

  Time longest_pause_;
  std::array<std::uint8_t, 4> bytes_{};
  std::size_t size_ = 0;        ///< bytes of the frame being read
  bool skipping_ = true;        ///< until CNT changes: nobody knows where in a frame this is
  int flags_ = no_count;        ///< SB and CNT of the byte before
  int frame_count_ = no_count;  ///< CNT of the last whole frame
  Time begun_{};
  Time last_{};
  Counts counts_{};
};

}  // namespace hal::linux
