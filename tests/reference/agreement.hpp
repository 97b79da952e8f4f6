// The reference beside the product on recordings whose answer is known.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/confusion/outcome.hpp"

namespace reference {

using Names = std::set<std::string>;

/// One recording and what is said of it: causes with a confidence above 0.5.
struct Compared {
  confusion::Asked asked;
  std::string hidden_words;  ///< with sizes
  Names hidden, product, reference;
  bool product_unexplained = false, reference_unexplained = false;
  double product_seconds = 0.0, reference_seconds = 0.0;

  [[nodiscard]] bool agree() const { return product == reference; }
};

/// Draws, simulates, and asks both. A product that ends or takes more than ten minutes says nothing.
[[nodiscard]] Compared compare(const confusion::Asked& asked, const truth::Wanted& wanted);

/// By kind of question: agreement, who is right; then a line for each disagreement.
[[nodiscard]] std::string text(const std::vector<Compared>& all);

/// Share of recordings on which both say the same.
[[nodiscard]] double agreement(const std::vector<Compared>& all);

}  // namespace reference
