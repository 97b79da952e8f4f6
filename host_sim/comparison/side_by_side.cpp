#include "host_sim/comparison/side_by_side.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "host_sim/comparison/lane_simulation.hpp"

namespace host_sim {
namespace {

using model::Channel;

/// Fewer rigs are simulated one after the other: a step of four or eight side by side takes the time of 2 to 3 steps
/// of one (tests/bench). With half of it, 2, nothing would be gained; with twice, 6, groups of 3 to 5 would lose a
/// third.
constexpr std::size_t fewest_side_by_side = 3;

std::uint64_t active_effects(const model::RigParameters<double>& rig) {
  std::uint64_t bits = 0;
  unsigned bit = 0;
  rig.effects.for_each([&](const auto& slot) { bits |= (slot.active ? std::uint64_t{1} : 0U) << bit++; });
  return bits;
}

void keep_numbers(const model::RigParameters<double>& rig, std::vector<double>& numbers) {
  const auto keep = [&numbers](double number) { numbers.push_back(number); };
  model::for_each_number(rig, keep);
  model::for_each_law_number(rig.laws, keep);
}

std::size_t every(const SideBySideRig& rig) { return rig.variation == nullptr ? 0 : rig.variation->every; }

/// The rig that moves first.
model::RigParameters<double> at_first(const SideBySideRig& rig) {
  return answering(every(rig) > 0 ? rig.variation->at(0) : *rig.rig, *rig.input);
}

LaneLaws laws_of(const model::Laws<double>& laws) {
  return {laws.curves.data(), laws.surfaces.data(), laws.branches.data(),
          laws.curve_count,   laws.surface_count,   laws.branch_count};
}

/// True if two rigs have the same laws, with the same or other numbers.
bool are_alike(const model::Laws<double>& a, const model::Laws<double>& b) {
  if (a.curve_count != b.curve_count || a.surface_count != b.surface_count || a.branch_count != b.branch_count) {
    return false;
  }
  return std::equal(a.curves.begin(), a.curves.begin() + a.curve_count, b.curves.begin(),
                    [](const auto& x, const auto& y) {
                      return x.place == y.place && x.over == y.over && x.channel == y.channel && x.count == y.count &&
                             (x.behind > 0.0) == (y.behind > 0.0);
                    }) &&
         std::equal(a.surfaces.begin(), a.surfaces.begin() + a.surface_count, b.surfaces.begin(),
                    [](const auto& x, const auto& y) {
                      return x.place == y.place && x.rows == y.rows && x.columns == y.columns;
                    }) &&
         std::equal(a.branches.begin(), a.branches.begin() + a.branch_count, b.branches.begin(),
                    [](const auto& x, const auto& y) {
                      return x.place == y.place && (x.time_constant > 0.0) == (y.time_constant > 0.0);
                    });
}

std::size_t width(LaneUse use) {
  switch (use) {
    case LaneUse::one:
      return 1;
    case LaneUse::four:
      return 4;
    case LaneUse::eight:
      return 8;
    case LaneUse::automatic:
      break;
  }
  if (has_lanes(LaneUse::eight)) return 8;
  return has_lanes(LaneUse::four) ? 4 : 1;
}

/// One pass of the lanes over the rigs `chosen`, as many as there are lanes at most.
void simulate_group(const std::vector<SideBySideRig>& rigs, const std::vector<std::size_t>& chosen, std::size_t lanes,
                    std::size_t samples, int substeps, const std::vector<Channel>& channels,
                    std::vector<Response>& responses) {
  const SideBySideRig& first = rigs[chosen.front()];
  const SimulationInput& input = *first.input;
  std::array<std::vector<double>, 8> numbers;
  std::array<const double*, 8> number_of{}, start_of{};
  std::array<const model::Motion<double>*, 8> motion_of{};
  std::vector<double*> out;
  bool one_motion = true;
  std::size_t number_count = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const bool repeats = lane >= chosen.size();
    const SideBySideRig& rig = rigs[repeats ? chosen.back() : chosen[lane]];
    keep_numbers(*rig.rig, numbers[lane]);
    number_count = numbers[lane].size();
    for (std::size_t k = every(rig); k > 0 && k < samples; k += every(rig)) {
      keep_numbers(answering(rig.variation->at(k), *rig.input), numbers[lane]);
    }
    number_of[lane] = numbers[lane].data();
    start_of[lane] = rig.start->data();
    motion_of[lane] = rig.input->motion.data();
    one_motion = one_motion && rig.input == first.input;
    for (const Channel channel : channels) {
      out.push_back(repeats ? nullptr : responses[chosen[lane]][index(channel)].data());
    }
  }
  const LaneSimulation simulation{
      .kind = first.rig->kind,
      .has_fdva = first.rig->has_fdva,
      .ducts = first.rig->fdva.ducts,
      .open_ducts = first.rig->fdva.open_ducts,
      .active = active_effects(*first.rig),
      .period = input.period,
      .substeps = substeps,
      .samples = samples,
      .every = every(first),
      .number_count = number_count,
      .laws = laws_of(first.rig->laws),
      .numbers = number_of.data(),
      .start = start_of.data(),
      .motion = motion_of.data(),
      .one_motion = one_motion,
      .actuator_force = input.actuator_force.empty() ? nullptr : input.actuator_force.data(),
      .opened = input.ducts.empty() ? nullptr : input.ducts.data(),
      .channel_count = channels.size(),
      .channels = channels.data(),
      .out = out.data()};
#if RIGTWIN_LANES >= 8
  if (lanes == 8) return simulate_eight(simulation);
#endif
#if RIGTWIN_LANES >= 4
  simulate_four(simulation);
#else
  static_cast<void>(simulation);
#endif
}

}  // namespace

bool has_lanes(LaneUse use) {
#if RIGTWIN_LANES >= 8
  if (use == LaneUse::eight) return __builtin_cpu_supports("avx512f") != 0;
#endif
#if RIGTWIN_LANES >= 4
  if (use == LaneUse::four) return __builtin_cpu_supports("avx2") != 0;
#endif
  return use == LaneUse::one || use == LaneUse::automatic;
}

bool alike(const model::RigParameters<double>& a, const model::RigParameters<double>& b) {
  if (a.has_extensions() || b.has_extensions()) return false;
  if (!are_alike(a.laws, b.laws)) return false;
  if (a.kind != b.kind || a.has_fdva != b.has_fdva || active_effects(a) != active_effects(b)) return false;
  if (a.has_fdva && (a.fdva.ducts != b.fdva.ducts || a.fdva.open_ducts != b.fdva.open_ducts)) return false;
  std::vector<bool> of_a, of_b;  // a part is there when its number is above 0
  model::for_each_number(a, [&](double number) { of_a.push_back(number > 0.0); });
  model::for_each_number(b, [&](double number) { of_b.push_back(number > 0.0); });
  return of_a == of_b;
}

std::vector<Response> simulate_side_by_side(const std::vector<SideBySideRig>& rigs, std::size_t samples, int substeps,
                                            const std::vector<Channel>& channels, LaneUse use) {
  std::vector<Response> responses(rigs.size());
  const std::size_t lanes = width(use);
  std::vector<model::RigParameters<double>> simulated;
  std::vector<SideBySideRig> all = rigs;
  for (const SideBySideRig& rig : rigs) {
    simulated.push_back(at_first(rig));
  }
  for (std::size_t i = 0; i < all.size(); ++i) all[i].rig = &simulated[i];

  const RigVariation none;
  std::vector<bool> done(rigs.size(), false);
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    if (done[i]) continue;
    std::vector<std::size_t> group{i};
    for (std::size_t j = i + 1; j < rigs.size() && group.size() < lanes; ++j) {
      if (!done[j] && every(rigs[i]) == every(rigs[j]) && alike(simulated[i], simulated[j])) group.push_back(j);
    }
    for (const std::size_t j : group) done[j] = true;
    const std::size_t length = rigs[i].input->size();
    const std::size_t count = samples == 0 ? length : std::min(samples, length);
    if (lanes == 1 || count == 0 || group.size() < fewest_side_by_side) {
      for (const std::size_t j : group) {
        const RigVariation& variation = rigs[j].variation == nullptr ? none : *rigs[j].variation;
        responses[j] = simulate(*rigs[j].rig, *rigs[j].input, *rigs[j].start, samples, substeps, channels, variation);
      }
      continue;
    }
    for (const std::size_t j : group) {
      for (const Channel channel : channels) responses[j][index(channel)].resize(count);
    }
    simulate_group(all, group, lanes, count, substeps, channels, responses);
    for (const std::size_t j : group) {
      add_load_cell(*rigs[j].rig, *rigs[j].input, rigs[j].variation == nullptr ? none : *rigs[j].variation,
                    responses[j]);
    }
  }
  return responses;
}

}  // namespace host_sim
