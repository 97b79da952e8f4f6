// Stability results as figures of a report.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/report/report.hpp"
#include "host_sim/stability/map/stability_map.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"

namespace host_sim::stability {

/// Magnitude over phase, against frequency. All curves have one unit.
struct NamedResponse {
  std::string name;
  const ResponseCurve* curve;
  int colour;
  report::Dash dash = report::Dash::solid;
};
[[nodiscard]] report::Figure bode_figure(std::string title, const std::string& quantity,
                                         const std::vector<double>& frequency_hz,
                                         std::span<const NamedResponse> responses);

/// L(jω) with its mirror image, the unit circle and −1, equal axes. The first view shows the region around −1 and the
/// circle.
struct NamedLoop {
  std::string name;
  const NyquistData* data;
};
[[nodiscard]] report::Figure nyquist_figure(std::string title, std::span<const NamedLoop> loops);

/// The Nyquist count as a sentence: encirclements, unstable poles, unstable roots.
[[nodiscard]] std::string encirclements_in_words(const NyquistData& data);

/// Roots with Im ≥ 0 in the plane Re [1/s], frequency [Hz].
[[nodiscard]] report::Figure root_figure(std::string title, const RootSet& roots);

/// All roots of a sweep in that plane, coloured by the variable.
[[nodiscard]] report::Figure locus_figure(const PoleSweep& sweep, const firmware::RigDescription& description);

/// The real part of the rightmost root over the plane, the exact boundary, and the operating point of the rig.
[[nodiscard]] report::Figure map_figure(const StabilityMap& map, const firmware::RigDescription& description,
                                        double delay);

/// One root of a sweep, continued from value to value by the smallest distance; NaN where the sweep no longer lists it.
[[nodiscard]] std::vector<Complex> followed(const PoleSweep& sweep, std::size_t start_index, Complex start);

/// A variable of a sweep or map as an axis shows it: quantity, unit, and the factor from SI to that unit.
struct ShownVariable {
  std::string quantity, unit;
  double scale = 1.0;
};
[[nodiscard]] ShownVariable shown(const std::string& variable, const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
