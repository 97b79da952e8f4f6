#include "firmware/description/text/spelling.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "firmware/description/text/input_error.hpp"

namespace firmware {
namespace {

/// Levenshtein distance: fewest insertions, deletions and substitutions that make one word the other.
std::size_t changes(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);  // of the table, one row at a time
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t changed = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const auto& candidate : known) {
    const std::size_t distance = changes(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

bool is_slip_of(std::string_view word, std::string_view meant) {
  return changes(word, meant) <= std::max<std::size_t>(1, meant.size() / 3);
}

std::string with_suggestion(std::string_view what, std::string_view word, std::span<const std::string_view> known) {
  return std::string(what) + " " + in_quotes(word) + " (did you mean " + in_quotes(nearest(word, known)) + "?)";
}

std::string listed(std::span<const std::string_view> words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

}  // namespace firmware
