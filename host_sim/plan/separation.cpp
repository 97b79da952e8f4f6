#include "host_sim/plan/separation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace host_sim::plan {
namespace {

bool either_sign(const Subject& subject) {
  return std::all_of(subject.entry->parameters.begin(), subject.entry->parameters.end(),
                     [](const model::EffectParameter& p) { return p.lower < 0.0; });
}

}  // namespace

double left_of(const Rehearsal& rehearsal, const Change& a, const std::vector<Direction>& rival) {
  const double whole = rehearsal.product(a, a);
  double least = whole;
  for (const Direction& b : rival) {
    const double along = rehearsal.product(a, b.change), square = rehearsal.product(b.change, b.change);
    if (!(square > 0.0) || (along <= 0.0 && !b.of_either_sign)) continue;
    least = std::min(least, whole - along * along / square);
  }
  return std::sqrt(std::max(0.0, least));
}

std::optional<Change> strong_change(const Rehearsal& rehearsal, const Rival& rival) {
  if (!rival.strong) return std::nullopt;
  if (!rival.absent) return rehearsal.change(*rival.strong);
  const auto absent = rehearsal.residuals_with(*rival.absent);
  return absent ? rehearsal.change(*rival.strong, &*absent) : std::nullopt;
}

std::vector<Direction> directions_of(const Rehearsal& rehearsal, const Rival& rival) {
  std::vector<Direction> directions;
  const bool signs = either_sign(rival.subject);
  std::optional<Eigen::VectorXf> absent;
  if (rival.absent) absent = rehearsal.residuals_with(*rival.absent);
  const auto add = [&](const firmware::PlacedEffect& effect) {
    if (auto change = rehearsal.change(effect, absent ? &*absent : nullptr)) {
      directions.push_back({std::move(*change), signs});
    }
  };
  if (rival.strong) add(*rival.strong);
  add(rival.subject.placed());
  if (rival.subject.values.size() > 1) {
    for (const auto& values : rival.subject.starts) add({rival.subject.entry, rival.subject.channel, values});
  }
  return directions;
}

}  // namespace host_sim::plan
