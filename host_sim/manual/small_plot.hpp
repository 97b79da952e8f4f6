// A small picture of two curves, as SVG inside of a page.
#pragma once

#include <span>
#include <string>

namespace host_sim::manual {

/// What a channel shows without and with an effect.
struct SmallPlot {
  std::string title;                  ///< above the picture, left
  std::string change;                 ///< above the picture, right
  std::string unit;                   ///< of both curves
  double duration = 0.0;              ///< of the curves [s]
  std::span<const double> without{};  ///< grey, broad, behind
  std::span<const double> with{};     ///< blue, thin, before
};

/// One <svg> element. Both curves have the same scale; below them, in a scale of its own, stands their difference. The
/// extremes of both scales stand beside them. Curves of different lengths,
/// empty ones and values that are not finite are a std::logic_error.
[[nodiscard]] std::string svg(const SmallPlot& plot);

}  // namespace host_sim::manual
