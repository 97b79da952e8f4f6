#include "host_sim/live/score_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/live/thresholds.hpp"

namespace host_sim::live {

double normal_of_student(double t, double degrees) {
  const double z = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0) * std::sqrt(degrees * std::log1p(t * t / degrees));
  return std::copysign(z, t);
}

double two_sided_quantile(double probability) {
  double low = 0.0, high = 38.0;  // erfc of more is no number
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::numbers::sqrt2) > probability ? low : high) = middle;
  }
  return high;
}

ScoreTest::ScoreTest(std::vector<Tested> candidates, double block)
    : candidates_(std::move(candidates)), block_(block), sums_(candidates_.size()) {
  const double tests_per_hour =
      static_cast<double>(std::max<std::size_t>(candidates_.size(), 1) * thresholds::window) * 3600.0 / block_;
  level_ = two_sided_quantile(thresholds::false_names_per_hour / tests_per_hour);
}

double ScoreTest::Sums::noise() const {
  const double m = mean();
  return blocks < 2 ? 0.0 : std::max(0.0, bb_a - 2.0 * m * b + m * m * a) / static_cast<double>(blocks - 1);
}

double ScoreTest::Sums::error() const {
  const double m = mean();
  return aa > 0.0 ? std::max(0.0, bb - 2.0 * m * ab + m * m * aa) / aa : 0.0;
}

double ScoreTest::Sums::alikeness() const {
  const auto n = static_cast<double>(blocks);
  if (blocks < 6) return 1.0;
  const double middle = z / n, spread = zz / n - middle * middle;
  if (!(spread > 0.0)) return 1.0;
  double k = 1.0;
  for (int l = 1; l <= 4; ++l) {
    const double correlation = (lagged[l - 1] / (n - l) - middle * middle) / spread;
    k += 2.0 * correlation * (1.0 - l / 5.0);
  }
  return std::max(1.0, k);
}

std::size_t ScoreTest::lacking() const { return learned_ < thresholds::baseline ? thresholds::baseline - learned_ : 0; }

void ScoreTest::learn(const BlockScore& block) {
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    Sums& s = sums_[j];
    const double b = block.score[j], a = block.information[j];
    if (!(a > 0.0)) continue;
    const double z = b / std::sqrt(a);
    for (std::size_t l = 0; l < 4 && l < s.blocks; ++l) s.lagged[l] += z * s.previous[l];
    for (std::size_t l = 3; l > 0; --l) s.previous[l] = s.previous[l - 1];
    s.previous[0] = z;
    s.b += b;
    s.a += a;
    s.bb_a += b * b / a;
    s.bb += b * b;
    s.ab += a * b;
    s.aa += a * a;
    s.z += z;
    s.zz += z * z;
    ++s.blocks;
  }
  const double power = block.power / std::max(block.samples, 1.0);
  power_ += power;
  power_squares_ += power * power;
  samples_ += block.samples;
  ++learned_;
}

void ScoreTest::forget_window() {
  window_.clear();
  suspected_.reset();
}

ScoreTest::Window ScoreTest::window(std::size_t candidate, std::size_t blocks) const {
  Window w;
  for (std::size_t i = window_.size() - blocks; i < window_.size(); ++i) {
    const double a = window_[i].information[candidate];
    w.b += window_[i].score[candidate];
    w.a += a;
    w.aa += a * a;
  }
  w.blocks = blocks;
  return w;
}

double ScoreTest::variance(std::size_t candidate, const Window& w) const {
  const Sums& s = sums_[candidate];
  const double k = s.alikeness(), f = s.noise();
  return k * std::max(f * w.a, s.error() * w.aa) + (s.a > 0.0 ? w.a * w.a * k * f / s.a : 0.0);
}

double ScoreTest::beyond(std::size_t candidate, const Window& w) const {
  const Sums& s = sums_[candidate];
  const double following = w.a * s.mean();
  const double constant = s.blocks > 0 ? s.b / static_cast<double>(s.blocks) * static_cast<double>(w.blocks) : 0.0;
  return w.b - std::clamp(w.b, std::min(following, constant), std::max(following, constant));
}

double ScoreTest::size(std::size_t candidate, const Window& w) const {
  if (!(w.a > 0.0)) return 0.0;
  return std::clamp(beyond(candidate, w) / w.a, candidates_[candidate].lower, candidates_[candidate].upper);
}

double ScoreTest::gain(std::size_t candidate, const Window& w) const {
  const double theta = size(candidate, w);
  return 2.0 * theta * beyond(candidate, w) - theta * theta * w.a;
}

double ScoreTest::deviations(std::size_t candidate, const Window& w) const {
  const double v = variance(candidate, w);
  if (!(v > 0.0) || !(w.a > 0.0) || sums_[candidate].blocks < thresholds::baseline / 2) return 0.0;
  return normal_of_student(size(candidate, w) * w.a / std::sqrt(v), static_cast<double>(sums_[candidate].blocks - 1));
}

ScoreTest::Found ScoreTest::most_significant() const {
  const std::size_t longest = std::min(window_.size(), thresholds::window);
  std::vector<double> wrong(longest + 1, 0.0);  // (8) by length of the window
  const auto over_windows = [&](std::size_t j, const auto& visit) {
    Window w;
    for (std::size_t n = 1; n <= longest; ++n) {
      const BlockScore& block = window_[window_.size() - n];
      const double a = block.information[j];
      w.b += block.score[j];
      w.a += a;
      w.aa += a * a;
      w.blocks = n;
      visit(n, w);
    }
  };
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    const double before = sums_[j].mean();
    over_windows(j, [&](std::size_t n, const Window& w) { wrong[n] = std::max(wrong[n], before * before * w.a); });
  }
  Found found;
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    over_windows(j, [&](std::size_t n, const Window& w) {
      const double z = std::abs(deviations(j, w));
      if (z > found.deviations && gain(j, w) > wrong[n]) found = {j, n, z};
    });
  }
  return found;
}

Onset ScoreTest::describe(const Found& found) const {
  Onset onset;
  onset.unit = std::max(1.0, sums_[found.candidate].noise());
  onset.blocks = found.blocks;
  const auto worth = [&](const Onset::Contender& c) { return c.gain - onset.unit * candidates_[c.candidate].price; };
  std::vector<Onset::Contender> all;
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    const Window w = window(j, found.blocks);
    if (!(w.a > 0.0)) continue;
    all.push_back({j, size(j, w), std::sqrt(variance(j, w)) / w.a, gain(j, w), w.a, w.b - beyond(j, w)});
  }
  std::sort(all.begin(), all.end(), [&](const auto& x, const auto& y) { return worth(x) > worth(y); });
  std::vector<std::size_t> said;
  for (const Onset::Contender& c : all) {
    const std::size_t cause = candidates_[c.candidate].cause;
    if (c.gain < thresholds::least_share * all.front().gain || !(c.gain > 0.0) ||
        std::find(said.begin(), said.end(), cause) != said.end()) {
      continue;
    }
    said.push_back(cause);
    if (!onset.contenders.empty() && worth(c) >= worth(all.front()) - thresholds::rival * onset.unit) ++onset.rivals;
    onset.contenders.push_back(c);
  }
  const Onset::Contender& best = onset.contenders.front();
  onset.candidate = best.candidate;
  onset.size = best.size;
  onset.deviation = best.deviation;
  onset.gain = best.gain;
  const Rise rose = rise(found.blocks);
  onset.share = onset.gain / std::max(onset.gain, rose.size - thresholds::rise_doubt * rose.deviation);
  onset.since = window_[window_.size() - found.blocks].begins;
  onset.at = window_.back().ends;
  onset.motion = static_cast<double>(found.blocks) * block_;
  return onset;
}

ScoreTest::Rise ScoreTest::rise(std::size_t blocks) const {
  const auto n = static_cast<double>(learned_);
  const double mean = power_ / n, spread = std::sqrt(std::max(0.0, power_squares_ / n - mean * mean));
  Rise rise;
  for (std::size_t i = window_.size() - blocks; i < window_.size(); ++i) {
    rise.size += window_[i].power - mean * window_[i].samples;
    rise.deviation = std::hypot(rise.deviation, spread * window_[i].samples);
  }
  return rise;
}

std::optional<Onset> ScoreTest::add(BlockScore block) {
  if (lacking() > 0) {
    learn(block);
    return std::nullopt;
  }
  window_.push_back(std::move(block));
  if (!suspected_ && window_.size() > thresholds::window) {
    learn(window_.front());
    window_.pop_front();
  }
  const Found found = most_significant();
  largest_ = found.deviations;
  if (!suspected_) {
    if (found.deviations <= level_) return std::nullopt;
    suspected_ = found.blocks;
  } else {
    ++*suspected_;
  }
  const bool full = *suspected_ >= thresholds::window;
  if (found.deviations <= level_) {
    if (!full) return std::nullopt;
    Onset over;
    over.since = window_[window_.size() - std::min(*suspected_, window_.size())].begins;
    over.at = window_.back().ends;
    over.motion = static_cast<double>(*suspected_) * block_;
    over.passed = true;
    return over;
  }
  if (found.blocks < thresholds::lasting && !full) return std::nullopt;
  Onset onset = describe(found);
  const std::size_t latest = std::clamp<std::size_t>(found.blocks / 2, 1, thresholds::lasting);
  const double now = size(onset.candidate, window(onset.candidate, latest));
  const bool lasts = now / onset.size >= 0.5;
  const bool explained = onset.share >= thresholds::least_share;
  if (!full && !(lasts && explained)) return std::nullopt;
  onset.named = lasts && explained;
  onset.passed = !lasts;
  onset.last_word = full;
  return onset;
}

}  // namespace host_sim::live
