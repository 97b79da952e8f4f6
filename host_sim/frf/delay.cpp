#include "host_sim/frf/delay.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "host_sim/frf/estimators.hpp"

namespace host_sim::frf {

double window_match(std::span<const double> window, std::ptrdiff_t shift) {
  const auto distance = static_cast<std::size_t>(std::abs(shift));
  if (distance >= window.size()) return 0.0;
  const double power = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
  return std::inner_product(window.begin() + static_cast<std::ptrdiff_t>(distance), window.end(), window.begin(), 0.0) /
         power;
}

std::optional<std::ptrdiff_t> find_delay(const CrossSpectra& spectra, std::size_t channel) {
  const std::size_t length = 2 * (spectra.lines() - 1);
  const double bias = 1.0 / spectra.effective_averages();
  if (!(bias < 1.0)) return std::nullopt;

  // Σ ψ_k e^{∓jω_k d} from the transforms of the real and imaginary parts of ψ.
  std::vector<double> real(length), imaginary(length);
  double squares = 0.0;
  for (std::size_t k = 1; k + 1 < spectra.lines(); ++k) {
    const Complex cross = spectra.cross(0, channel, k);
    const double raw = coherence(spectra.power(0, k), spectra.power(channel, k), cross);
    const double gamma2 = std::clamp((raw - bias) / (1.0 - bias), 0.0, 0.99);
    if (!(gamma2 > 0.0)) continue;
    const double weight = gamma2 / (1.0 - gamma2);
    const Complex phasor = weight / std::abs(cross) * cross;
    real[k] = phasor.real();
    imaginary[k] = phasor.imag();
    squares += weight * weight;
  }
  RealTransform transform(length);
  const std::span<const Complex> of_real = transform(real);
  const std::vector<Complex> a(of_real.begin(), of_real.end());
  const std::span<const Complex> b = transform(imaginary);

  std::ptrdiff_t best = 0;
  double highest = 0.0;
  const std::size_t farthest = length / 4;
  for (std::size_t d = 0; d <= farthest; ++d) {
    const double early = std::norm(a[d] + Complex(-b[d].imag(), b[d].real()));           // a + j b
    const double late = std::norm(std::conj(a[d]) + Complex(b[d].imag(), b[d].real()));  // a* + j b*
    if (late > highest) {
      highest = late;
      best = static_cast<std::ptrdiff_t>(d);
    }
    if (early > highest) {
      highest = early;
      best = -static_cast<std::ptrdiff_t>(d);
    }
  }
  if (!(highest > 25.0 * squares)) return std::nullopt;
  return best;
}

}  // namespace host_sim::frf
