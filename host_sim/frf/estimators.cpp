#include "host_sim/frf/estimators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace host_sim::frf {
namespace {

using std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

struct Disc {
  Complex centre;
  double radius;
};

// (7), as H = Ĥ + δ: with S_xe and S_ee of the residual e = y − Ĥ x it reads
//   (|S_zx|² − q S_zz S_xx) |δ|² + 2 q S_zz Re δ* S_xe ≤ q S_zz S_ee.
// nullopt: the region is the outside of a disc, or the whole plane.
std::optional<Disc> disc(const LineSpectra& s, Complex h, double q) {
  const double share = q * s.zz;
  const double curvature = std::norm(s.zx) - share * s.xx;
  if (!(curvature > 0.0)) return std::nullopt;
  const Complex xe = s.xy - h * s.xx;
  const double ee = std::max(0.0, s.yy - 2.0 * (std::conj(h) * s.xy).real() + std::norm(h) * s.xx);
  const Complex offset = -share / curvature * xe;
  return Disc{h + offset, std::sqrt(std::norm(offset) + share * ee / curvature)};
}

Bounds undetermined(Complex h, double highest) { return {0.0, highest, std::arg(h) - pi, std::arg(h) + pi, false}; }

// The instrument z with which (4) equals (1) or (2).
LineSpectra with_instrument(const LineSpectra& s, Estimator estimator) {
  if (estimator == Estimator::h1) return {s.xx, s.xx, s.yy, s.xx, s.xy, s.xy};
  if (estimator == Estimator::h2) return {s.yy, s.xx, s.yy, std::conj(s.xy), s.yy, s.xy};
  return s;
}

Bounds equal_noise_bounds(const LineSpectra& s, Complex h, const Quantiles& quantiles) {
  const double magnitude = std::abs(h);
  const double gamma2 = coherence(s.xx, s.yy, s.xy);
  const double t2_over_nu = quantiles.one() / (1.0 - quantiles.one());
  const double factor = std::exp(std::asinh(std::sqrt(t2_over_nu * (1.0 - gamma2))));
  if (!(gamma2 > quantiles.complex())) return undetermined(h, magnitude * factor);
  const double turn = std::asin(std::min(1.0, std::sqrt(t2_over_nu * (1.0 - gamma2) / gamma2)));
  return {magnitude / factor, magnitude * factor, std::arg(h) - turn, std::arg(h) + turn, true};
}

}  // namespace

std::string_view name(Estimator estimator) {
  switch (estimator) {
    case Estimator::h1:
      return "H1";
    case Estimator::h2:
      return "H2";
    case Estimator::hv:
      return "Hv";
    default:
      return "Hiv";
  }
}

double coherence(double aa, double bb, Complex ab) {
  const double share = std::abs(ab) / std::sqrt(aa) / std::sqrt(bb);  // the product of two powers may not be a number
  return aa > 0.0 && bb > 0.0 && std::isfinite(share) ? std::min(1.0, share * share) : 0.0;
}

Complex estimate(const LineSpectra& s, Estimator estimator) {
  if (estimator == Estimator::hv) {
    const double size = std::abs(s.xy);
    return size > 0.0 ? std::sqrt(s.yy / s.xx) / size * s.xy : Complex(std::sqrt(s.yy / s.xx));
  }
  const LineSpectra by = with_instrument(s, estimator);
  return by.zy / by.zx;
}

double student_quantile(double degrees_of_freedom) {
  // With t = √ν tan θ:  P(|T| ≤ t) = ∫₀^θ cos^{ν−1} / ∫₀^{π/2} cos^{ν−1}, the whole in closed form, the part by
  // Simpson.
  const double nu = degrees_of_freedom;
  if (!(nu >= 1.0)) throw std::invalid_argument("student_quantile: less than one degree of freedom");
  const double whole = 0.5 * std::sqrt(pi) * std::exp(std::lgamma(0.5 * nu) - std::lgamma(0.5 * nu + 0.5));
  const auto probability = [nu, whole](double theta) {
    constexpr int panels = 400;
    double sum = 0.0;
    for (int i = 0; i <= panels; ++i) {
      const double weight = i == 0 || i == panels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum += weight * std::exp((nu - 1.0) * std::log(std::cos(theta * i / panels)));
    }
    return sum * theta / (3.0 * panels) / whole;
  };
  double low = 0.0, high = std::atan(13.0 / std::sqrt(nu));  // ν = 1 has the largest, 12.7
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (probability(middle) < 0.95 ? low : high) = middle;
  }
  return std::sqrt(nu) * std::tan(0.5 * (low + high));
}

Quantiles::Quantiles(double averages) {
  if (!(averages > 1.0 + 1e-9)) return;
  complex_ = 1.0 - std::pow(0.05, 1.0 / (averages - 1.0));
  const double nu = 2.0 * (averages - 1.0);
  if (nu < 1.0) return;  // half a second average: q₁ stays 1
  const double t = student_quantile(nu);
  one_ = t * t / (nu + t * t);
}

Bounds bounds(const LineSpectra& s, Estimator estimator, const Quantiles& quantiles) {
  const Complex h = estimate(s, estimator);
  if (!std::isfinite(std::abs(h)) || quantiles.one() >= 1.0) return undetermined(h, infinite);
  if (estimator == Estimator::hv) return equal_noise_bounds(s, h, quantiles);
  const LineSpectra by = with_instrument(s, estimator);
  const std::optional<Disc> one = disc(by, h, quantiles.one());
  if (!one) return undetermined(h, infinite);
  const double middle = std::abs(one->centre);
  const std::optional<Disc> both = disc(by, h, quantiles.complex());
  if (!both || !(std::abs(both->centre) > both->radius) || !(middle > one->radius)) {
    return undetermined(h, middle + one->radius);
  }
  const double turn = std::asin(one->radius / middle);
  const double phase = std::arg(h) + std::arg(one->centre * std::conj(h));
  return {middle - one->radius, middle + one->radius, phase - turn, phase + turn, true};
}

}  // namespace host_sim::frf
