#include "host_sim/identification/report/shape_words.hpp"

#include <cmath>
#include <cstddef>

#include "host_sim/report/report.hpp"

namespace host_sim::identification {

std::string shape_words(const firmware::PlacedEffect& effect, const model::RigParameters<double>& rig) {
  const model::Words& words = effect.entry->words;
  const auto figure = [&](std::size_t i) {
    const auto& of = words.figures[i].of;
    return of != nullptr ? of(effect.values.data(), rig.suspension.damping) : 0.0;
  };
  if (!std::isfinite(figure(0))) return "";
  const std::string_view text = figure(0) <= 0.0 && !words.otherwise.empty() ? words.otherwise : words.text;
  std::string said;
  std::size_t next = 0;
  for (const char letter : text) {
    if (letter != '#') {
      said += letter;
      continue;
    }
    const double value = words.otherwise.empty() ? figure(next) : std::abs(figure(next));
    said += report::figure_text(value, words.figures[next].digits);
    ++next;
  }
  return said;
}

}  // namespace host_sim::identification
