#include "host_sim/identification/common/wording.hpp"

namespace host_sim::identification {

std::string words(const firmware::PlacedEffect& effect) {
  std::string text(effect.entry->name);
  if (effect.channel) text += " of " + std::string(model::name(*effect.channel));
  return text;
}

std::string joined(const std::vector<std::string>& list) {
  std::string text;
  for (std::size_t i = 0; i < list.size(); ++i)
    text += (i == 0 ? "" : (i + 1 == list.size() ? " and " : ", ")) + list[i];
  return text;
}

}  // namespace host_sim::identification
