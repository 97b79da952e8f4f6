#include "tests/truth/signal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tests/truth/random.hpp"

namespace truth {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;
constexpr double step = 1e-3;

/// x_j = Σ_k X_k e^{+2πi jk/n} in place, n a power of two.
void inverse_transform(std::vector<Complex>& x) {
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  std::vector<Complex> turn(n / 2);
  for (std::size_t k = 0; k < n / 2; ++k)
    turn[k] = std::polar(1.0, 2.0 * pi * static_cast<double>(k) / static_cast<double>(n));
  for (std::size_t length = 2; length <= n; length <<= 1U) {
    const std::size_t half = length / 2;
    for (std::size_t start = 0; start < n; start += length) {
      for (std::size_t k = 0; k < half; ++k) {
        const Complex& w = turn[k * (n / length)];
        const Complex& b = x[start + k + half];
        const Complex odd{b.real() * w.real() - b.imag() * w.imag(), b.real() * w.imag() + b.imag() * w.real()};
        const Complex even = x[start + k];
        x[start + k] = even + odd;
        x[start + k + half] = even - odd;
      }
    }
  }
}

/// The product of two motions.
Motion times(const Motion& a, const Motion& b) {
  return {a.position * b.position, a.velocity * b.position + a.position * b.velocity,
          a.acceleration * b.position + 2.0 * a.velocity * b.velocity + a.position * b.acceleration};
}

/// From 0 to 1 within a second: 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷.
Motion ramp(double u) {
  if (u >= 1.0) return {1.0, 0.0, 0.0};
  const double u2 = u * u;
  return {u2 * u2 * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u))), 140.0 * u2 * u * (1.0 + u * (-3.0 + u * (3.0 - u))),
          420.0 * u2 * (1.0 + u * (-4.0 + u * (5.0 - 2.0 * u)))};
}

double road_spectrum(double f, double corner) {
  const double roughness = 64e-6 * 0.1 * 0.1 * 27.78;
  const double high_pass = std::pow(f / corner, 4);
  return roughness / (f * f) * high_pass / (1.0 + high_pass);
}

/// rms of the velocity of a road of level 1, and of a command of level 1 m [m/s].
constexpr double road_velocity = 0.147;
constexpr double command_velocity = 38.0;

/// Sine whose frequency rises from `low` to `high` in proportion to time, with a constant amplitude of velocity.
std::vector<Motion> sweep(std::size_t count, double velocity, double low, double high) {
  std::vector<Motion> knots;
  const double rise = 2.0 * pi * (high - low) / (static_cast<double>(count) * step);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * step;
    const double turn = 2.0 * pi * low + rise * t;
    const double angle = 2.0 * pi * low * t + 0.5 * rise * t * t;
    const Motion size{velocity / turn, -velocity * rise / (turn * turn),
                      2.0 * velocity * rise * rise / (turn * turn * turn)};
    knots.push_back(
        times(size, {std::sin(angle), turn * std::cos(angle), rise * std::cos(angle) - turn * turn * std::sin(angle)}));
  }
  return knots;
}

/// Adds `height` times a smooth rise within `span`, from `begin` on.
void add_rise(std::vector<Motion>& knots, double begin, double span, double height) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const double u = (static_cast<double>(i) * step - begin) / span;
    if (u <= 0.0) continue;
    const Motion one = ramp(u);
    knots[i].position += height * one.position;
    knots[i].velocity += height * one.velocity / span;
    knots[i].acceleration += height * one.acceleration / (span * span);
  }
}

/// Steps of 40 … 90 ms up and down, one in every 0.8 … 1.6 s.
std::vector<Motion> steps(std::size_t count, double height, Random& random) {
  std::vector<Motion> knots(count);
  double level = 0.0;
  for (double t = 0.5; t < static_cast<double>(count) * step; t += random.uniform(0.8, 1.6)) {
    const double next = random.uniform(-height, height);
    add_rise(knots, t, random.uniform(0.04, 0.09), next - level);
    level = next;
  }
  return knots;
}

/// Sines of 1.5 s, one after the other, 1, 2, 3 … Hz, with a constant amplitude of velocity.
std::vector<Motion> stepped_sines(std::size_t count, double velocity, double low, double high) {
  constexpr double stay = 1.5;
  constexpr double fade = 0.25;
  std::vector<Motion> knots(count);
  const auto places = static_cast<std::size_t>(static_cast<double>(count) * step / stay) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * step;
    const auto place = static_cast<std::size_t>(t / stay);
    const double f = low * std::pow(high / low, static_cast<double>(place) / static_cast<double>(places));
    const double local = t - static_cast<double>(place) * stay;
    const double turn = 2.0 * pi * f;
    const double a = velocity / turn;
    const Motion wave{a * std::sin(turn * local), velocity * std::cos(turn * local),
                      -velocity * turn * std::sin(turn * local)};
    const Motion in = ramp(local / fade);
    Motion out = ramp(std::max(0.0, (stay - local) / fade));
    out.velocity = -out.velocity;
    const auto scaled = [](Motion m, double span) {
      return Motion{m.position, m.velocity / span, m.acceleration / span / span};
    };
    knots[i] = times(times(wave, scaled(in, fade)), scaled(out, fade));
  }
  return knots;
}

/// 24 sines on multiples of a quarter of a hertz, with a constant amplitude of velocity, repeated every 4 s.
std::vector<Motion> multisine(std::size_t count, double velocity, double low, double high, Random& random) {
  constexpr int tones = 24;
  std::vector<Motion> knots(count);
  for (int k = 0; k < tones; ++k) {
    const double f = 0.25 * std::round(4.0 * low * std::pow(high / low, k / (tones - 1.0)));
    const double turn = 2.0 * pi * f;
    const double phase = random.uniform(0.0, 2.0 * pi);
    const double size = velocity / std::sqrt(static_cast<double>(tones)) / turn;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = turn * static_cast<double>(i) * step + phase;
      knots[i].position += size * std::sin(angle);
      knots[i].velocity += size * turn * std::cos(angle);
      knots[i].acceleration -= size * turn * turn * std::sin(angle);
    }
  }
  return knots;
}

std::vector<Motion> formed(const RecordPlan& plan, bool bench, std::size_t count) {
  Random random(plan.road_seed);
  const double velocity = std::numbers::sqrt2 * plan.level * (bench ? command_velocity : road_velocity);
  const double low = bench ? 3.0 : 0.8;
  const double high = bench ? 25.0 : 30.0;
  if (plan.form == "sweep") return sweep(count, velocity, low, high);
  if (plan.form == "steps") return steps(count, plan.level * (bench ? 1.5 : 0.015), random);
  if (plan.form == "stepped_sines") return stepped_sines(count, velocity, low, high);
  if (plan.form == "multisine") return multisine(count, velocity, low, high, random);
  throw std::invalid_argument("no such form of a road: " + plan.form);
}

}  // namespace

Signal::Signal(const RecordPlan& plan, bool bench) {
  const auto count = static_cast<std::size_t>(std::lround((plan.warm + plan.duration) / step)) + 2;
  if (!plan.form.empty()) {
    knots_ = formed(plan, bench, count);
    for (std::size_t i = 0; i < count; ++i) knots_[i] = times(knots_[i], ramp(static_cast<double>(i) * step));
    return;
  }
  std::size_t n = 4096;
  while (n < count) n *= 2;
  const double spacing = 1.0 / (static_cast<double>(n) * step);
  const double corner = plan.corner > 0.0 ? plan.corner : (bench ? 2.0 : 0.35);
  const double last = plan.cut > 0.0 ? plan.cut : (bench ? 25.0 : 40.0);

  Random random(plan.road_seed);
  std::vector<Complex> amplitude(n);
  double power = 0.0;
  for (std::size_t k = 1; static_cast<double>(k) * spacing <= last; ++k) {
    const double f = static_cast<double>(k) * spacing;
    const double rms = std::sqrt((bench ? 1.0 / (f * f + corner * corner) : road_spectrum(f, corner)) * spacing);
    const double a = random.normal();
    amplitude[k] = rms * Complex{a, random.normal()};
    power += rms * rms;
  }
  const double scale = bench ? plan.level / std::sqrt(power) : plan.level;

  // Position and velocity are the real and imaginary part of one transform: Z + i·(iωZ) of real signals, made so by
  // mirroring.
  std::vector<Complex> both(n);
  std::vector<Complex> curvature(n);
  for (std::size_t k = 1; k < n / 2; ++k) {
    const Complex z = 0.5 * scale * amplitude[k];
    if (z == Complex{}) break;
    const double omega = 2.0 * pi * static_cast<double>(k) * spacing;
    const Complex v = Complex{0.0, omega} * z;
    both[k] = z + Complex{0.0, 1.0} * v;
    both[n - k] = std::conj(z) + Complex{0.0, 1.0} * std::conj(v);
    curvature[k] = -omega * omega * z;
    curvature[n - k] = std::conj(curvature[k]);
  }
  inverse_transform(both);
  inverse_transform(curvature);

  knots_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * step;
    Motion motion = times({both[i].real(), both[i].imag(), curvature[i].real()}, ramp(t));
    if (bench) {
      const double omega = 2.0 * pi / plan.modulation_period;
      const double angle = omega * t + plan.modulation_phase;
      const double depth = plan.modulation_depth;
      motion = times(motion, {1.0 + depth * std::sin(angle), depth * omega * std::cos(angle),
                              -depth * omega * omega * std::sin(angle)});
    }
    knots_.push_back(motion);
  }
}

Signal::Signal(std::vector<Motion> knots) : knots_(std::move(knots)) {}

Motion Signal::at(double time) const {
  const double place = std::max(time, 0.0) / step;
  const std::size_t i = std::min(static_cast<std::size_t>(place), knots_.size() - 2);
  const double u = std::min(place - static_cast<double>(i), 1.0);
  const Motion& p = knots_[i];
  const Motion& q = knots_[i + 1];
  // z = c0 + c1 u + … + c5 u⁵ with the given ends.
  const double c1 = p.velocity * step;
  const double c2 = 0.5 * p.acceleration * step * step;
  const double e0 = q.position - p.position - c1 - c2;
  const double e1 = q.velocity * step - c1 - 2.0 * c2;
  const double e2 = q.acceleration * step * step - 2.0 * c2;
  const double c3 = 10.0 * e0 - 4.0 * e1 + 0.5 * e2;
  const double c4 = -15.0 * e0 + 7.0 * e1 - e2;
  const double c5 = 6.0 * e0 - 3.0 * e1 + 0.5 * e2;
  return {p.position + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
          (c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / step,
          (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (step * step)};
}

}  // namespace truth
