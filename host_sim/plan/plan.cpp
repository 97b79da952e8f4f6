#include "host_sim/plan/plan.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {

using model::Channel;

namespace {

/// Shares of the progress line: sizes, separations, advice.
constexpr double after_sizes = 0.3, after_separations = 0.7;

/// A subject while its sizes are found.
struct Sized {
  std::vector<PlannedEffect> rows;       ///< one for each of its parameters that has a size
  std::optional<std::size_t> leading{};  ///< of `rows`
  double growth = 1.0;                   ///< what stands for the road that was cut: √(whole ÷ rehearsed)
  std::shared_ptr<SizeSearch> search{};  ///< of the leading parameter
  Rival rival;
};

std::string shows_too_little(const SizeSearch& search, const Subject& subject, std::size_t parameter) {
  char text[160];
  std::snprintf(text, sizeof text, "does not show: %.2g standard deviations at most, with %s = %.4g %s",
                search.strongest().significance, std::string(subject.entry->parameters[parameter].name).c_str(),
                search.strongest().value, unit_of(subject, parameter).c_str());
  return text;
}

/// Of a law without parameters that changes nothing here: how far the wheel load falls, and how far it would have to.
std::string not_reached(const Rehearsal& rehearsal, const Subject& subject) {
  const auto responses = read_all(rehearsal.problem(), rehearsal.given());
  const auto& load = responses.front()[index(Channel::F_w)];
  if (subject.entry->tyre_force == nullptr || load.empty()) return "not reached by this excitation";
  const auto& rig = rehearsal.given().rig;
  const double gravity = 9.80665, still = gravity * (rig.body.mass + rig.wheel.mass);
  char text[128];
  std::snprintf(text, sizeof text, "not reached: the wheel load falls by %.3g N, needs %.3g N",
                -*std::min_element(load.begin(), load.end()), still);
  return text;
}

/// Of a held channel: it shows by repetition, from two samples on.
void add_seen(const Rehearsal& rehearsal, const Subject& subject, Sized& sized) {
  const auto change = rehearsal.change(subject.placed());
  const double significance = change ? rehearsal.significance(*change) : 0.0;
  PlannedEffect row{subject, 0, {subject.values.front(), significance}, subject.values.front()};
  row.named_at = row.shows_at;
  sized.rows.push_back(std::move(row));
}

Sized sized_subject(const Rehearsal& rehearsal, const Subject& subject, double growth) {
  Sized sized;
  sized.growth = growth;
  sized.rival.subject = subject;
  if (subject.seen_by_itself) {
    add_seen(rehearsal, subject, sized);
    return sized;
  }
  if (subject.values.empty()) {  // a law without parameters: there or not
    PlannedEffect row{subject, 0, {0.0, 0.0}, std::nullopt};
    if (const auto change = rehearsal.change(subject.placed())) {
      row.at_default.significance = growth * rehearsal.significance(*change);
    }
    if (row.at_default.significance < thresholds::shows) {
      row.why = not_reached(rehearsal, subject);
    } else {
      sized.rival.strong = subject.placed();
      sized.leading = 0;
    }
    sized.rows.push_back(std::move(row));
    add_directions(rehearsal, sized.rival);
    return sized;
  }
  for (std::size_t p = 0; p < subject.values.size(); ++p) {
    const auto own = std::make_shared<SizeSearch>(rehearsal, subject, p);
    SizeSearch& search = *own;
    // The highest peak of the whole comes once, and in the rehearsed stretch: what only it reaches grows no more.
    if (p == 0 && search.falls()) sized.growth = growth = 1.0;
    PlannedEffect row{subject, p, search.at_default(), std::nullopt};
    row.at_default.significance *= growth;
    if (const auto size = search.with(thresholds::shows / growth)) {
      row.shows_at = size->value;
    } else if (search.strongest().significance * growth >= thresholds::shows) {
      row.why = "shows at every value that was tried: there is no smallest one";
    } else {
      row.why = shows_too_little(search, subject, p);
    }
    // A value that is read off, a period, is no size.
    if (row.shows_at && !sized.leading && subject.entry->parameters[p].kept_within == 0.0) {
      sized.leading = sized.rows.size();
      sized.search = own;
      sized.rival.strong = subject.placed();
      const auto strong = search.with(thresholds::told_apart / growth);
      sized.rival.strong->values[p] = strong ? strong->value : search.strongest().value;
      sized.rival.absent = search.absent();
    }
    sized.rows.push_back(std::move(row));
  }
  add_directions(rehearsal, sized.rival);
  return sized;
}

/// A parameter of the rig in the place of an effect.
struct ParameterRival {
  std::string path;
  std::vector<Direction> directions;
};

std::vector<ParameterRival> parameter_rivals(const Rehearsal& rehearsal) {
  const auto& suspects = rehearsal.space().suspects;
  const Eigen::MatrixXd j = rehearsal.jacobian(suspects);
  std::vector<ParameterRival> rivals;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    rivals.push_back({suspects[i].path, {}});
    Change change = rehearsal.as_change(j.col(static_cast<Eigen::Index>(i)));
    const double square = rehearsal.product(change, change);
    rivals.back().directions.push_back({std::move(change), true, square});
  }
  return rivals;
}

/// Whether an effect may be taken for the other: not for one that contains it and pays for more parameters, nor for one
/// that is only tried where all others leave a rest (EffectCard::imitates).
bool is_taken_for(const firmware::CatalogueEntry& effect, const firmware::CatalogueEntry& other) {
  return other.contains != effect.name && (effect.imitates || !other.imitates);
}

/// One entry of the matrix: a rival, and what is left of the effect with it.
struct Separation {
  std::string name;
  double left;
  const Rival* effect = nullptr;  ///< of the catalogue, if it is a rival
  bool is_rival = true;
};

/// One row of the matrix, for a change that an effect makes. The parameters of its nearest rivals are fitted.
std::vector<Separation> separations_of(const Rehearsal& rehearsal, const Sized& own, const Change& change,
                                       const std::vector<Sized>& all, const std::vector<ParameterRival>& parameters) {
  const double whole = rehearsal.product(change, change);
  const auto left_beside = [&](const std::vector<Direction>& rival) {
    return own.growth * left_of(rehearsal, change, whole, rival);
  };
  std::vector<Separation> columns;
  for (const Sized& other : all) {
    if (other.rival.directions.empty()) continue;
    const bool self = &other == &own;
    columns.push_back({words(other.rival.subject), self ? 0.0 : left_beside(other.rival.directions), &other.rival,
                       !self && is_taken_for(*own.rival.subject.entry, *other.rival.subject.entry)});
  }
  for (const ParameterRival& parameter : parameters) {
    columns.push_back({parameter.path, left_beside(parameter.directions)});
  }
  std::vector<Separation*> nearest;
  for (Separation& column : columns) {
    if (column.is_rival && column.effect != nullptr) nearest.push_back(&column);
  }
  std::stable_sort(nearest.begin(), nearest.end(),
                   [](const Separation* a, const Separation* b) { return a->left < b->left; });
  nearest.resize(std::min(nearest.size(), thresholds::refitted));
  for (Separation* column : nearest) {
    column->left = std::min(column->left, own.growth * left_when_refitted(rehearsal, change, *column->effect));
  }
  return columns;
}

/// The rivals, nearest first.
std::vector<TakenFor> taken_for(const std::vector<Separation>& columns) {
  std::vector<TakenFor> taken;
  for (const Separation& column : columns) {
    if (column.is_rival) taken.push_back({column.name, column.left});
  }
  std::stable_sort(taken.begin(), taken.end(), [](const TakenFor& a, const TakenFor& b) { return a.left < b.left; });
  taken.resize(std::min(taken.size(), thresholds::most_rivals));
  return taken;
}

/// Of sizes that grow from the given one by thresholds::promise_step each, the next one after the first that leaves a
/// rest.
std::optional<double> with_a_rest(const Rehearsal& rehearsal, const Sized& own, const std::vector<Sized>& all,
                                  Size size, SizeSearch& search) {
  const PlannedEffect& row = own.rows[*own.leading];
  std::vector<const Rival*> others;
  for (const Sized& other : all) {
    if (&other != &own && !other.rival.subject.entry->imitates) others.push_back(&other.rival);
  }
  for (int step = 0; step < thresholds::promise_steps; ++step) {
    firmware::PlacedEffect effect = row.subject.placed();
    effect.values[row.parameter] = size.value;
    const auto change = search.change(size.value);
    const bool may_leave =
        change &&
        own.growth * left_of_several(rehearsal, *change, others, thresholds::subtracted_rivals) >= thresholds::shows;
    const bool rest = may_leave && rehearsal.leaves_a_rest(effect);
    const auto larger = search.with(size.significance * thresholds::promise_step);
    if (!larger) return std::nullopt;
    size = *larger;
    if (rest) return size.value;
  }
  return std::nullopt;
}

/// Rigs that the description may stand for.
using Others = std::vector<std::unique_ptr<const Rehearsal>>;

/// The size that is at least as significant in the other rigs, of an effect that grows as its value falls.
std::optional<double> reached_by(const Others& others, const PlannedEffect& row, const Size& size) {
  double value = size.value;
  for (const auto& other : others) {
    SizeSearch search(*other, row.subject, row.parameter);
    const auto there = search.with(size.significance);
    if (!there) return std::nullopt;
    value = std::min(value, there->value);
  }
  return value;
}

/// The size at which the leading parameter of an effect leaves ten standard deviations beside its nearest rival. As a
/// rival bends to a larger effect, the size is tried, not extrapolated.
std::optional<double> named_at(const Rehearsal& rehearsal, const Others& others, const Sized& own,
                               const std::vector<Sized>& all, const std::vector<ParameterRival>& parameters) {
  const PlannedEffect& row = own.rows[*own.leading];
  if (!row.shows_at || row.taken_for.empty() || !own.search) return std::nullopt;
  SizeSearch& search = *own.search;
  double whole = own.growth * rehearsal.significance(own.rival.directions.front().change),
         left = row.taken_for.front().left;
  for (int trial = 0; trial < thresholds::promise_trials; ++trial) {
    if (left < thresholds::same * whole) return std::nullopt;
    const auto size = search.with(whole * thresholds::told_apart / left / own.growth);
    const auto change = size ? search.change(size->value) : std::nullopt;
    if (!change) return std::nullopt;
    whole = own.growth * size->significance;
    const auto beside = taken_for(separations_of(rehearsal, own, *change, all, parameters));
    left = beside.front().left;
    if (left < thresholds::told_apart * (1.0 - 2.0 * thresholds::size_error)) continue;
    if (row.subject.entry->imitates) return with_a_rest(rehearsal, own, all, *size, search);
    return search.falls() ? reached_by(others, row, *size) : size->value;
  }
  return std::nullopt;
}

/// Matrix of separations: for each visible effect, the effects that it would be taken for, and from which size it would
/// be named.
SeparationMatrix separate(const Rehearsal& rehearsal, const Others& others, std::vector<Sized>& all,
                          const std::function<void()>& one_done) {
  const std::vector<ParameterRival> parameters = parameter_rivals(rehearsal);
  SeparationMatrix matrix;
  std::vector<std::size_t> of_row;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].rival.directions.empty()) continue;
    matrix.columns.push_back(words(all[i].rival.subject));
    if (all[i].leading && all[i].rival.strong) of_row.push_back(i);
  }
  for (const ParameterRival& parameter : parameters) matrix.columns.push_back(parameter.path);
  matrix.left.resize(of_row.size() * matrix.columns.size());
  for (const std::size_t i : of_row) matrix.rows.push_back(words(all[i].rival.subject));
  identification::for_all(of_row.size(), [&](std::size_t row) {
    Sized& own = all[of_row[row]];
    PlannedEffect& effect = own.rows[*own.leading];
    const auto columns = separations_of(rehearsal, own, own.rival.directions.front().change, all, parameters);
    for (std::size_t c = 0; c < columns.size(); ++c) matrix.left[row * matrix.columns.size() + c] = columns[c].left;
    effect.taken_for = taken_for(columns);
    effect.named_at = named_at(rehearsal, others, own, all, parameters);
    one_done();
  });
  return matrix;
}

void check_channels(const firmware::RigDescription& description, const Setting& setting) {
  const bool car = description.rig.kind == model::RigKind::quarter_car;
  for (const Channel channel : setting.without) {
    const bool of_car = channel != Channel::x_cmd && channel != Channel::x_act && channel != Channel::F;
    const bool of_bench = !of_car;
    const bool hil = description.rig.kind == model::RigKind::hil && channel != Channel::z_cmd;
    const bool driven = description.rig.kind == model::RigKind::driven_mass;
    const bool of_mass = channel == Channel::x_act || channel == Channel::zdd_b;
    const bool known = hil || (driven ? of_mass : car ? of_car : of_bench);
    if (known) continue;
    throw firmware::UsageError("--without: a " + std::string(model::name(description.rig.kind)) + " has no channel " +
                               std::string(model::name(channel)));
  }
}

/// Effects that show soonest, in terms of where a fit would start, first; those that do not show last.
void sort(std::vector<PlannedEffect>& effects) {
  const auto rank = [](const PlannedEffect& e) { return e.why.empty() ? e.at_default.significance : -1.0; };
  std::stable_sort(effects.begin(), effects.end(),
                   [&](const PlannedEffect& a, const PlannedEffect& b) { return rank(a) > rank(b); });
}

}  // namespace

std::string words(const Subject& subject) { return identification::words(subject.placed()); }

std::string unit_of(const Subject& subject, std::size_t parameter) {
  const std::string_view unit = subject.entry->parameters[parameter].unit;
  if (unit == "of the channel" && subject.channel) return std::string(model::unit(*subject.channel));
  return unit == "1" ? std::string() : std::string(unit);
}

Plan make_plan(const firmware::RigDescription& description, Setting setting, const PlanProgress& progress) {
  check_channels(description, setting);
  std::mutex telling;
  const auto tell = [&](double share, const char* what) {
    const std::lock_guard lock(telling);
    if (progress) progress(share, what);
  };
  Plan plan;
  plan.duration = static_cast<double>(setting.motion.size()) / description.sample_rate;
  double growth = 1.0;
  if (const std::optional<Stretch> stretch = stretch_of(description, setting)) {
    growth = stretch->growth;
    setting.motion = stretch->setting.motion;
    char remark[192];
    std::snprintf(remark, sizeof remark,
                  "of %.0f s of a random road the %.0f s from %.0f s on are rehearsed, with its highest peaks; "
                  "significances grow with the duration, %.2f times",
                  plan.duration, thresholds::stretch, stretch->from, growth);
    plan.remarks.emplace_back(remark);
  } else if (plan.duration > thresholds::longest) {
    growth = std::sqrt(plan.duration / thresholds::longest);
    setting.motion.resize(static_cast<std::size_t>(thresholds::longest * description.sample_rate));
    char remark[128];
    std::snprintf(remark, sizeof remark, "of %.0f s the first %.0f s are rehearsed; significances grow with √duration",
                  plan.duration, thresholds::longest);
    plan.remarks.emplace_back(remark);
  }
  tell(0.0, "rehearsal");
  const Rehearsal rehearsal(description, setting);
  plan.channels = rehearsal.problem().channels();
  for (const std::string& remark : rehearsal.remarks()) plan.remarks.push_back(remark);

  const std::vector<Subject> list = subjects(rehearsal);
  std::vector<Sized> sized(list.size());
  std::atomic<std::size_t> done{0};
  identification::for_all(list.size(), [&](std::size_t i) {
    sized[i] = sized_subject(rehearsal, list[i], growth);
    tell(after_sizes * static_cast<double>(++done) / static_cast<double>(list.size()), "sizes of effects");
  });
  done = 0;
  plan.separations = separate(rehearsal, within_tolerances(description, setting), sized, [&] {
    const double share = static_cast<double>(++done) / static_cast<double>(list.size());
    tell(after_sizes + (after_separations - after_sizes) * share, "separations");
  });
  tell(after_separations, "parameters");
  Information information = information_of(rehearsal);
  information.matrix *= growth * growth;
  plan.parameters = planned_parameters(rehearsal, description, information);
  plan.open = open_combinations(information);

  std::vector<Rival> rivals;
  for (Sized& one : sized) {
    for (PlannedEffect& row : one.rows) plan.effects.push_back(std::move(row));
    one.rival.directions.clear();
    one.rival.without.reset();
    rivals.push_back(std::move(one.rival));
  }
  sort(plan.effects);
  AdviceResult advice = advice_for(description, setting, rivals, plan.open, [&](double share) {
    tell(after_separations + (1.0 - after_separations) * share, "other experiments");
  });
  plan.advice = std::move(advice.advice);
  plan.remarks.insert(plan.remarks.end(), advice.remarks.begin(), advice.remarks.end());
  return plan;
}

}  // namespace host_sim::plan
