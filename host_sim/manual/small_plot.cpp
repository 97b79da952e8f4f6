#include "host_sim/manual/small_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "host_sim/report/report.hpp"

namespace host_sim::manual {
namespace {

// Lengths in units of the view box.
constexpr double width = 250.0, height = 112.0, left = 4.0, right = 246.0, top = 20.0, bottom = 96.0;

struct Scale {
  double lowest, highest;
  [[nodiscard]] double y(double value) const {
    const double span = highest > lowest ? highest - lowest : 1.0;
    return bottom - (bottom - top) * (value - lowest) / span;
  }
};

std::string path(std::span<const double> curve, const Scale& scale) {
  std::string points;
  const double step = (right - left) / static_cast<double>(std::max<std::size_t>(1, curve.size() - 1));
  for (std::size_t i = 0; i < curve.size(); ++i) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.1f,%.1f ", left + step * static_cast<double>(i), scale.y(curve[i]));
    points += text.data();
  }
  return points;
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  std::array<char, 96> place{};
  std::snprintf(place.data(), place.size(), "<text x=\"%.0f\" y=\"%.0f\" text-anchor=\"%s\">", x, y, anchor);
  return place.data() + report::escaped(text) + "</text>";
}

}  // namespace

std::string svg(const SmallPlot& plot) {
  if (plot.without.size() != plot.with.size() || plot.with.empty()) {
    throw std::logic_error("picture \"" + plot.title + "\": its curves differ in length or are empty");
  }
  Scale scale{plot.with.front(), plot.with.front()};
  for (const std::span<const double> curve : {plot.without, plot.with}) {
    for (const double value : curve) {
      if (!std::isfinite(value)) throw std::logic_error("picture \"" + plot.title + "\": a value is not finite");
      scale.lowest = std::min(scale.lowest, value);
      scale.highest = std::max(scale.highest, value);
    }
  }
  std::array<char, 160> head{};
  std::snprintf(head.data(), head.size(), "<svg class=\"small\" viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-label=\"",
                width, height);
  const std::string range =
      report::figure_text(scale.lowest, 3) + " … " + report::figure_text(scale.highest, 3) + " " + plot.unit;
  return head.data() + report::escaped(plot.title + ": " + plot.change) + "\">" +
         text_at(left, 13, "start", plot.title) + text_at(right, 13, "end", plot.change) +
         "<polyline class=\"without\" points=\"" + path(plot.without, scale) +
         "\"/><polyline class=\"with\" points=\"" + path(plot.with, scale) + "\"/>" +
         text_at(left, 109, "start", range) + text_at(right, 109, "end", report::figure_text(plot.duration, 2) + " s") +
         "</svg>";
}

}  // namespace host_sim::manual
