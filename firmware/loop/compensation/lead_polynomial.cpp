#include "firmware/loop/compensation/lead_polynomial.hpp"

#include "model/numerics/require.hpp"

namespace firmware::compensation {
namespace {

constexpr std::array<std::array<double, 4>, 4> factors{
    {{1.0, 0.0, 0.0, 0.0}, {2.0, -1.0, 0.0, 0.0}, {3.0, -3.0, 1.0, 0.0}, {4.0, -6.0, 4.0, -1.0}}};

}  // namespace

LeadPolynomial::LeadPolynomial(int degree, double delay, double period)
    : degree_(static_cast<std::size_t>(degree)), period_(period) {
  const double samples = delay / period;
  model::require(degree >= 0 && degree <= 3 && samples * degree <= static_cast<double>(longest),
                 "an extrapolation over a delay within the line");
  for (std::size_t i = 0; i <= degree_; ++i) ago_[i] = model::split(static_cast<double>(i) * samples);
}

std::size_t LeadPolynomial::reach() const { return ago_[degree_].whole + 2; }

LeadPolynomial::Stroke LeadPolynomial::next(State& x, const Stroke& now) const {
  x.push(now);
  Stroke u;
  for (std::size_t i = 0; i <= degree_; ++i) {
    const auto& at = ago_[i];
    const Stroke past = at.fraction == 0.0
                            ? x.ago(at.whole)
                            : model::hermite(x.ago(at.whole + 1), x.ago(at.whole), 1.0 - at.fraction, period_);
    const double a = factors[degree_][i];  // (1)
    u.position += a * past.position;
    u.velocity += a * past.velocity;
  }
  return u;
}

}  // namespace firmware::compensation
