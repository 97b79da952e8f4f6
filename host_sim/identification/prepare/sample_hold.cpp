#include "host_sim/identification/prepare/sample_hold.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host_sim/identification/common/golden_section.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// The mean time between renewals, without those that are two turns or more: of gaps of 2 and 3 samples neither is the
/// period.
double mean_single_gap(const Renewals& r) {
  std::vector<std::size_t> gaps;
  for (std::size_t i = 1; i < r.at.size(); ++i) {
    if (r.seen[i] && r.seen[i - 1]) gaps.push_back(r.at[i] - r.at[i - 1]);
  }
  if (gaps.empty()) return 0.0;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  const std::size_t longest_single = gaps[gaps.size() / 2] * 3 / 2;
  double sum = 0.0, count = 0.0;
  for (const std::size_t gap : gaps) {
    if (gap > longest_single) continue;
    sum += static_cast<double>(gap);
    count += 1.0;
  }
  return sum / count;
}

/// Numbers the renewals that were seen, and finds the period that these numbers give: two rounds agree.
void count_turns(Renewals& r) {
  const auto first = static_cast<std::size_t>(std::find(r.seen.begin(), r.seen.end(), true) - r.seen.begin());
  for (int round = 0; round < 2; ++round) {
    r.turn.assign(r.at.size(), 0.0);
    std::size_t last = first;
    for (std::size_t i = first + 1; i < r.at.size(); ++i) {
      if (!r.seen[i]) continue;
      r.turn[i] = r.turn[last] + std::max(1.0, std::round(static_cast<double>(r.at[i] - r.at[last]) / r.period));
      last = i;
    }
    r.period = static_cast<double>(r.at[last] - r.at[first]) / r.turn[last];
  }
}

/// Of a renewal that was not seen only so much is known: its turn is the last before it shows.
void count_unseen_turns(Renewals& r) {
  for (std::size_t i = 0; i < r.at.size(); ++i) {
    if (!r.seen[i]) r.turn[i] = std::floor((static_cast<double>(r.at[i]) - r.first) / r.period);
  }
}

/// Turns over which the renewals that were seen extend.
double span(const Renewals& r) { return *std::max_element(r.turn.begin(), r.turn.end()); }

/// The range of t_0 that (1) leaves at a period; its width is concave in the period, negative: none.
struct StartRange {
  double lowest = -INFINITY, highest = INFINITY;
  [[nodiscard]] double width() const { return highest - lowest; }
};
StartRange start_range(const Renewals& r, double period) {
  StartRange range;
  for (std::size_t i = 0; i < r.at.size(); ++i) {
    if (!r.seen[i]) continue;
    const double start = static_cast<double>(r.at[i]) - r.turn[i] * period;
    range.lowest = std::max(range.lowest, start - 1.0);
    range.highest = std::min(range.highest, start);
  }
  return range;
}

/// The middle of the periods for which (1) can be met, and half their range.
void find_period(Renewals& r) {
  const auto width = [&r](double period) { return start_range(r, period).width(); };
  constexpr int rounds = 60;  // of halving: to the last bit
  const double reach = 1.5 / span(r);
  const double widest =
      golden_section([&](double period) { return -width(period); }, r.period - reach, r.period + reach, rounds).at;
  r.regular = width(widest) > 0.0;
  if (!r.regular) {
    r.period_slack = 1.0 / span(r);
    return;
  }
  const auto border = [&](double outside) {
    double inside = widest;
    for (int i = 0; i < rounds; ++i) {
      const double middle = 0.5 * (inside + outside);
      (width(middle) > 0.0 ? inside : outside) = middle;
    }
    return inside;
  };
  const double low = border(widest - 2.0 * reach), high = border(widest + 2.0 * reach);
  r.period = 0.5 * (low + high);
  r.period_slack = 0.5 * (high - low);
}

/// The median size of a change.
double change_of_value(const std::vector<double>& samples, const Renewals& r) {
  std::vector<double> changes;
  for (std::size_t i = 0; i < r.at.size(); ++i) {
    if (r.seen[i]) changes.push_back(std::abs(samples[r.at[i]] - samples[r.at[i] - 1]));
  }
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  return *middle;
}

/// The value of every turn from the first to the last: one that brought the same value again was not seen.
std::vector<double> values_by_turn(const std::vector<double>& held, const Renewals& r) {
  std::vector<double> values(static_cast<std::size_t>(span(r) - r.turn.front()) + 1);
  std::size_t next = 0;
  for (std::size_t n = 0; n < r.at.size(); ++n) {
    const auto turn = static_cast<std::size_t>(std::max(r.turn[n] - r.turn.front(), 0.0));
    for (; next < turn; ++next) values[next] = values[next - 1];
    values[turn] = held[r.at[n]];
    next = turn + 1;
  }
  return values;
}

constexpr std::size_t nodes = 16;

/// (−1)ⁱ times the binomial coefficients: barycentric weights of equidistant nodes.
constexpr std::array<double, nodes> node_weights() {
  std::array<double, nodes> weights{1.0};
  for (std::size_t i = 1; i < nodes; ++i) {
    weights[i] = -weights[i - 1] * static_cast<double>(nodes - i) / static_cast<double>(i);
  }
  return weights;
}

/// The polynomial through the values around `place`; at least `nodes` of them.
double on_polynomial(const std::vector<double>& values, double place) {
  constexpr std::array<double, nodes> weights = node_weights();
  const auto nearest = static_cast<std::size_t>(std::lround(place));
  if (place == static_cast<double>(nearest)) return values[nearest];
  const auto below = static_cast<std::size_t>(place);
  const std::size_t first = std::min(below - std::min(below, nodes / 2 - 1), values.size() - nodes);
  double sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < nodes; ++i) {
    const double weight = weights[i] / (place - static_cast<double>(first + i));
    sum += weight * values[first + i];
    all += weight;
  }
  return sum / all;
}

}  // namespace

double taken_at(const Renewals& r, std::size_t n, const HoldClock& clock) {
  if (!clock.own || !r.regular) return static_cast<double>(r.at[n]);
  const double from_middle = r.turn[n] - 0.5 * (r.turn.front() + r.turn.back());
  return r.first + clock.phase * r.slack + r.turn[n] * r.period + clock.stretch * r.period_slack * from_middle;
}

std::vector<double> before_hold(const std::vector<double>& held, const Renewals& r, const HoldClock& clock) {
  if (!r.regular || span(r) - r.turn.front() < static_cast<double>(nodes)) return held;
  const std::vector<double> taken = values_by_turn(held, r);
  const HoldClock own{true, clock.phase, clock.stretch};
  const double first = taken_at(r, 0, own), period = r.period + clock.stretch * r.period_slack;
  const auto last = static_cast<double>(taken.size() - 1);
  std::vector<double> values(held.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = on_polynomial(taken, std::clamp((static_cast<double>(k) - first) / period, 0.0, last));
  }
  return values;
}

std::optional<Renewals> renewals_of(const std::vector<double>& samples, double step, const std::vector<bool>& filled) {
  const auto is_filled = [&](std::size_t k) { return k < filled.size() && filled[k]; };
  Renewals r;
  double last = samples.empty() ? 0.0 : samples.front();
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (is_filled(k) || samples[k] == last) continue;
    r.at.push_back(k);
    r.seen.push_back(!is_filled(k - 1));
    last = samples[k];
  }
  const double held = thresholds::held_samples_per_value;
  if (std::count(r.seen.begin(), r.seen.end(), true) < 3 ||
      static_cast<double>(samples.size()) < held * static_cast<double>(r.at.size())) {
    return std::nullopt;
  }
  r.period = mean_single_gap(r);
  if (r.period <= 0.0) return std::nullopt;
  count_turns(r);
  // A limit stays at one value now and then, but is renewed with each sample in between.
  if (r.period < 0.95 * held) return std::nullopt;
  find_period(r);
  if (step > 0.0 && !r.regular && change_of_value(samples, r) < thresholds::rounded_change * step) {
    return std::nullopt;
  }
  const StartRange range = start_range(r, r.period);
  r.first = 0.5 * (range.lowest + range.highest);
  r.slack = std::max(0.5 * range.width(), 0.0);
  count_unseen_turns(r);
  return r;
}

}  // namespace host_sim::identification
