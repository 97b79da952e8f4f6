#include "hal/linux/rf60x_parser.hpp"

namespace hal::linux {

std::optional<Rf60xParser::Frame> Rf60xParser::take(std::uint8_t byte, Time time) {
  if (size_ > 0 && time - last_ > longest_pause_) {
    ++counts_.torn;
    size_ = 0;
    flags_ = no_count;  // what follows may be the rest, or a beginning: CNT will tell
    skipping_ = true;
  }
  last_ = time;
  if ((byte & 0x80U) == 0) {
    ++counts_.garbage;
    if (size_ > 0) ++counts_.torn;
    size_ = 0;
    skipping_ = true;
    return std::nullopt;
  }

  const int flags = (byte >> 4U) & 0x7;  // SB and CNT
  const bool next_frame = flags_ != no_count && (flags & 3) != (flags_ & 3);
  if (next_frame) {
    if (size_ > 0) ++counts_.torn;
    size_ = 0;
    skipping_ = false;
  } else if (!skipping_ && (size_ == 0 || flags != flags_)) {  // a fifth byte, or SB that changes within a frame
    ++counts_.torn;
    size_ = 0;
    skipping_ = true;
  }
  flags_ = flags;
  if (skipping_) return std::nullopt;

  if (size_ == 0) begun_ = time;
  bytes_[size_++] = byte;
  if (size_ < bytes_.size()) return std::nullopt;
  size_ = 0;
  unsigned value = 0;
  for (std::size_t i = 0; i < bytes_.size(); ++i) value |= (bytes_[i] & 0xfU) << (4U * i);
  if (value > full_scale) {
    ++counts_.out_of_range;
    return std::nullopt;
  }
  if (frame_count_ != no_count) counts_.lost += static_cast<std::uint64_t>(((flags & 3) - frame_count_ + 3) & 3);
  frame_count_ = flags & 3;
  ++counts_.frames;
  const bool renewed = (flags & 4) != 0;
  if (!renewed) ++counts_.not_renewed;
  return Frame{static_cast<std::uint16_t>(value), renewed, begun_};
}

}  // namespace hal::linux
