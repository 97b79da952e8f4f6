#include "host_sim/stability/report/json.hpp"

#include <cmath>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::stability {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json number(const std::optional<double>& value) { return value ? number(*value) : ordered_json(nullptr); }

ordered_json complex(Complex s) { return {{"re", s.real()}, {"im", s.imag()}}; }

ordered_json complex_list(const std::vector<Complex>& list) {
  ordered_json array = ordered_json::array();
  for (const Complex s : list) array.push_back(complex(s));
  return array;
}

ordered_json gain(const std::optional<GainMargin>& margin) {
  if (!margin) return nullptr;
  return {{"factor", margin->factor},
          {"db", 20.0 * std::log10(margin->factor)},
          {"frequency_hz", margin->omega / full_turn}};
}

ordered_json amplitude_json(const AtAmplitude& at) {
  const auto force = [](const EquivalentForce& f) {
    return ordered_json{{"stiffness", number(f.stiffness)}, {"damping", number(f.damping)}};
  };
  return {{"amplitude", at.amplitude},
          {"frequency_hz", at.omega / full_turn},
          {"suspension", force(at.suspension)},
          {"tyre", force(at.tyre)},
          {"rightmost", complex(at.root)},
          {"stable", at.stable()},
          {"critical_delay", number(at.critical_delay)}};
}

ordered_json axis_json(const Axis& axis) {
  return {{"variable", axis.variable}, {"from", axis.from}, {"to", axis.to}, {"count", axis.count}};
}

ordered_json sampled_json(const StabilityAnalysis& a) {
  if (!a.sampled) return nullptr;
  const auto& sampled = a.sampled;
  ordered_json modes = ordered_json::array();
  for (std::size_t i = 0; i < sampled->eigenvalues.size() && i < 8; ++i)
    modes.push_back(complex(sampled->eigenvalues[i]));
  ordered_json json{
      {"stable", sampled->stable()},
      {"spectral_radius", sampled->spectral_radius},
      {"period", sampled->period},
      {"states", sampled->states},
      {"critical_delay", number(sampled->critical_delay)},
      {"added_delay", number(sampled->added_delay)},
      {"delay_margin", number(a.delay_left)},
      {"critical_virtual_damping", a.sampled_damping ? number(a.sampled_damping->value) : ordered_json(nullptr)}};
  if (const auto& m = a.sampled_margins) {
    json["gain_margin"] = {{"upper", gain(m->upper_gain)}, {"lower", gain(m->lower_gain)}};
    json["phase_margin_deg"] = m->phase_margin ? number(*m->phase_margin * 360.0 / full_turn) : ordered_json(nullptr);
    json["sensitivity_peak"] = {{"value", number(m->sensitivity.value)},
                                {"frequency_hz", m->sensitivity.omega / full_turn}};
  }
  json["eigenvalues"] = std::move(modes);
  return json;
}

ordered_json curve_json(const ResponseCurve& curve) {
  return {{"unit", curve.unit}, {"magnitude", curve.magnitude}, {"phase_rad", curve.phase}};
}

}  // namespace

ordered_json to_json(const StabilityAnalysis& a, const firmware::RigDescription& description) {
  ordered_json json;
  json["stable"] = a.stable_as_run();
  json["roots"] = complex_list(a.roots.roots);
  json["rightmost"] = complex(a.roots.rightmost());
  json["critical_delay"] = number(a.margins.critical_delay);
  json["critical_virtual_damping"] = a.critical_damping ? number(a.critical_damping->value) : ordered_json(nullptr);
  json["critical_frequency_hz"] =
      a.margins.critical_delay ? number(a.margins.critical_omega / full_turn) : ordered_json(nullptr);
  json["sampled"] = sampled_json(a);
  json["stable_without_sampling"] = a.stable;
  json["stable_over_delays"] = a.stable_over_delays();
  json["delay_left"] = number(a.delay_left);
  json["pade"] = ordered_json::array();
  for (const PadeResult& p : a.pade) {
    json["pade"].push_back({{"order", p.order},
                            {"critical_delay", number(p.critical_delay)},
                            {"error", number(p.error)},
                            {"unsafe", p.unsafe}});
  }
  json["kind"] = "hil";
  json["delay"] = a.delay;
  json["virtual_damping"] = description.rig.machine.virtual_damping;
  json["roots_right_of"] = a.roots.line;
  json["root_count"] = a.roots.count;
  json["worst_residual_in_roundings"] = a.roots.worst_residual;
  json["delay_margin"] = number(a.margins.delay_margin);
  json["gain_margin"] = {{"upper", gain(a.margins.upper_gain)}, {"lower", gain(a.margins.lower_gain)}};
  json["phase_margin_deg"] =
      a.margins.phase_margin ? number(*a.margins.phase_margin * 360.0 / full_turn) : ordered_json(nullptr);
  json["phase_margin_frequency_hz"] =
      a.margins.phase_margin ? number(a.margins.phase_margin_omega / full_turn) : ordered_json(nullptr);
  json["sensitivity_peak"] = {{"value", number(a.sensitivity.value)},
                              {"frequency_hz", a.sensitivity.omega / full_turn}};
  json["stable_delays"] = ordered_json::array();
  for (const StableRange& range : a.margins.stable_delays) json["stable_delays"].push_back({range.from, range.to});
  json["virtual_dampings_on_axis"] = ordered_json::array();
  for (const AxisValue& v : a.virtual_dampings) {
    json["virtual_dampings_on_axis"].push_back(
        {{"virtual_damping", v.value}, {"frequency_hz", v.omega / full_turn}, {"border", v.border}});
  }
  json["critical_root"] = {{"re", a.critical_root.real()}, {"im", a.critical_root.imag()}};
  json["sensitivities"] = ordered_json::array();
  for (const ParameterSensitivity& s : a.parameters) {
    json["sensitivities"].push_back({{"parameter", s.path},
                                     {"value", s.value},
                                     {"rightmost_re", s.root_change.real()},
                                     {"rightmost_im", s.root_change.imag()},
                                     {"critical_re", s.critical_root_change.real()},
                                     {"critical_im", s.critical_root_change.imag()},
                                     {"critical_delay", number(s.critical_delay_change)},
                                     {"error", number(s.error)}});
  }
  ordered_json parts = ordered_json::array();
  for (const DelayPart& part : a.balance.parts) {
    parts.push_back({{"name", part.name}, {"delay", part.seconds}, {"in_loop_delay", part.in_loop_delay}});
  }
  json["delay_budget"] = {{"parts", std::move(parts)}, {"total", a.balance.total}, {"left", number(a.balance.left)}};
  if (a.varying) {
    const double range = a.varying->highest - a.varying->lowest;
    json["varying_delay"] = {{"lowest", a.varying->lowest},
                             {"highest", a.varying->highest},
                             {"stable", a.stable_over_delays()},
                             {"stable_without_sampling", a.varying->stable},
                             {"worst_delay", a.varying->worst_delay},
                             {"worst_root", complex(a.varying->worst_root)},
                             {"at_any_speed", number(a.varying->at_any_speed)},
                             {"stable_at_any_speed", a.varying->stable_at_any_speed()}};
    if (const auto& s = a.sampled_over_delays) {
      json["varying_delay"]["stable_at_any_speed"] = s->stable_at_any_speed(range);
      json["varying_delay"]["sampled"] = {{"stable", s->stable},
                                          {"worst_delay", s->worst_delay + a.rig.sensor_delay},
                                          {"spectral_radius", s->worst_radius},
                                          {"at_any_speed", number(s->at_any_speed)}};
    }
  }
  const auto located = [](const LocatedBorder& border) {
    return ordered_json{{"stable_undelayed", border.stable_undelayed},
                        {"critical_delay", number(border.critical_delay)},
                        {"frequency_hz", border.omega / full_turn}};
  };
  json["interface_locations"] = ordered_json::array();
  for (const LocationMap& map : a.locations) {
    ordered_json entry{{"hardware", interface_names[static_cast<std::size_t>(map.location)]},
                       {"given", located(map.given)}};
    entry["component_factors"] = component_factors;
    entry["borders"] = ordered_json::array();
    for (const LocatedBorder& border : map.borders) entry["borders"].push_back(located(border));
    json["interface_locations"].push_back(std::move(entry));
  }
  json["sides_of_rest"] = ordered_json::array();
  for (const FoundOnSide& side : a.sides) {
    json["sides_of_rest"].push_back(
        {{"side", side.name}, {"stable", side.stable}, {"delay_left", number(side.delay_left)}});
  }
  json["left_out"] = a.rig.left_out;
  json["outside_loop"] = a.rig.outside_loop;
  return json;
}

ordered_json to_json(const StabilityMap& map) {
  ordered_json rows = ordered_json::array();
  for (std::size_t iy = 0; iy < map.y.count; ++iy) {
    const auto begin = map.rightmost.begin() + static_cast<std::ptrdiff_t>(iy * map.x.count);
    rows.push_back(std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(map.x.count)));
  }
  ordered_json curves = ordered_json::array();
  for (const BoundaryCurve& curve : map.boundary) {
    ordered_json x = ordered_json::array(), y = ordered_json::array(), hz = ordered_json::array(),
                 border = ordered_json::array();
    for (const BoundaryPoint& p : curve.points) {
      x.push_back(p.x);
      y.push_back(p.y);
      hz.push_back(p.omega / full_turn);
      border.push_back(p.border);
    }
    curves.push_back({{"connected", curve.connected},
                      {"x", std::move(x)},
                      {"y", std::move(y)},
                      {"frequency_hz", std::move(hz)},
                      {"border", std::move(border)}});
  }
  return {{"x", axis_json(map.x)},
          {"y", axis_json(map.y)},
          {"rightmost_re", std::move(rows)},
          {"boundary", std::move(curves)}};
}

ordered_json to_json(const PoleSweep& sweep) {
  ordered_json values = ordered_json::array(), roots = ordered_json::array();
  for (std::size_t i = 0; i < sweep.axis.count; ++i) {
    values.push_back(sweep.axis.value(i));
    roots.push_back(complex_list(sweep.roots[i]));
  }
  return {{"variable", sweep.axis.variable}, {"values", std::move(values)}, {"roots", std::move(roots)}};
}

ordered_json to_json(const BodeData& data) {
  ordered_json outputs = ordered_json::object();
  for (const ResponseCurve& curve : data.outputs) outputs[curve.name] = curve_json(curve);
  return {{"frequency_hz", data.frequency_hz},
          {"loop", curve_json(data.loop)},
          {"input", "z_r"},
          {"outputs", std::move(outputs)}};
}

ordered_json to_json(const NyquistData& data) {
  ordered_json re = ordered_json::array(), im = ordered_json::array(), hz = ordered_json::array();
  for (std::size_t i = 0; i < data.loop.size(); ++i) {
    hz.push_back(data.omega[i] / full_turn);
    re.push_back(data.loop[i].real());
    im.push_back(data.loop[i].imag());
  }
  return {{"offset", data.offset},
          {"encirclements", data.encirclements},
          {"open_loop_unstable", data.open_loop_unstable},
          {"closed_loop_unstable", data.closed_loop_unstable},
          {"frequency_hz", std::move(hz)},
          {"re", std::move(re)},
          {"im", std::move(im)}};
}

ordered_json to_json(const OverAmplitude& over) {
  ordered_json rows = ordered_json::array(), cycles = ordered_json::array();
  for (const AtAmplitude& at : over.rows) rows.push_back(amplitude_json(at));
  for (const LimitCycle& cycle : over.limit_cycles) {
    cycles.push_back({{"attracts", cycle.attracts}, {"at", amplitude_json(cycle.at)}});
  }
  return {{"rows", std::move(rows)}, {"limit_cycles", std::move(cycles)}, {"left_out", over.left_out}};
}

}  // namespace host_sim::stability
