#include "host_sim/watch/feed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace host_sim::watch {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 4> link_names{"waiting", "live", "gone", "ended"};

/// Channels that are drawn: those with a unit that is no time.
std::vector<std::string> traced_channels(const json& setup) {
  std::vector<std::string> channels;
  const auto units = setup.find("units");
  if (units == setup.end() || !units->is_object()) return channels;
  for (const auto& [name, unit] : units->items()) {
    if (unit.is_string() && unit != "s" && channels.size() < 32) channels.push_back(name);
  }
  return channels;
}

/// To six digits, so that a frame stays short; null: no number.
json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  const double digits = std::round(value * scale) / scale;
  return std::isfinite(digits) ? json(digits) : json(value);
}

/// A positive number of the setup, else the usual one.
double setup_number(const json& setup, const char* key, double usual) {
  const auto found = setup.find(key);
  if (found == setup.end() || !found->is_number()) return usual;
  const double value = found->get<double>();
  return value > 0.0 ? value : usual;
}

}  // namespace

void Feed::take(std::string_view text, const std::string& source, double now, std::int64_t wall) {
  auto datagram = parse_datagram(text);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!datagram) {
    ++counts_.malformed;
    return;
  }
  if (source != source_) {
    if (link_now(now) == Link::live) {
      ++counts_.foreign;
      note_foreign(*datagram, source, now);
      return;
    }
    change_publisher(source);
  } else if (last_ && datagram->sequence > last_->sequence) {
    counts_.lost_on_the_way += datagram->sequence - last_->sequence - 1;
  }
  ++counts_.received;
  last_at_ = now;
  if (!datagram->setup.is_null()) note_setup(datagram->setup);
  note_changes(*datagram, wall);
  if (listener_) listener_(*datagram);
  if (datagram->ended && last_) {  // the last values stay
    last_->ended = datagram->ended;
    last_->sequence = datagram->sequence;
    last_->lost = datagram->lost;
    return;
  }
  if (last_ && datagram->timestamp < last_->timestamp) ++history_version_;
  envelope_.add(datagram->timestamp, datagram->values);
  last_ = std::move(datagram);
}

void Feed::note_foreign(const Datagram& datagram, const std::string& source, double now) {
  if (!foreign_ || foreign_->source != source) foreign_ = Foreign{source, {}, {}, now};
  foreign_->at = now;
  if (!datagram.instance.empty()) foreign_->instance = datagram.instance;
  if (!datagram.setup.is_object()) return;
  const auto rig = datagram.setup.find("rig");
  if (rig != datagram.setup.end() && rig->is_string()) foreign_->rig = rig->get<std::string>();
}

void Feed::say_model(json model) {
  const std::lock_guard<std::mutex> lock(mutex_);
  model_ = std::move(model);
  ++model_version_;
}

std::string Feed::instance() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_ ? last_->instance : std::string();
}

void Feed::change_publisher(const std::string& source) {
  source_ = source;
  foreign_.reset();
  last_.reset();
  counts_.lost_on_the_way = 0;
  envelope_.begin({});
  setup_ = nullptr;
  ++history_version_;
  ++setup_version_;
}

void Feed::note_setup(const json& setup) {
  setup_ = setup;
  ++setup_version_;
  std::vector<std::string> channels = traced_channels(setup);
  if (channels == envelope_.channels()) return;
  envelope_.begin(std::move(channels));
  ++history_version_;
}

void Feed::note_changes(const Datagram& next, std::int64_t wall) {
  if (next.ended) {
    events_.push_back({wall, next.timestamp, "ended", *next.ended});
  } else if (!last_ || last_->state != next.state || (next.state == "safe" && last_->trip != next.trip)) {
    events_.push_back({wall, next.timestamp, next.state, next.state == "safe" ? next.trip : ""});
  } else if (last_->second_reason != next.second_reason && next.second_reason != "none") {
    events_.push_back({wall, next.timestamp, next.state, "then " + next.second_reason});
  } else {
    return;
  }
  if (events_.size() > most_events) events_.pop_front();
  ++events_version_;
}

double Feed::allowed_silence() const {
  if (!setup_.is_object()) return patience;
  return std::max(patience, 5.0 * setup_number(setup_, "every", 1.0) / setup_number(setup_, "sample_rate", 1000.0));
}

Link Feed::link_now(double now) const {
  if (!last_) return Link::waiting;
  if (last_->ended) return Link::ended;
  return now - last_at_ <= allowed_silence() ? Link::live : Link::gone;
}

Link Feed::link(double now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return link_now(now);
}

bool Feed::has_news(const Cursor& cursor) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return cursor.datagrams != counts_.received;
}

json Feed::traces(Cursor& cursor) const {
  json traces;
  const bool all = cursor.history != history_version_;
  traces["reset"] = all;
  std::size_t first = envelope_.complete();
  while (first > 0 && (all || envelope_[first - 1].index > cursor.interval)) --first;
  json indices = json::array();
  for (std::size_t i = first; i < envelope_.complete(); ++i) indices.push_back(envelope_[i].index);
  for (std::size_t c = 0; c < envelope_.channels().size(); ++c) {
    json low = json::array(), high = json::array();
    for (std::size_t i = first; i < envelope_.complete(); ++i) {
      low.push_back(rounded(envelope_[i].low[c]));
      high.push_back(rounded(envelope_[i].high[c]));
    }
    traces["low"][envelope_.channels()[c]] = std::move(low);
    traces["high"][envelope_.channels()[c]] = std::move(high);
  }
  traces["i"] = std::move(indices);
  traces["width"] = interval;
  cursor.history = history_version_;
  if (envelope_.complete() > 0) cursor.interval = envelope_[envelope_.complete() - 1].index;
  return traces;
}

json Feed::frame(Cursor& cursor, double now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  json frame;
  frame["link"] = link_names[static_cast<std::size_t>(link_now(now))];
  frame["counts"] = {{"received", counts_.received},
                     {"lost_on_the_way", counts_.lost_on_the_way},
                     {"malformed", counts_.malformed},
                     {"foreign", counts_.foreign}};
  if (last_) {
    frame["counts"]["lost"] = last_->lost;
    frame["silence"] = rounded(now - last_at_);
    frame["instance"] = last_->instance;
    frame["timestamp"] = last_->timestamp;
    frame["state"] = last_->state;
    frame["reason"] = last_->reason;
    frame["second_reason"] = last_->second_reason;
    frame["trip"] = last_->trip;
    frame["failed_checks"] = last_->failed_checks;
    if (last_->ended) frame["ended"] = *last_->ended;
    for (const auto& [name, value] : last_->values) frame["values"][name] = rounded(value);
  }
  constexpr double second_publisher_lasts = 3.0;  // [s]: three of its setups
  if (foreign_ && now - foreign_->at < second_publisher_lasts) {
    frame["foreign"] = {{"source", foreign_->source}, {"instance", foreign_->instance}, {"rig", foreign_->rig}};
  }
  if (cursor.setup != setup_version_) frame["setup"] = setup_;
  if (cursor.events != events_version_) {
    json events = json::array();
    for (const Event& event : events_) {
      events.push_back(
          {{"wall", event.wall}, {"timestamp", event.timestamp}, {"state", event.state}, {"text", event.text}});
    }
    frame["events"] = std::move(events);
  }
  if (cursor.model != model_version_) frame["model"] = model_;
  frame["traces"] = traces(cursor);
  cursor.model = model_version_;
  cursor.setup = setup_version_;
  cursor.events = events_version_;
  cursor.datagrams = counts_.received;
  return frame;
}

}  // namespace host_sim::watch
