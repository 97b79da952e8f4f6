#include "host_sim/report/plotly.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace host_sim::report {
namespace {

using nlohmann::ordered_json;

[[noreturn]] void refuse(const Figure& figure, const std::string& why) {
  throw std::logic_error("figure \"" + figure.title + "\": " + why);
}

void check(const Figure& figure, const Axis& axis) {
  if (axis.quantity.empty()) refuse(figure, "an axis does not say what it shows");
  if (axis.unit.empty() && !axis.of_names) refuse(figure, "axis \"" + axis.quantity + "\" has no unit");
  if (axis.range && !(axis.range->first < axis.range->second)) {
    refuse(figure, "axis \"" + axis.quantity + "\" runs backwards");
  }
  if (axis.range && axis.logarithmic && !(axis.range->first > 0.0)) {
    refuse(figure, "logarithmic axis \"" + axis.quantity + "\" begins at or below zero");
  }
}

void check(const Figure& figure) {
  if (figure.title.empty()) refuse(figure, "it has no title");
  if (figure.panels.empty()) refuse(figure, "there is nothing in it");
  check(figure, figure.x);
  for (const Panel& panel : figure.panels) {
    check(figure, panel.y);
    if (panel.curves.empty() && panel.bars.empty() && panel.heat_map.empty()) {
      refuse(figure, "nothing to see over \"" + panel.y.quantity + "\"");
    }
    if (!panel.bars.empty() && !panel.y.of_names) refuse(figure, "bars stand along an axis that is not of names");
    for (const Curve& c : panel.curves) {
      if (c.name.empty()) refuse(figure, "a curve has no name");
      if (c.x.size() != c.y.size() || c.x.empty()) refuse(figure, "curve \"" + c.name + "\" has not as many x as y");
      for (const auto* more : {&c.along, &c.lower_error, &c.upper_error}) {
        if (!more->empty() && more->size() != c.x.size()) {
          refuse(figure, "curve \"" + c.name + "\" has not as many further values as points");
        }
      }
      if (!c.along.empty() && (c.along_quantity.empty() || c.along_unit.empty())) {
        refuse(figure, "what is along curve \"" + c.name + "\" has no name or no unit");
      }
      if (c.coloured_along && (c.along.empty() || c.marker == Marker::none)) {
        refuse(figure, "curve \"" + c.name + "\" is coloured along nothing, or has no markers to colour");
      }
    }
    for (const Bars& b : panel.bars) {
      if (b.names.size() != b.values.size() || b.names.empty()) refuse(figure, "bars without names, or names alone");
    }
    if (panel.heat_map.size() > 1) refuse(figure, "two heat maps in one panel");
    for (const HeatMap& m : panel.heat_map) {
      if (m.values.size() != m.x.size() * m.y.size() || m.values.empty()) {
        refuse(figure, "a heat map whose values do not fill its plane");
      }
      if (m.unit.empty() || m.quantity.empty()) refuse(figure, "a heat map without quantity or unit");
    }
  }
}

/// Six digits: enough to zoom into, a third of the bytes. NaN, a gap, is null.
ordered_json number(double value, int digits = 6) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return std::strtod(text.data(), nullptr);
}

ordered_json numbers(const std::vector<double>& values, int digits = 6) {
  ordered_json array = ordered_json::array();
  for (const double v : values) array.push_back(number(v, digits));
  return array;
}

std::string colour(int i) { return std::string(colours[static_cast<std::size_t>(i) % std::size(colours)]); }

constexpr std::array<const char*, 6> dash_names{"", "solid", "dash", "dot", "dashdot", ""};
constexpr std::array<const char*, 6> marker_names{"", "circle", "square", "diamond", "x", "circle-open"};

std::string with_unit(const Axis& axis) {
  return escaped(axis.quantity + (axis.of_names ? "" : axis.unit == "1" ? " [–]" : " [" + axis.unit + "]"));
}

/// The title of an upright axis `height` pixels long: on paper, where it has three quarters of them, it stands in two
/// lines where one would reach into the next panel's.
std::string upright_title(const Axis& axis, double height) {
  constexpr double letter = 7.0, on_paper = 0.75;  // [px] of 13 px text
  std::string text = axis.quantity + (axis.of_names ? "" : axis.unit == "1" ? " [–]" : " [" + axis.unit + "]");
  const auto letters = [](const std::string& part) {
    return static_cast<double>(std::count_if(part.begin(), part.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  };
  if (letter * letters(text) <= on_paper * height) return escaped(text);
  std::size_t best = std::string::npos;  // the blank nearest the middle
  const auto from_middle = [&](std::size_t at) {
    return std::abs(static_cast<double>(at) - 0.5 * static_cast<double>(text.size()));
  };
  for (std::size_t at = text.find(' '); at != std::string::npos; at = text.find(' ', at + 1)) {
    if (best == std::string::npos || from_middle(at) < from_middle(best)) best = at;
  }
  if (best == std::string::npos) return escaped(text);
  return escaped(text.substr(0, best)) + "<br>" + escaped(text.substr(best + 1));
}

/// Ticks of a logarithmic axis with more decades than labels have room for: every second, third … decade.
void space_decades(const Panel& panel, double height, ordered_json& axis) {
  if (!panel.y.logarithmic || !axis.contains("dtick")) return;
  double low = INFINITY, high = 0.0;
  for (const Curve& curve : panel.curves) {
    for (const double y : curve.y) {
      if (!(y > 0.0) || !std::isfinite(y)) continue;
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  if (!(high > low)) return;
  constexpr double line = 24.0;  // [px] of a label and the space around it, on paper too
  const double each = std::ceil(std::log10(high / low) * line / std::max(height, line));
  if (each < 2.0) return;
  axis["dtick"] = static_cast<int>(each);
  axis.erase("minor");
}

/// "<br>frequency 13.4 Hz" for a read-out
std::string reading(const std::string& quantity, const std::string& variable, const std::string& unit) {
  return "<br>" + escaped(quantity) + ": %{" + variable + ":.5g}" + (unit == "1" ? "" : " " + escaped(unit));
}

ordered_json axis_json(const Axis& axis) {
  ordered_json json = {{"title", {{"text", with_unit(axis)}, {"standoff", 10}}},
                       {"automargin", true},
                       {"showline", true},
                       {"mirror", true},
                       {"linecolor", "#444"},
                       {"ticks", "outside"},
                       {"gridcolor", "#e2e2e2"},
                       {"zerolinecolor", "#999"},
                       {"exponentformat", "power"}};
  if (axis.of_names) {
    json["type"] = "category";
    json["autorange"] = "reversed";  // the first name on top
    json["showgrid"] = false;
    return json;
  }
  if (axis.logarithmic) {
    json["type"] = "log";
    if (axis.unit == "Hz") {  // 0.1 1 10 100 rather than powers of ten
      json["tickvals"] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500};
      json["ticktext"] = {"0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1",  "2",
                          "5",    "10",   "20",   "50",  "100", "200", "500"};
    } else {
      json["dtick"] = 1;
      json["minor"] = {{"ticks", "outside"}, {"ticklen", 3}, {"showgrid", true}, {"gridcolor", "#f0f0f0"}};
    }
  } else {
    json["type"] = "linear";
    if (axis.unit == "°") json["nticks"] = 7;
  }
  if (axis.range) {
    const auto at = [&](double value) { return number(axis.logarithmic ? std::log10(value) : value); };
    json["range"] = {at(axis.range->first), at(axis.range->second)};
  }
  return json;
}

/// What tells a curve from others of its panel.
struct Look {
  int hue;
  Dash dash;
  Marker marker;
  friend bool operator==(const Look&, const Look&) = default;
};

constexpr int hues = static_cast<int>(std::size(colours));

/// The look of each curve of a panel: as wished, but where two named curves would look alike, the later one takes the
/// next dash, and the next marker where there is no line.
std::vector<Look> looks_of(const Panel& panel, int turn) {
  std::vector<Look> looks;
  for (const Curve& c : panel.curves) {
    const int hue = c.colour >= 0 ? c.colour : turn++;
    Look look{hue % hues, c.dash == Dash::by_turns ? static_cast<Dash>(1 + hue % 4) : c.dash, c.marker};
    const auto taken = [&] {
      for (std::size_t i = 0; i < looks.size(); ++i) {
        if (looks[i] == look && panel.curves[i].name != c.name) return true;
      }
      return false;
    };
    for (int tried = 0; tried < 4 && taken(); ++tried) {
      if (look.dash == Dash::none) {
        look.marker = static_cast<Marker>(1 + static_cast<int>(look.marker) % 5);
      } else {
        look.dash = static_cast<Dash>(1 + static_cast<int>(look.dash) % 4);
      }
    }
    looks.push_back(look);
  }
  return looks;
}

ordered_json curve_json(const Figure& figure, const Panel& panel, const Curve& c, const Look& look) {
  const int hue = look.hue;
  const Dash dash = look.dash;
  const bool lines = dash != Dash::none;
  const bool markers = look.marker != Marker::none;
  ordered_json trace = {{"type", "scatter"},
                        {"name", escaped(c.name)},
                        {"mode", lines ? (markers ? "lines+markers" : "lines") : "markers"},
                        {"x", numbers(c.x)},
                        {"y", numbers(c.y)},
                        {"showlegend", c.in_legend}};
  if (lines)
    trace["line"] = {{"color", colour(hue)},
                     {"dash", dash_names[static_cast<std::size_t>(dash)]},
                     {"width", 2},
                     {"simplify", false}};
  if (markers) {
    trace["marker"] = {
        {"symbol", marker_names[static_cast<std::size_t>(look.marker)]}, {"size", 7}, {"color", colour(hue)}};
    if (look.marker == Marker::open_circle) trace["marker"]["line"] = {{"width", 1.5}};
  }
  if (c.coloured_along) {
    trace["marker"]["color"] = numbers(c.along);
    trace["marker"]["colorscale"] = "Viridis";
    trace["marker"]["showscale"] = true;
    trace["marker"]["colorbar"] = {
        {"title", {{"text", with_unit({c.along_quantity, c.along_unit})}, {"side", "right"}}}, {"thickness", 14}};
  }
  if (!c.upper_error.empty()) {
    trace["error_y"] = {{"type", "data"},
                        {"symmetric", false},
                        {"array", numbers(c.upper_error, 4)},
                        {"arrayminus", numbers(c.lower_error.empty() ? c.upper_error : c.lower_error, 4)},
                        {"thickness", 1},
                        {"width", 2}};
  }
  std::string read_out = "<b>" + escaped(c.name) + "</b>" + reading(figure.x.quantity, "x", figure.x.unit) +
                         reading(panel.y.quantity, "y", panel.y.unit);
  if (!c.along.empty()) {
    trace["customdata"] = numbers(c.along);
    read_out += reading(c.along_quantity, "customdata", c.along_unit);
  }
  trace["hovertemplate"] = read_out + "<extra></extra>";
  return trace;
}

/// Breaks a label at a blank about every 28 letters, so that the bars keep their room.
std::string in_lines(const std::string& name) {
  std::string lines;
  std::size_t length = 0;
  for (const char c : escaped(name)) {
    if (c == ' ' && length > 28) {
      lines += "<br>";
      length = 0;
    } else {
      lines += c;
      ++length;
    }
  }
  return lines;
}

ordered_json bars_json(const Figure& figure, const Bars& bars, int turn) {
  ordered_json names = ordered_json::array(), texts = ordered_json::array();
  for (const std::string& name : bars.names) names.push_back(in_lines(name));
  for (const double v : bars.values) texts.push_back(figure_text(v, 3));
  return {{"type", "bar"},
          {"orientation", "h"},
          {"name", escaped(bars.name)},
          {"y", std::move(names)},
          {"x", numbers(bars.values)},
          {"text", std::move(texts)},
          {"textposition", "auto"},
          {"textangle", 0},
          {"cliponaxis", false},
          {"marker", {{"color", colour(bars.colour >= 0 ? bars.colour : turn)}}},
          {"showlegend", !bars.name.empty()},
          {"hovertemplate", "<b>%{y}</b>" + reading(figure.x.quantity, "x", figure.x.unit) + "<extra></extra>"}};
}

ordered_json heat_map_json(const Figure& figure, const Panel& panel, const HeatMap& map) {
  ordered_json rows = ordered_json::array();
  double largest = 0.0;
  for (std::size_t iy = 0; iy < map.y.size(); ++iy) {
    ordered_json row = ordered_json::array();
    for (std::size_t ix = 0; ix < map.x.size(); ++ix) {
      const double value = map.values[iy * map.x.size() + ix];
      row.push_back(number(value, 4));
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
    rows.push_back(std::move(row));
  }
  const double limit = map.limit > 0.0 ? map.limit : std::max(largest, 1e-12);
  return {
      {"type", "heatmap"},
      {"x", numbers(map.x)},
      {"y", numbers(map.y)},
      {"z", std::move(rows)},
      {"zmin", number(-limit)},
      {"zmax", number(limit)},
      {"zsmooth", "fast"},
      {"colorscale", {{0.0, "#0072B2"}, {0.5, "#ffffff"}, {1.0, "#D55E00"}}},
      {"colorbar", {{"title", {{"text", with_unit({map.quantity, map.unit})}, {"side", "right"}}}, {"thickness", 14}}},
      {"hovertemplate", reading(figure.x.quantity, "x", figure.x.unit).substr(4) +
                            reading(panel.y.quantity, "y", panel.y.unit) + reading(map.quantity, "z", map.unit) +
                            "<extra></extra>"}};
}

std::string axis_name(const char* letter, std::size_t i) { return letter + (i == 0 ? "" : std::to_string(i + 1)); }

/// A guide line and its label: [shape, annotation].
std::pair<ordered_json, ordered_json> guide_json(const Figure& figure, const Panel& panel, const std::string& y,
                                                 const Guide& guide) {
  const bool upright = guide.along == Guide::Along::x;
  const Axis& along = upright ? figure.x : panel.y;
  const double at = along.logarithmic ? std::log10(guide.value) : guide.value;
  ordered_json line = {{"type", "line"},
                       {"xref", upright ? "x" : "x domain"},
                       {"yref", upright ? y + " domain" : y},
                       {"line", {{"color", "#555"}, {"width", 1}, {"dash", "dot"}}}};
  ordered_json label = {{"text", escaped(guide.label)},
                        {"showarrow", false},
                        {"font", {{"size", 12}, {"color", "#333"}}},
                        {"bgcolor", "rgba(255,255,255,0.75)"},
                        {"xref", upright ? "x" : "x domain"},
                        {"yref", upright ? y + " domain" : y}};
  if (upright) {
    line["x0"] = line["x1"] = number(guide.value);
    line["y0"] = 0;
    line["y1"] = 1;
    label["x"] = number(at);
    label["y"] = 0.5;
    label["textangle"] = -90;
    label["xanchor"] = "right";
    label["yanchor"] = "middle";
  } else {
    line["y0"] = line["y1"] = number(guide.value);
    line["x0"] = 0;
    line["x1"] = 1;
    label["y"] = number(at);
    label["x"] = 1.0;
    label["xanchor"] = "right";
    label["yanchor"] = "bottom";
  }
  return {std::move(line), std::move(label)};
}

/// The layout of the whole figure, without its axes.
ordered_json layout_json(const Figure& figure) {
  std::size_t named = 0;  // in the legend, which stands under the buttons
  for (const Panel& panel : figure.panels) {
    named += panel.curves.size();
    for (const Curve& curve : panel.curves) named -= curve.in_legend ? 0U : 1U;
  }
  return {
      {"height", figure.height},
      {"font",
       {{"family", "system-ui, \"Segoe UI\", \"DejaVu Sans\", Arial, sans-serif"}, {"size", 13}, {"color", "#222"}}},
      {"paper_bgcolor", "#fff"},
      {"plot_bgcolor", "#fff"},
      {"hovermode", "closest"},
      {"hoverlabel", {{"namelength", -1}, {"bgcolor", "#fff"}}},
      {"legend", {{"orientation", "h"}, {"x", 0}, {"y", 1.02}, {"yanchor", "bottom"}}},
      {"margin", {{"l", 70}, {"r", 20}, {"t", named > 5 ? 72 : 52}, {"b", 50}}}};
}

/// In an HTML script element only "<" can start the end tag.
std::string script_safe(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

std::string plotly_json(const Figure& figure) {
  check(figure);
  ordered_json data = ordered_json::array(), shapes = ordered_json::array(), notes = ordered_json::array();
  ordered_json layout = layout_json(figure);
  double shares = 0.0;
  for (const Panel& panel : figure.panels) shares += panel.share;
  const double gap = figure.panels.size() > 1 ? std::min(0.05, 28.0 / figure.height) : 0.0;
  const double height = 1.0 - gap * static_cast<double>(figure.panels.size() - 1);
  double top = 1.0;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    const std::string y = axis_name("y", i);
    ordered_json axis = axis_json(panel.y);
    const double bottom = std::max(0.0, top - height * panel.share / shares);
    axis["domain"] = {bottom, top};
    space_decades(panel, (top - bottom) * (figure.height - 110), axis);
    axis["title"]["text"] = upright_title(panel.y, (top - bottom) * (figure.height - 110));
    top = bottom - gap;
    if (figure.equal_axes) {
      axis["automargin"] = false;  // with a fixed ratio, margins and axes would chase each other
      axis["scaleanchor"] = "x";
      axis["scaleratio"] = 1;
    }
    layout[axis_name("yaxis", i)] = std::move(axis);

    int turn = 0;
    const auto add = [&](ordered_json trace) {
      trace["yaxis"] = y;
      data.push_back(std::move(trace));
    };
    for (const HeatMap& map : panel.heat_map) add(heat_map_json(figure, panel, map));
    for (const Bars& bars : panel.bars) add(bars_json(figure, bars, turn++));
    const std::vector<Look> looks = looks_of(panel, turn);
    for (std::size_t c = 0; c < panel.curves.size(); ++c) {
      add(curve_json(figure, panel, panel.curves[c], looks[c]));
    }
    for (const Guide& guide : panel.guides) {
      auto [line, label] = guide_json(figure, panel, y, guide);
      shapes.push_back(std::move(line));
      if (!guide.label.empty()) notes.push_back(std::move(label));
    }
  }
  ordered_json x = axis_json(figure.x);
  x["anchor"] = axis_name("y", figure.panels.size() - 1);
  x["mirror"] = "all";  // closes the frame of every panel, not of the lowest alone
  if (figure.equal_axes) {
    x["constrain"] = "domain";
    x["automargin"] = false;
  }
  layout["xaxis"] = std::move(x);
  if (!shapes.empty()) layout["shapes"] = std::move(shapes);
  if (!notes.empty()) layout["annotations"] = std::move(notes);

  return script_safe(ordered_json({{"data", std::move(data)}, {"layout", std::move(layout)}})
                         .dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

}  // namespace host_sim::report
