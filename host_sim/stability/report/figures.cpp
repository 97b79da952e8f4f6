#include "host_sim/stability/report/figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/map/boundary.hpp"

namespace host_sim::stability {
namespace {

using report::Curve;
using report::Dash;
using report::Figure;
using report::Guide;
using report::HeatMap;
using report::Marker;
using report::Panel;

constexpr int black = 6;

const report::Axis frequency_axis{"frequency", "Hz", true};
const report::Axis real_axis{"real part", "1/s"};
const report::Axis imaginary_axis{"frequency of the root", "Hz"};
const Guide stability_border{Guide::Along::x, 0.0, "border"};

std::vector<double> scaled(const std::vector<double>& values, double factor) {
  std::vector<double> result(values);
  for (double& v : result) v *= factor;
  return result;
}

std::vector<double> axis_values_of(const stability::Axis& axis, double scale) {
  std::vector<double> values;
  for (std::size_t i = 0; i < axis.count; ++i) values.push_back(scale * axis.value(i));
  return values;
}

/// The parts of a boundary curve that are (or are not) stability borders, separated by gaps.
Curve boundary_part(const StabilityMap& map, bool border, double scale_x, double scale_y) {
  Curve part;
  part.name = border ? "stability border, exact" : "a further pair of roots on the axis";
  part.colour = black;
  part.dash = border ? Dash::solid : Dash::dotted;
  part.along_quantity = "frequency there";
  part.along_unit = "Hz";
  const double gap = std::numeric_limits<double>::quiet_NaN();
  bool connected = true;
  for (const BoundaryCurve& curve : map.boundary) {
    connected = connected && curve.connected;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const BoundaryPoint& p = curve.points[i];
      const bool beside = i > 0 && curve.points[i - 1].border == border;  // both parts share the point where they meet
      if (p.border != border && !beside) continue;
      part.x.push_back(scale_x * p.x);
      part.y.push_back(scale_y * p.y);
      part.along.push_back(p.omega / full_turn);
      if (p.border != border) {
        part.x.push_back(gap);
        part.y.push_back(gap);
        part.along.push_back(gap);
      }
    }
    part.x.push_back(gap);
    part.y.push_back(gap);
    part.along.push_back(gap);
  }
  if (!connected) {
    part.dash = Dash::none;
    part.marker = border ? Marker::circle : Marker::open_circle;
  }
  return part;
}

double given_value(const std::string& variable, const firmware::RigDescription& description, double delay) {
  if (variable == "tau") return delay;
  model::RigParameters<double> rig = description.rig;
  return parameter_of(rig, variable);
}

}  // namespace

ShownVariable shown(const std::string& variable, const model::RigParameters<double>& rig) {
  if (variable == "tau") return {"loop delay τ", "ms", 1e3};
  if (variable == "virtual_damping" || variable == "machine.virtual_damping") return {"virtual damping", "N s/m", 1.0};
  for (const firmware::ParameterPath& path : firmware::parameter_paths()) {
    if (variable == std::string(path.table) + "." + std::string(path.key)) {
      return {variable, std::string(path.unit), 1.0};
    }
  }
  ShownVariable result{variable, "SI", 1.0};
  for (const firmware::PlacedEffect& effect : firmware::effects_of(rig)) {
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      if (variable == firmware::effect_path(effect, i)) result.unit = effect.entry->parameters[i].unit;
    }
  }
  return result;
}

Figure bode_figure(std::string title, const std::string& quantity, const std::vector<double>& frequency_hz,
                   std::span<const NamedResponse> responses) {
  Figure figure{std::move(title), {}, frequency_axis};
  figure.x.range = {{frequency_hz.front(), frequency_hz.back()}};
  std::string unit = responses.front().curve->unit;
  if (unit == "m/s²/m") unit = "1/s²";
  Panel magnitude{{quantity, unit, true}}, phase{{"phase", "°"}};
  magnitude.share = 1.4;
  for (const NamedResponse& r : responses) {
    magnitude.curves.push_back({r.name, frequency_hz, r.curve->magnitude, r.colour, r.dash});
    phase.curves.push_back({r.name, frequency_hz, scaled(r.curve->phase, 360.0 / full_turn), r.colour, r.dash});
    phase.curves.back().in_legend = false;
  }
  figure.panels = {std::move(magnitude), std::move(phase)};
  figure.height = 560;
  return figure;
}

Figure nyquist_figure(std::string title, std::span<const NamedLoop> loops) {
  Figure figure{std::move(title), {}, {"Re L", "1"}};
  figure.equal_axes = true;
  figure.height = 560;
  figure.x.range = {{-2.6, 1.8}};
  Panel panel{{"Im L", "1"}};
  panel.y.range = {{-1.9, 1.9}};
  Curve circle{"unit circle", {}, {}, black, Dash::dotted};
  for (int i = 0; i <= 180; ++i) {
    circle.x.push_back(std::cos(full_turn * i / 180.0));
    circle.y.push_back(std::sin(full_turn * i / 180.0));
  }
  panel.curves.push_back(std::move(circle));
  int colour = 0;
  for (const NamedLoop& loop : loops) {
    Curve upper{loop.name, {}, {}, colour, Dash::solid},
        lower{loop.name + ", mirror image", {}, {}, colour, Dash::dashed};
    for (std::size_t i = 0; i < loop.data->loop.size(); ++i) {
      const Complex at = loop.data->loop[i];
      upper.x.push_back(at.real());
      upper.y.push_back(at.imag());
      lower.y.push_back(-at.imag());
      upper.along.push_back(loop.data->omega[i] / full_turn);
    }
    lower.x = upper.x;
    lower.along = upper.along;
    upper.along_quantity = lower.along_quantity = "frequency";
    upper.along_unit = lower.along_unit = "Hz";
    lower.in_legend = loops.size() == 1;
    panel.curves.push_back(std::move(upper));
    panel.curves.push_back(std::move(lower));
    ++colour;
  }
  Curve critical{"−1", {-1.0}, {0.0}, black, Dash::none, Marker::cross};
  panel.curves.push_back(std::move(critical));
  figure.panels = {std::move(panel)};
  return figure;
}

std::string encirclements_in_words(const NyquistData& data) {
  return "Encirclements of −1, counter-clockwise: " + report::figure_text(data.encirclements) +
         "; unstable poles of L: " + std::to_string(data.open_loop_unstable) +
         "; so unstable roots of the closed loop: " + std::to_string(data.closed_loop_unstable) + ".";
}

Figure root_figure(std::string title, const RootSet& roots) {
  Figure figure{std::move(title), {}, real_axis};
  Panel panel{imaginary_axis};
  Curve stable{"stable root", {}, {}, 0, Dash::none, Marker::circle},
      unstable{"unstable root", {}, {}, 1, Dash::none, Marker::cross};
  for (const Complex s : roots.roots) {
    Curve& side = s.real() < 0.0 ? stable : unstable;
    side.x.push_back(s.real());
    side.y.push_back(s.imag() / full_turn);
    side.along.push_back(std::abs(s) > 0.0 ? -100.0 * s.real() / std::abs(s) : 0.0);
  }
  for (Curve* side : {&stable, &unstable}) {
    side->along_quantity = "damping ratio";
    side->along_unit = "%";
    if (!side->x.empty()) panel.curves.push_back(std::move(*side));
  }
  panel.guides = {stability_border};
  double left = -1.0, right = 0.0, top = 0.0;
  for (const Complex s : roots.roots) {
    left = std::min(left, s.real());
    right = std::max(right, s.real());
    top = std::max(top, s.imag() / full_turn);
  }
  figure.x.range = {{left - 0.06 * (right - left), right + 0.06 * (right - left)}};
  panel.y.range = {{0.0, 1.1 * std::max(top, 0.1)}};
  figure.panels = {std::move(panel)};
  figure.height = 380;
  return figure;
}

Figure locus_figure(const PoleSweep& sweep, const firmware::RigDescription& description) {
  const ShownVariable variable = shown(sweep.axis.variable, description.rig);
  Figure figure{"Root locus over " + variable.quantity, {}, real_axis};
  Panel panel{imaginary_axis};
  Curve roots{"roots", {}, {}, 0, Dash::none, Marker::circle};
  roots.in_legend = false;
  Curve first{"at " + report::figure_text(variable.scale * sweep.axis.from) + " " + variable.unit,
              {},
              {},
              black,
              Dash::none,
              Marker::open_circle};
  Curve last{"at " + report::figure_text(variable.scale * sweep.axis.to) + " " + variable.unit,
             {},
             {},
             black,
             Dash::none,
             Marker::cross};
  for (std::size_t i = 0; i < sweep.axis.count; ++i) {
    for (const Complex s : sweep.roots[i]) {
      roots.x.push_back(s.real());
      roots.y.push_back(s.imag() / full_turn);
      roots.along.push_back(variable.scale * sweep.axis.value(i));
      for (Curve* end : {&first, &last}) {
        if (i != (end == &first ? 0 : sweep.axis.count - 1)) continue;
        end->x.push_back(s.real());
        end->y.push_back(s.imag() / full_turn);
      }
    }
  }
  roots.along_quantity = variable.quantity;
  roots.along_unit = variable.unit;
  roots.coloured_along = true;
  panel.curves = {std::move(roots), std::move(first), std::move(last)};
  panel.guides = {stability_border};
  figure.panels = {std::move(panel)};
  return figure;
}

Figure map_figure(const StabilityMap& map, const firmware::RigDescription& description, double delay) {
  const ShownVariable x = shown(map.x.variable, description.rig), y = shown(map.y.variable, description.rig);
  Figure figure{"Rightmost root over " + x.quantity + " and " + y.quantity, {}, {x.quantity, x.unit}};
  figure.x.range = {{x.scale * map.x.from, x.scale * map.x.to}};
  Panel panel{{y.quantity, y.unit}};
  panel.y.range = {{y.scale * map.y.from, y.scale * map.y.to}};

  HeatMap heat{"real part of the rightmost root", "1/s", axis_values_of(map.x, x.scale), axis_values_of(map.y, y.scale),
               map.rightmost};
  // The unstable side has large values; the colour range covers the region near the border.
  const double deepest = -*std::min_element(map.rightmost.begin(), map.rightmost.end());
  const double highest = *std::max_element(map.rightmost.begin(), map.rightmost.end());
  if (deepest > 0.0 && highest > 0.0) heat.limit = std::max(2.0 * deepest, 0.1 * highest);
  panel.heat_map = {std::move(heat)};
  for (const bool border : {true, false}) {
    Curve part = boundary_part(map, border, x.scale, y.scale);
    if (std::any_of(part.x.begin(), part.x.end(), [](double v) { return !std::isnan(v); })) {
      panel.curves.push_back(std::move(part));
    }
  }
  panel.curves.push_back({"this rig",
                          {x.scale * given_value(map.x.variable, description, delay)},
                          {y.scale * given_value(map.y.variable, description, delay)},
                          black,
                          Dash::none,
                          Marker::diamond});
  figure.panels = {std::move(panel)};
  figure.height = 520;
  return figure;
}

std::vector<Complex> followed(const PoleSweep& sweep, std::size_t start_index, Complex start) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Complex> path(sweep.axis.count, Complex(nan, nan));
  const auto walk = [&](std::size_t from, int step) {
    Complex last = start;
    for (std::size_t i = from; i < sweep.axis.count; i += static_cast<std::size_t>(step)) {  // wraps below 0: ends
      const auto& roots = sweep.roots[i];
      const auto nearest = std::min_element(
          roots.begin(), roots.end(), [&](Complex a, Complex b) { return std::abs(a - last) < std::abs(b - last); });
      if (nearest == roots.end() || std::abs(*nearest - last) > 0.2 * std::abs(last)) return;
      last = path[i] = *nearest;
    }
  };
  walk(start_index, 1);
  walk(start_index, -1);
  return path;
}

}  // namespace host_sim::stability
