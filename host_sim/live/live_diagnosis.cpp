#include "host_sim/live/live_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/prepare/prepare.hpp"
#include "host_sim/live/thresholds.hpp"

namespace host_sim::live {

using model::Channel;

namespace {

constexpr auto run_in_blocks = static_cast<std::size_t>(thresholds::run_in / thresholds::block);
constexpr auto known_blocks = static_cast<std::size_t>(thresholds::acquaintance / thresholds::block);

/// Blocks one behind the other as one recording: the channels that all of them have.
firmware::Recording joined(const std::deque<Block>& blocks, Channel driving) {
  firmware::Recording r = blocks.front().recording.without_samples();
  r.sample_period = blocks.front().recording.sample_period;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from, const Block& b) {
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(b.from + 1),
              from.begin() + static_cast<std::ptrdiff_t>(b.to + 1));
  };
  for (const Block& b : blocks) append(r.time, b.recording.time, b);
  const auto join = [&](auto member) {
    const auto& all = blocks.front().recording.*member;
    for (std::size_t c = 0; c < all.size(); ++c) {
      const bool everywhere =
          std::all_of(blocks.begin(), blocks.end(), [&](const Block& b) { return !(b.recording.*member)[c].empty(); });
      if (!everywhere) continue;
      for (const Block& b : blocks) append((r.*member)[c], (b.recording.*member)[c], b);
    }
  };
  join(&firmware::Recording::channels);
  join(&firmware::Recording::ducts);
  for (const Block& b : blocks) {
    const auto& missing = b.unused[index(driving)];
    for (const char one : missing) r.filled.push_back(one != 0);
  }
  if (r.filled.size() != r.size() || std::find(r.filled.begin(), r.filled.end(), true) == r.filled.end()) {
    r.filled.clear();
  }
  return r;
}

double deviation_of(const std::vector<double>& values) {
  double mean = 0.0, squares = 0.0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(std::max<std::size_t>(values.size(), 1));
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// The channel that drives a rig's simulation, of those that a block has.
std::optional<Channel> driving_channel(const firmware::RigDescription& description, const Block& block) {
  const auto has = [&](Channel channel) { return block.recording.has(channel); };
  std::vector<Channel> choices;
  switch (description.rig.kind) {
    case model::RigKind::quarter_car:
      choices = {Channel::z_cmd, Channel::z_r};
      break;
    case model::RigKind::hil:
    case model::RigKind::component_bench:
      choices = {Channel::x_cmd, Channel::x_act};
      break;
    case model::RigKind::driven_mass:
      choices = {Channel::F};
      break;
  }
  const auto found = std::find_if(choices.begin(), choices.end(), has);
  return found == choices.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

std::string_view name(Finding::Kind kind) {
  constexpr std::array<std::string_view, 5> names{"named", "unexplained", "stuck", "lost", "returned"};
  return names[static_cast<std::size_t>(kind)];
}

std::string_view name(Progress::Stage stage) {
  constexpr std::array<std::string_view, 3> names{"waiting", "learning", "watching"};
  return names[static_cast<std::size_t>(stage)];
}

std::string sentence(const Finding& finding) {
  char text[256];
  const NamedCause& c = finding.cause;
  const std::string of = c.channel.empty() ? "" : " of " + c.channel;
  const std::string unit = c.unit.empty() || c.unit == "1" ? "" : " " + std::string(c.unit);
  switch (finding.kind) {
    case Finding::Kind::named:
      std::snprintf(text, sizeof text, "%s%s: %s %.4g ± %.2g%s (before %.4g), since %.2f s", c.name.c_str(), of.c_str(),
                    c.parameter.c_str(), c.value, 2.0 * c.deviation, unit.c_str(), c.described, finding.since);
      break;
    case Finding::Kind::unexplained:
      std::snprintf(text, sizeof text, "the rig has changed since %.2f s, and no cause of the catalogue explains it",
                    finding.since);
      break;
    case Finding::Kind::stuck:
      std::snprintf(text, sizeof text, "sensor %s is stuck at %.6g%s since %.2f s", c.channel.c_str(), c.value,
                    unit.c_str(), finding.since);
      break;
    case Finding::Kind::lost:
      std::snprintf(text, sizeof text, "sensor %s is lost since %.2f s", c.channel.c_str(), finding.since);
      break;
    case Finding::Kind::returned:
      std::snprintf(text, sizeof text, "sensor %s shows values again since %.2f s", c.channel.c_str(), finding.since);
      break;
  }
  std::string all = text;
  for (const NamedCause& rival : finding.rivals) {
    all += "; or " + rival.name + (rival.channel.empty() ? "" : " of " + rival.channel);
  }
  return all;
}

LiveDiagnosis::LiveDiagnosis(const firmware::RigDescription& description)
    : description_(description), buffer_(description) {
  firmware::refuse_compensation(description, "diagnose --live");
}

std::vector<Finding> LiveDiagnosis::push(const LiveSample& sample) {
  fresh_.clear();
  for (const ReadingChange& change : readings_.look_at(sample)) {
    const bool lost = change.kind == ReadingChange::Kind::lost;
    NamedCause cause;
    cause.channel = model::name(change.channel);
    cause.unit = model::unit(change.channel);
    add({lost ? Finding::Kind::lost : Finding::Kind::returned,
         cause,
         {},
         change.since,
         change.at,
         change.at - change.since});
    if (test_) test_->forget_window();
  }
  buffer_.push(sample);
  while (const auto block = buffer_.take()) take(*block);
  return fresh_;
}

void LiveDiagnosis::add(Finding finding) {
  fresh_.push_back(finding);
  findings_.push_back(std::move(finding));
}

void LiveDiagnosis::take(const Block& block) {
  const auto driving = driving_channel(description_, block);
  const bool driven = driving && !readings_.is_bad(*driving);
  if (!twins_) {
    if (!driven || block.anew) known_.clear();
    if (!driven) {
      waits_for_ = "nothing is measured that drives the simulation";
      return;
    }
    known_.push_back(block);
    if (known_.size() >= known_blocks) begin();
    return;
  }
  if (!driven || *driving != twins_->input()) {
    run_in_ = run_in_blocks + 1;  // one more: it begins with the first block that is driven again
    test_->forget_window();
    return;
  }
  if (block.anew || run_in_ > run_in_blocks) {
    twins_->start(block);
    run_in_ = run_in_blocks;
    recent_.clear();
    test_->forget_window();
  }
  observe(block);
}

void LiveDiagnosis::begin() {
  const Channel driving = *driving_channel(description_, known_.front());
  try {
    std::vector<identification::Record> records;
    records.push_back({joined(known_, driving), identification::Use::fitted});
    prepared_ = std::move(identification::prepare(description_, std::move(records)).recordings.front());
    twins_ = std::make_unique<Twins>(description_, *prepared_);
  } catch (const firmware::InputError& error) {
    waits_for_ = error.what();
    known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(known_.size() / 2));
    return;
  }
  twins_->start(known_.front());
  Response measured, left, described;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const Block& block = known_[i];
    const Response& readings = twins_->describe(block);
    if (i < run_in_blocks) continue;
    for (const Channel channel : twins_->channels()) {
      const auto c = index(channel);
      for (std::size_t k = 0; k < block.size(); ++k) {
        if (block.unused[c].empty() || block.unused[c][k] != 0) continue;
        left[c].push_back(block.recording[channel][block.from + 1 + k] - readings[c][k]);
        described[c].push_back(readings[c][k]);
      }
    }
  }
  for (const Channel channel : twins_->channels()) {
    const auto c = index(channel);
    double mean = 0.0;
    for (const double r : left[c]) mean += r;
    mean /= static_cast<double>(std::max<std::size_t>(left[c].size(), 1));
    const double moved = deviation_of(described[c]);
    // A channel without noise, which a simulated rig may have, counts as known to a millionth.
    residuals_[c] = {mean, std::max({deviation_of(left[c]), prepared_->noise[c], 1e-6 * moved, 1e-12})};
  }
  if (!std::any_of(known_.begin(), known_.end(), [&](const Block& block) { return moves(block); })) {
    waits_for_ = "the rig does not move more than its sensor's noise";
    twins_.reset();
    known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(known_.size() / 2));
    return;
  }
  waits_for_.clear();
  test_ = std::make_unique<ScoreTest>(twins_->tested(), thresholds::block);
  twins_->start(known_.front());
  run_in_ = run_in_blocks;
  const std::deque<Block> blocks = std::exchange(known_, {});
  for (const Block& block : blocks) observe(block);
}

bool LiveDiagnosis::moves(const Block& block) const {
  const auto& driving = block.recording[twins_->input()];
  const double noise = twins_->input_is_measured() ? prepared_->input_noise.position : 0.0;
  return deviation_of({driving.begin() + static_cast<std::ptrdiff_t>(block.from + 1),
                       driving.begin() + static_cast<std::ptrdiff_t>(block.to + 1)}) > thresholds::moves * noise;
}

void LiveDiagnosis::observe(const Block& given) {
  Block block = given;
  for (const Channel channel : twins_->channels()) {
    if (!readings_.is_bad(channel)) continue;
    auto& unused = block.unused[index(channel)];
    std::fill(unused.begin(), unused.end(), static_cast<char>(1));
  }
  recent_.push_back(block);
  if (recent_.size() > run_in_blocks + 2 * thresholds::window) recent_.pop_front();
  BlockScore score = twins_->score(block, residuals_);
  if (run_in_ > 0) {
    --run_in_;
    return;
  }
  const Response& readings = twins_->readings();
  std::vector<ReadingChange> stuck;
  for (const Channel channel : twins_->channels()) {
    const auto c = index(channel);
    const auto found = readings_.compare(block, channel, readings[c], residuals_[c].deviation);
    stuck.insert(stuck.end(), found.begin(), found.end());
  }
  const double worst = score.samples > 0.0 ? std::sqrt(score.power / score.samples) : 0.0;
  if (twins_->input_is_measured() && worst > thresholds::stuck_move) {  // the model stands still with its input
    const auto found = readings_.compare(block, twins_->input(), {0.0, 2.0 * thresholds::stuck_move}, 1.0);
    stuck.insert(stuck.end(), found.begin(), found.end());
  }
  for (const ReadingChange& change : stuck) {
    NamedCause cause;
    cause.channel = model::name(change.channel);
    cause.unit = model::unit(change.channel);
    cause.value = block.recording[change.channel][block.to];
    add({Finding::Kind::stuck, cause, {}, change.since, change.at, change.at - change.since});
  }
  if (!stuck.empty()) return test_->forget_window();
  if (!moves(block) && worst <= thresholds::stuck_move) {  // nothing is learned of a rig at rest
    recent_.clear();
    return;
  }
  if (test_->lacking() == 0) watched_ += thresholds::block;
  if (const auto onset = test_->add(std::move(score))) conclude(*onset);
}

NamedCause LiveDiagnosis::named(const Sized& sized) {
  const Cause& cause = sized.cause;
  NamedCause named;
  named.name = cause.entry != nullptr ? std::string(cause.entry->name) : cause.path;
  if (cause.channel) named.channel = model::name(*cause.channel);
  named.parameter = cause.path.substr(cause.path.rfind('.') + 1);
  named.unit = cause.unit;
  named.described = cause.described;
  named.value = sized.value;
  named.deviation = sized.deviation;
  if (cause.entry != nullptr) named.shows = cause.entry->shows;
  return named;
}

std::vector<LiveDiagnosis::Sized> LiveDiagnosis::second_step(const Onset& onset) const {
  const auto value_at = [](const Cause& cause, double step, double size) {
    return std::clamp(cause.inverse ? step / size : cause.described + size * step, cause.lower, cause.upper);
  };
  std::vector<Sized> first;
  std::vector<std::pair<std::size_t, double>> values;
  for (const Onset::Contender& c : onset.contenders) {
    const Candidate& candidate = twins_->candidates()[c.candidate];
    const Cause& cause = twins_->causes()[candidate.cause];
    const double value = value_at(cause, candidate.step, c.size);
    const double deviation = cause.inverse ? c.deviation / c.size * value : c.deviation * std::abs(candidate.step);
    first.push_back({cause, value, deviation, c.gain - onset.unit * cause.price});
    if (value != cause.described) values.push_back({candidate.cause, value});
  }
  const auto sorted = [](std::vector<Sized> all) {
    std::stable_sort(all.begin(), all.end(), [](const Sized& x, const Sized& y) { return x.gain > y.gain; });
    return all;
  };
  if (recent_.size() < run_in_blocks + onset.blocks) return sorted(first);  // behind a gap
  Twins neighbours = twins_->at(values);
  std::vector<double> b(neighbours.candidates().size(), 0.0), a(b);
  const std::size_t from = recent_.size() - run_in_blocks - onset.blocks;
  neighbours.start(recent_[from]);
  for (std::size_t i = from; i < recent_.size(); ++i) {
    const BlockScore score = neighbours.score(recent_[i], residuals_);
    if (i < from + run_in_blocks) continue;
    for (std::size_t j = 0; j < b.size(); ++j) {
      b[j] += score.score[j];
      a[j] += score.information[j];
    }
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Cause& cause = neighbours.causes()[neighbours.candidates()[j].cause];
    const auto same =
        std::find_if(first.begin(), first.end(), [&](const Sized& s) { return s.cause.path == cause.path; });
    const Onset::Contender& c = onset.contenders[static_cast<std::size_t>(same - first.begin())];
    if (!(a[j] > 0.0)) continue;
    // What the baseline expects is that of the first step, as far as the direction is the same.
    const double scale = std::copysign(std::sqrt(a[j] / c.information), c.size);
    const double e = b[j] - scale * c.expected;
    const Tested bounds = neighbours.tested()[j];
    const double theta = std::clamp(e / a[j], bounds.lower, bounds.upper);
    if (!(theta > 0.0)) continue;
    same->value = value_at(cause, neighbours.candidates()[j].step, theta);
    same->deviation =
        same->deviation * (cause.inverse ? 1.0
                                         : std::abs(neighbours.candidates()[j].step * scale /
                                                    (twins_->candidates()[c.candidate].step * a[j] / c.information)));
    same->gain = 2.0 * theta * e - theta * theta * a[j] - onset.unit * cause.price;
  }
  return sorted(first);
}

void LiveDiagnosis::conclude(const Onset& onset) {
  if (onset.passed) {
    ++passed_;
    test_->forget_window();
    return;
  }
  Finding finding;
  finding.since = onset.since;
  finding.named_at = onset.at;
  finding.motion = onset.motion;
  finding.share = onset.share;
  if (!onset.named) {
    finding.kind = Finding::Kind::unexplained;
    add(std::move(finding));
    test_ = std::make_unique<ScoreTest>(twins_->tested(), thresholds::block);
    return;
  }
  const std::vector<Sized> sized = second_step(onset);
  finding.cause = named(sized.front());
  for (std::size_t i = 1; i < sized.size(); ++i) {
    if (sized[i].gain >= sized.front().gain - thresholds::rival * onset.unit) finding.rivals.push_back(named(sized[i]));
  }
  if (!finding.rivals.empty() && !onset.last_word) return;  // more motion may tell them apart
  const Cause cause = sized.front().cause;
  const double value = finding.cause.value;
  add(std::move(finding));
  // It is part of the rig from now on. What cannot be put there, as the model cannot step it, is in the new baseline.
  firmware::RigDescription changed = description_;
  if (cause.entry == nullptr) {
    *firmware::find_parameter(changed.rig, cause.path) = value;
  } else if (value != cause.entry->parameters[0].neutral) {
    firmware::put_effect(changed.rig, {cause.entry, cause.channel, {value}});
  } else {
    firmware::remove_effect(changed.rig, *cause.entry, cause.channel);
  }
  if (!firmware::find_rig_fault(changed.rig, changed.period())) description_ = std::move(changed);
  twins_ = std::make_unique<Twins>(description_, *prepared_);
  test_ = std::make_unique<ScoreTest>(twins_->tested(), thresholds::block);
  run_in_ = run_in_blocks + 1;
}

Progress LiveDiagnosis::progress() const {
  Progress p;
  p.waits_for = waits_for_;
  p.watched = watched_;
  p.passed = passed_;
  if (!twins_) {
    p.lacking = static_cast<double>(known_blocks - std::min(known_blocks, known_.size()) + thresholds::baseline) *
                    thresholds::block -
                thresholds::run_in;
    return p;
  }
  p.candidates = twins_->candidates().size();
  p.lacking = static_cast<double>(run_in_ + test_->lacking()) * thresholds::block;
  p.stage = p.lacking > 0.0 ? Progress::Stage::learning : Progress::Stage::watching;
  p.largest = test_->largest();
  p.level = test_->level();
  return p;
}

}  // namespace host_sim::live
