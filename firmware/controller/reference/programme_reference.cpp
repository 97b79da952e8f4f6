#include "firmware/controller/reference/programme_reference.hpp"

#include <algorithm>

#include "firmware/controller/reference/cycle_reference.hpp"
#include "model/numerics/require.hpp"

namespace firmware::controller {

Motion ProgrammeReference::Part::at(std::uint64_t i) const {
  if (road.empty()) return {stands_at, 0.0, 0.0};
  const Motion& r = road[static_cast<std::size_t>(i)];
  if (level == 1.0) return r;
  const double begin_position = road.front().position;
  return {begin_position + level * (r.position - begin_position), level * r.velocity, level * r.acceleration};
}

ProgrammeReference::ProgrammeReference(std::span<const Block> blocks, double period, std::uint64_t most_repetitions)
    : period_(period) {
  model::require(!blocks.empty(), "a programme has a block");
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    model::require(!block.road.empty(), "a block has a road");
    const std::uint64_t length = block.road.size();
    for (std::uint64_t cycle = 1; cycle <= std::min(block.repetitions, most_repetitions); ++cycle) {
      append({.road = block.road, .level = block.level, .length = length, .place = {b + 1, cycle}}, period);
    }
    if (block.pause == 0) continue;
    const Part& last = parts_.back();
    const std::uint64_t in = joint_samples(length, period);
    const std::uint64_t out = b + 1 < blocks.size() ? joint_samples(blocks[b + 1].road.size(), period) : 0;
    append({.road = {},
            .level = 0.0,
            .stands_at = last.at(length - 1).position,
            .length = in + block.pause + out,
            .place = last.place},
           period);
  }
}

void ProgrammeReference::append(Part part, double period) {
  if (!parts_.empty()) {
    const Part& before = parts_.back();
    const auto joint_of = [period](const Part& p) {
      return p.road.empty() ? UINT64_MAX : joint_samples(p.road.size(), period);
    };
    part.joint = std::min(joint_of(before), joint_of(part));
    part.begin = before.begin + before.length - part.joint;
  }
  parts_.push_back(part);
}

std::size_t ProgrammeReference::part_of(std::uint64_t sample) const {
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), sample,
                                      [](std::uint64_t wanted, const Part& part) { return wanted < part.begin; });
  return static_cast<std::size_t>(after - parts_.begin()) - 1;
}

ProgrammeReference::Place ProgrammeReference::place(std::uint64_t sample) const {
  return parts_[part_of(sample)].place;
}

std::optional<Motion> ProgrammeReference::do_at(std::uint64_t sample) {
  // In order: the part of the sample before, or the next one.
  const bool here = newest_ < parts_.size() && parts_[newest_].begin <= sample &&
                    (newest_ + 1 == parts_.size() || sample < parts_[newest_ + 1].begin);
  if (!here) newest_ = part_of(sample);
  const Part& part = parts_[newest_];
  const std::uint64_t i = sample - part.begin;
  if (i >= part.length) return std::nullopt;
  if (i >= part.joint) return part.at(i);
  const Part& before = parts_[newest_ - 1];
  return joint(before.at(before.length - part.joint + i), part.at(i), i, part.joint, period_);
}

}  // namespace firmware::controller
