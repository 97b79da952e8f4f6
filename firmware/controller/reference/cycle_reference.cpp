#include "firmware/controller/reference/cycle_reference.hpp"

#include <algorithm>

namespace firmware::controller {

std::uint64_t joint_samples(std::uint64_t n, double period) {
  constexpr double joint_time = 2.0;  // [s]
  return std::min(static_cast<std::uint64_t>(joint_time / period), n / 4);
}

Motion joint(const Motion& a, const Motion& b, std::uint64_t i, std::uint64_t samples, double period) {
  const double length = static_cast<double>(samples);
  const double s = static_cast<double>(i) / length, rate = 1.0 / (length * period);
  const double w = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double w1 = 30.0 * s * s * (1.0 + s * (s - 2.0)) * rate;
  const double w2 = 60.0 * s * (1.0 + s * (2.0 * s - 3.0)) * rate * rate;
  const double apart = b.position - a.position, apart1 = b.velocity - a.velocity;
  Motion between;
  between.position = a.position + w * apart;
  between.velocity = a.velocity + w * apart1 + w1 * apart;
  between.acceleration = a.acceleration + w * (b.acceleration - a.acceleration) + 2.0 * w1 * apart1 + w2 * apart;
  return between;
}

CycleReference::CycleReference(std::span<const Motion> table, std::uint64_t cycles, double period)
    : table_(table),
      cycles_(cycles),
      period_(period),
      blend_(joint_samples(table.size(), period)),
      cycle_(std::max<std::uint64_t>(table.size() - blend_, 1)) {}

std::optional<Motion> CycleReference::do_at(std::uint64_t sample) {
  if (table_.empty()) return std::nullopt;
  std::uint64_t cycle = sample / cycle_;
  std::uint64_t i = sample - cycle * cycle_;
  if (cycles_ > 0 && cycle >= cycles_) {  // the end of the last cycle
    i += (cycle - cycles_ + 1) * cycle_;
    cycle = cycles_ - 1;
    if (i >= table_.size()) return std::nullopt;
  }
  const Motion& b = table_[static_cast<std::size_t>(i)];
  if (cycle == 0 || i >= blend_) return b;
  return joint(table_[static_cast<std::size_t>(cycle_ + i)], b, i, blend_, period_);
}

}  // namespace firmware::controller
