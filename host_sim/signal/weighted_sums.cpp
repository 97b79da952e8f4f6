#include "host_sim/signal/weighted_sums.hpp"

#include "host_sim/signal/wide.hpp"

namespace host_sim {

RIGTWIN_WIDE void add_weighted_sums(const double* weights, std::size_t taps, const double* values, double* sums,
                                    std::size_t count) {
  constexpr std::size_t piece = 1024;  // stays in the first-level cache
  for (std::size_t first = 0; first < count; first += piece) {
    const std::size_t last = first + piece < count ? first + piece : count;
    for (std::size_t i = 0; i < taps; ++i) {
      const double w = weights[i];
      const double* const moved = values + i;
      for (std::size_t k = first; k < last; ++k) sums[k] += w * moved[k];
    }
  }
}

}  // namespace host_sim
