#include "firmware/controller/publishing/datagram.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "firmware/controller/recording/trip_text.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/json_text.hpp"

namespace firmware::controller {
namespace {

/// An object, key by key.
class Object {
 public:
  void raw(std::string_view key, std::string_view value) {
    text_ += text_.empty() ? "{\"" : ",\"";
    text_ += key;
    text_ += "\":";
    text_ += value;
  }
  void whole(std::string_view key, std::uint64_t value) { raw(key, std::to_string(value)); }
  void words(std::string_view key, std::string_view value) { raw(key, json_text(value)); }
  /// With nine digits; nothing for a value that is no number.
  void number(std::string_view key, double value) {
    if (!std::isfinite(value)) return;
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 9);
    raw(key, std::string_view(digits, static_cast<std::size_t>(end.ptr - digits)));
  }
  /// [s] with all nanoseconds, which nine digits do not hold.
  void time(std::string_view key, hal::Time time) {
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t size = time.ns < 0 ? -time.ns : time.ns;
    char digits[48];
    std::snprintf(digits, sizeof digits, "%s%lld.%09lld", time.ns < 0 ? "-" : "", static_cast<long long>(size / second),
                  static_cast<long long>(size % second));
    raw(key, digits);
  }
  [[nodiscard]] std::string text() const { return text_.empty() ? "{}" : text_ + "}"; }

 private:
  std::string text_;
};

/// To what a reader of datagrams takes: whole entries of a list.
std::string shortened(const std::string& list) {
  constexpr std::size_t longest = 300;
  if (list.size() <= longest) return list;
  const std::string_view more = "; …";
  const std::size_t end = list.rfind("; ", longest - more.size());
  return list.substr(0, end == std::string::npos ? 0 : end) + std::string(more);
}

double microseconds(std::uint64_t ns) { return static_cast<double>(ns) * 1e-3; }

/// [[longest µs, spans], …] in quarters of an octave.
std::string classes_text(const Histogram& histogram) {
  std::map<int, std::pair<std::uint64_t, std::uint64_t>> quarters;
  histogram.for_each_class([&](std::uint64_t longest, std::uint64_t spans) {
    const double octave = std::log2(static_cast<double>(longest > 0 ? longest : 1));
    auto& [upper, count] = quarters[static_cast<int>(std::floor(4.0 * octave))];
    upper = longest;
    count += spans;
  });
  std::string text = "[";
  for (const auto& [quarter, content] : quarters) {
    char pair[64];
    std::snprintf(pair, sizeof pair, "%s[%.6g,%llu]", text.size() > 1 ? "," : "", microseconds(content.first),
                  static_cast<unsigned long long>(content.second));
    text += pair;
  }
  return text + "]";
}

/// [µs]
std::string span_text(const Histogram& histogram) {
  Object span;
  span.whole("count", histogram.count());
  span.number("p50", microseconds(histogram.quantile(0.5)));
  span.number("p99", microseconds(histogram.quantile(0.99)));
  span.number("p999", microseconds(histogram.quantile(0.999)));
  span.number("max", microseconds(histogram.highest()));
  span.raw("classes", classes_text(histogram));
  return span.text();
}

}  // namespace

DatagramWriter::DatagramWriter(const RigDescription& rig, const hal::SensorSetup& sensors, bool simulated,
                               std::uint64_t every, const Spans& spans, std::string instance)
    : rig_(rig),
      columns_(rig, sensors),
      simulated_(simulated),
      every_(every),
      spans_(spans),
      instance_(std::move(instance)) {}

std::string DatagramWriter::period(const Record& record, const Numbers& numbers, bool with_setup) const {
  Object object;
  object.time("timestamp", record.time);
  object.whole("sequence", numbers.sequence);
  object.whole("period", record.period);
  object.whole("lost", numbers.lost);
  object.words("instance", instance_);
  for (const RunColumns::Column& column : columns_.columns()) {
    object.number(column.name, RunColumns::value(column, record));
  }
  object.words("state", name(record.mode));
  object.words("reason_name", name(record.trip.reason));
  object.words("second_reason", name(record.second));
  if (record.trip.reason != Reason::none) object.words("trip", trip_text(record.trip, rig_));
  if (const std::string refused = record.mode == Mode::safe && refusals_ ? refusals_() : std::string();
      !refused.empty()) {
    object.words("failed_checks", shortened(refused));
  }
  if (rig_.rig.kind == model::RigKind::hil) {
    object.number("energy_fed", record.energy_fed);
    object.number("energy_taken", record.energy_taken);
  }
  object.number("command", record.command.position);
  object.number("tare", record.tare);
  object.whole("bridged", record.counters.bridged_samples);
  object.whole("late_periods", record.counters.late_periods);
  object.whole("limited_commands", record.counters.limited_commands);
  if (with_setup) object.raw("setup", setup());
  return object.text();
}

std::string DatagramWriter::end(hal::Time time, const Numbers& numbers, const std::string& why) const {
  Object object;
  object.time("timestamp", time);
  object.whole("sequence", numbers.sequence);
  object.whole("lost", numbers.lost);
  object.words("instance", instance_);
  object.words("ended", why);
  return object.text();
}

std::string DatagramWriter::setup() const {
  const Settings settings = control_settings(rig_);
  Object limits;
  limits.number("stroke", settings.limits.stroke);
  limits.number("speed", settings.limits.speed);
  limits.number("force", settings.limits.force);
  limits.number("sample_age", settings.limits.stale_after * rig_.period());
  if (rig_.rig.kind == model::RigKind::hil) {
    limits.number("energy_gain", settings.limits.energy_gain);
    if (rig_.hardware.schedule.allowed_delay > 0.0) limits.number("delay", rig_.hardware.schedule.allowed_delay);
  }
  Object units;
  for (const RunColumns::Column& column : columns_.columns()) {
    if (!column.unit.empty()) units.words(column.name, column.unit);
  }
  Object spans;
  spans.raw("wake_up", span_text(spans_.wake_up));
  spans.raw("step", span_text(spans_.step));
  spans.raw("age", span_text(spans_.age));
  Object object;
  object.words("rig", std::filesystem::path(rig_.source).filename().string());
  object.words("kind", model::name(rig_.rig.kind));
  object.whole("simulated", simulated_ ? 1 : 0);
  object.number("sample_rate", rig_.sample_rate);
  object.whole("every", every_);
  if (!recording_.empty()) object.words("recording", recording_);
  if (duration_ > 0.0) object.number("duration", duration_);
  object.raw("limits", limits.text());
  object.raw("units", units.text());
  object.raw("spans_us", spans.text());
  return object.text();
}

}  // namespace firmware::controller
