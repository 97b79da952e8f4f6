#include "host_sim/identification/prepare/recording_window.hpp"

namespace host_sim::identification {

firmware::Recording cut(const firmware::Recording& whole, Window window) {
  firmware::Recording part = whole.without_samples();
  const auto keep = [&](const auto& values, auto& kept) {
    if (values.empty()) return;
    kept.assign(values.begin() + static_cast<std::ptrdiff_t>(window.from),
                values.begin() + static_cast<std::ptrdiff_t>(window.to));
  };
  keep(whole.time, part.time);
  keep(whole.filled, part.filled);
  for (std::size_t c = 0; c < whole.channels.size(); ++c) keep(whole.channels[c], part.channels[c]);
  for (std::size_t j = 0; j < whole.ducts.size(); ++j) keep(whole.ducts[j], part.ducts[j]);
  return part;
}

}  // namespace host_sim::identification
