#include "host_sim/manual/small_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "host_sim/report/report.hpp"

namespace host_sim::manual {
namespace {

// Lengths in units of the view box.
constexpr double width = 250.0, height = 150.0, left = 4.0, right = 246.0;
constexpr double top = 20.0, middle = 80.0;               ///< of the two curves
constexpr double lower_top = 98.0, lower_bottom = 134.0;  ///< of their difference

/// Values from `lowest` to `highest` between two heights of the picture.
struct Scale {
  double lowest, highest, upper_end, lower_end;

  Scale(double first, double above, double below) : lowest(first), highest(first), upper_end(above), lower_end(below) {}
  void include(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  [[nodiscard]] double y(double value) const {
    const double span = highest > lowest ? highest - lowest : 1.0;
    return lower_end - (lower_end - upper_end) * (value - lowest) / span;
  }
  [[nodiscard]] std::string range(const std::string& unit) const {
    return report::figure_text(lowest, 3) + " … " + report::figure_text(highest, 3) + " " + unit;
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
  Scale scale(plot.with.front(), top, middle), lower(0.0, lower_top, lower_bottom);
  std::vector<double> difference;
  for (std::size_t i = 0; i < plot.with.size(); ++i) {
    if (!std::isfinite(plot.with[i]) || !std::isfinite(plot.without[i])) {
      throw std::logic_error("picture \"" + plot.title + "\": a value is not finite");
    }
    scale.include(plot.with[i]);
    scale.include(plot.without[i]);
    difference.push_back(plot.with[i] - plot.without[i]);
    lower.include(difference.back());
  }
  std::array<char, 160> head{};
  std::snprintf(head.data(), head.size(), "<svg class=\"small\" viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-label=\"",
                width, height);
  const auto line = [](const char* kind, const std::string& points) {
    return std::string("<polyline class=\"") + kind + "\" points=\"" + points + "\"/>";
  };
  return head.data() + report::escaped(plot.title + ": " + plot.change) + "\">" +
         text_at(left, 13, "start", plot.title) + text_at(right, 13, "end", plot.change) +
         line("without", path(plot.without, scale)) + line("with", path(plot.with, scale)) +
         text_at(left, 92, "start", scale.range(plot.unit)) +
         text_at(right, 92, "end", report::figure_text(plot.duration, 2) + " s") +
         line("difference", path(difference, lower)) +
         text_at(left, 146, "start", "difference " + lower.range(plot.unit)) + "</svg>";
}

}  // namespace host_sim::manual
