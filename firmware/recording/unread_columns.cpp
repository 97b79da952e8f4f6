#include "firmware/recording/unread_columns.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace firmware {

std::string unread_columns(const Recording& recording, model::Channel wanted) {
  constexpr std::size_t most = 4;
  const std::vector<std::string>& unread = recording.ignored_columns;
  if (unread.empty()) return {};
  std::string names;
  for (std::size_t i = 0; i < std::min(most, unread.size()); ++i) names += (i == 0 ? "" : ", ") + unread[i];
  if (unread.size() > most) names += " and " + std::to_string(unread.size() - most) + " more";
  return "; columns that are no channel: " + names + "; under [channels] " + std::string(model::name(wanted)) +
         " = { column = \"" + unread.front() + "\" } takes one";
}

}  // namespace firmware
