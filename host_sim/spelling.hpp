// Words that were meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace host_sim {

/// The word of `known` that is nearest to `word` (fewest insertions, deletions and substitutions).
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// Whether few enough changes make one word the other for it to be a slip: one, or a third of what was meant.
[[nodiscard]] bool is_slip_of(std::string_view word, std::string_view meant);

/// "unknown key 'x' (did you mean 'y'?)" for a word that is not among the known ones.
[[nodiscard]] std::string with_suggestion(std::string_view what, std::string_view word,
                                          std::span<const std::string_view> known);

/// "a, b, c"
[[nodiscard]] std::string listed(std::span<const std::string_view> words);

}  // namespace host_sim
