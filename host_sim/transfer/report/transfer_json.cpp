#include "host_sim/transfer/report/transfer_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_sim/transfer/report/wording.hpp"

namespace host_sim::transfer {
namespace {

using nlohmann::json;

json finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json by_source(const Budget& budget) {
  json object = json::object();
  for (std::size_t s = 0; s < source_count; ++s) object[std::string(source_names[s])] = budget[s];
  return object;
}

json quantities_of(const Prediction& prediction, const std::optional<Validation>& validation, bool with_sources) {
  json object = json::object();
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const Bands bands = prediction.quantity(static_cast<Quantity>(q));
    json one{{"unit", quantity_units[q]},
             {"median", finite(bands.median)},
             {"band50", {finite(bands.low50), finite(bands.high50)}},
             {"band95", {finite(bands.low95), finite(bands.high95)}},
             {"measured", validation ? finite(validation->measured.quantity[q]) : json(nullptr)}};
    if (with_sources) one["sources"] = by_source(prediction.budget[q]);
    if (validation && std::isfinite(validation->quantity_area[q])) one["area_metric"] = validation->quantity_area[q];
    object[std::string(quantity_names[q])] = std::move(one);
  }
  return object;
}

json responses_of(const SecondRig& second, const Prediction& prediction, const std::optional<Validation>& validation) {
  json object = json::object();
  for (std::size_t r = 0; r < 2; ++r) {
    json one{{"unit", response_units[r]}, {"frequency_hz", second.analysis->frequencies()}};
    const auto put = [&](const char* key, const std::vector<Bands>& bands, double Bands::*part) {
      json list = json::array();
      for (const Bands& b : bands) list.push_back(finite(b.*part));
      one[key] = std::move(list);
    };
    const std::vector<Bands> bands = prediction.response(r), spectrum = prediction.density(r);
    put("median", bands, &Bands::median);
    put("low50", bands, &Bands::low50);
    put("high50", bands, &Bands::high50);
    put("low95", bands, &Bands::low95);
    put("high95", bands, &Bands::high95);
    put("spectrum_median", spectrum, &Bands::median);
    put("spectrum_low95", spectrum, &Bands::low95);
    put("spectrum_high95", spectrum, &Bands::high95);
    json measured = json::array(), measured_spectrum = json::array();
    if (validation) {
      for (const auto& h : validation->measured.response[r]) measured.push_back(finite(std::abs(h)));
      for (const double s : validation->measured.density[r]) measured_spectrum.push_back(finite(s));
    }
    one["measured"] = std::move(measured);
    one["spectrum_measured"] = std::move(measured_spectrum);
    object[std::string(response_names[r])] = std::move(one);
  }
  return object;
}

json value_of(const LearnedValue& value) {
  return {{"value", finite(value.value)}, {"ci95", {finite(value.lower), finite(value.upper)}}};
}

json effects_of(const std::vector<OwnedEffect>& list) {
  json array = json::array();
  for (const OwnedEffect& effect : list) {
    json one{{"name", effect.name}, {"parameters", json::object()}};
    if (!effect.channel.empty()) one["channel"] = effect.channel;
    for (const LearnedValue& value : effect.parameters) one["parameters"][value.path] = value_of(value);
    array.push_back(std::move(one));
  }
  return array;
}

json band_list_of(const Validation& validation) {
  json array = json::array();
  for (const BandCheck& b : validation.bands) {
    array.push_back({{"response", response_names[b.response]},
                     {"band_hz", {b.lowest, b.highest}},
                     {"p", b.p},
                     {"deviation", b.deviation},
                     {"half_width95", b.half_width},
                     {"stiffness_error", b.force.real()},
                     {"damping_error", b.force.imag()},
                     {"holds", b.holds}});
  }
  return array;
}

void put_validation(const Validation& v, json& object) {
  object["coverage"] = {{"50", v.coverage50}, {"95", v.coverage95}};
  object["area_metric"] = json::object();
  object["area_metric_in_unit"] = json::object();
  for (std::size_t r = 0; r < 2; ++r) {
    if (v.measured.response[r].empty()) continue;
    object["area_metric"][std::string(response_names[r])] = v.area_share[r];
    object["area_metric_in_unit"][std::string(response_names[r])] = v.area[r];
  }
  object["log_score"] = v.log_score;
  object["bands"] = band_list_of(v);
}

json alternative_of(const SecondRig& second, const Alternative& alternative, bool responses) {
  json object{{"quantities", quantities_of(alternative.prediction, alternative.validation, false)}};
  if (responses) object["responses"] = responses_of(second, alternative.prediction, alternative.validation);
  if (alternative.validation) {
    put_validation(*alternative.validation, object);
    object["holds"] = alternative.validation->holds;
  }
  return object;
}

json posterior_of(const Posterior& posterior) {
  json object{{"draws", posterior.draws},
              {"rhat", posterior.largest_rhat},
              {"effective_draws", posterior.fewest_effective},
              {"accepted", posterior.accepted},
              {"temper", posterior.temper},
              {"at_bounds", posterior.at_bounds},
              {"warnings", posterior.warnings},
              {"confounded", posterior.confounded},
              {"models", json::array()},
              {"discrepancy", json::array()},
              {"parameters", json::object()}};
  for (const ComponentModel& model : posterior.models) {
    object["models"].push_back({{"name", model.name}, {"probability", model.probability}});
  }
  for (const auto& band : posterior.discrepancy.bands) {
    object["discrepancy"].push_back(
        {{"band_hz", {band.lowest, band.highest}}, {"relative", band.relative}, {"significance", band.significance}});
  }
  for (const LearnedValue& value : posterior.learned) {
    json one = value_of(value);
    one["unit"] = value.unit;
    one["travels"] = value.travels;
    object["parameters"][value.path] = std::move(one);
  }
  return object;
}

json shared_of(const BothRigs& both) {
  json array = json::array();
  for (const SharedValue& s : both.shared) {
    array.push_back({{"path", s.path},
                     {"unit", s.unit},
                     {"first", value_of(s.first)},
                     {"second", value_of(s.second)},
                     {"pooled", s.equal ? value_of(s.pooled) : json(nullptr)},
                     {"z", finite(s.z)},
                     {"equal", s.equal}});
  }
  return array;
}

}  // namespace

json to_json(const Transfer& t) {
  json object{{"quantities", quantities_of(t.prediction, t.validation, true)},
              {"responses", responses_of(t.second, t.prediction, t.validation)},
              {"coverage", nullptr},
              {"area_metric", nullptr},
              {"holds", t.validation ? json(t.holds()) : json(nullptr)}};
  if (t.validation) put_validation(*t.validation, object);
  object["travels"] = effects_of(t.both.travels);
  object["stays"] = effects_of(t.both.stays);
  object["second_rig_only"] = effects_of(t.both.second_only);
  object["component_on_second_rig_only"] = effects_of(t.both.component_on_second_only);
  object["not_seen_on_second_rig"] = t.both.not_seen_on_second;
  object["shared"] = shared_of(t.both);
  object["posterior"] = posterior_of(t.posterior);
  object["excitation_overlap"] = {{"frequency", t.overlap.in_frequency}, {"travel", t.overlap.in_travel}};
  object["next_measurement"] = json::array();
  for (const NextMeasurement& next : t.next.list) {
    object["next_measurement"].push_back(
        {{"what", next.what}, {"component_band", next.remaining}, {"wheel_load_band", next.band}});
  }
  if (t.with_own) object["with_second_rigs_own_effects"] = alternative_of(t.second, *t.with_own, false);
  if (t.naive) object["naive"] = alternative_of(t.second, *t.naive, true);
  object["remarks"] = t.remarks;
  object["text"] = verdict_text(t);
  return object;
}

}  // namespace host_sim::transfer
