// Suggestions for misspelled words.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace firmware {

/// The word of `known` that is nearest to `word` (fewest insertions, deletions and substitutions).
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// Whether `word` is probably a misspelling of `meant`: at most one edit, or edits of a third of the letters of
/// `meant`.
[[nodiscard]] bool is_slip_of(std::string_view word, std::string_view meant);

/// "unknown key 'x' (did you mean 'y'?)" for a word that is not among the known ones.
[[nodiscard]] std::string with_suggestion(std::string_view what, std::string_view word,
                                          std::span<const std::string_view> known);

/// "a, b, c"
[[nodiscard]] std::string listed(std::span<const std::string_view> words);

}  // namespace firmware
