#include "host_sim/frf/result_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace host_sim::frf {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json numbers(const std::vector<double>& values) {
  ordered_json list = ordered_json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

ordered_json pairs(const std::vector<Interval>& values) {
  ordered_json list = ordered_json::array();
  for (const Interval& value : values) list.push_back({number(value.low), number(value.high)});
  return list;
}

ordered_json blocks_json(const Responses& r) {
  const BlockScheme& scheme = r.blocks.scheme;
  const auto length = static_cast<double>(scheme.length);
  return {{"samples", scheme.length},
          {"seconds", length / r.sample_rate},
          {"resolution_hz", r.resolution()},
          {"overlap", 1.0 - static_cast<double>(scheme.hop) / length},
          {"window", name(scheme.window)},
          {"detrend", name(scheme.detrend)},
          {"chosen", r.request.blocks.block ? "given" : "automatically"},
          {"lowest_damping", r.request.blocks.lowest_damping},
          {"lowest_frequency_hz", r.request.blocks.lowest_frequency},
          {"peak_bias", r.blocks.peak_bias},
          {"random_error", r.blocks.random_error}};
}

}  // namespace

ordered_json to_json(const Responses& r) {
  ordered_json json;
  json["input"] = model::name(r.request.input);
  json["instrument"] = nullptr;
  if (r.request.instrument) json["instrument"] = model::name(*r.request.instrument);
  json["estimator"] = name(r.request.estimator);
  json["averages"] = r.averages;
  json["effective_averages"] = r.effective_averages;
  json["sample_rate"] = r.sample_rate;
  json["duration"] = r.duration;
  json["recordings"] = r.recordings;
  json["block"] = blocks_json(r);
  if (r.request.instrument) json["instrument_coherence"] = numbers(r.instrument_coherence);
  json["outputs"] = ordered_json::object();
  for (const OutputResponse& o : r.outputs) {
    ordered_json delay = nullptr;
    if (o.delay) delay = static_cast<double>(*o.delay) / r.sample_rate;
    json["outputs"][std::string(model::name(o.output))] = {
        {"unit", std::string(model::unit(o.output)) + " / " + std::string(model::unit(r.request.input))},
        {"delay", {{"seconds", delay}, {"compensated", o.compensated}, {"magnitude_bias", o.delay_bias}}},
        {"frequency_hz", r.frequency},
        {"magnitude", numbers(o.magnitude)},
        {"phase_rad", numbers(o.phase)},
        {"coherence", numbers(o.coherence)},
        {"magnitude_ci95", pairs(o.magnitude_ci95)},
        {"phase_ci95", pairs(o.phase_ci95)}};
  }
  return json;
}

}  // namespace host_sim::frf
