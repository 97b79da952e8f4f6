#include "tests/support/reference_rig.hpp"

#include <algorithm>
#include <cmath>

namespace support {
namespace {

constexpr std::size_t ducts = 6;
constexpr double pi = 3.14159265358979323846;

struct Point {
  double x, v;
};

/// Cubic Hermite polynomial in powers of s = t/h.
Point cubic(const Point& from, const Point& to, double s, double h) {
  const double p = h * from.v, q = h * to.v, rise = to.x - from.x;
  const double c2 = 3.0 * rise - 2.0 * p - q, c3 = p + q - 2.0 * rise;
  return {from.x + s * (p + s * (c2 + s * c3)), (p + s * (2.0 * c2 + s * 3.0 * c3)) / h};
}

template <std::size_t N>
using Numbers = std::array<double, N>;

template <std::size_t N>
Numbers<N> sum(const Numbers<N>& x, double h, const Numbers<N>& rate) {
  Numbers<N> y;
  for (std::size_t i = 0; i < N; ++i) y[i] = x[i] + h * rate[i];
  return y;
}

/// One step of the classic Runge–Kutta method; rates(s, x), s = 0 … 1 through the step.
template <std::size_t N, class Rates>
Numbers<N> rk4(const Numbers<N>& x, double h, const Rates& rates) {
  const Numbers<N> a = rates(0.0, x), b = rates(0.5, sum(x, 0.5 * h, a)), c = rates(0.5, sum(x, 0.5 * h, b)),
                   d = rates(1.0, sum(x, h, c));
  Numbers<N> y;
  for (std::size_t i = 0; i < N; ++i) y[i] = x[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
  return y;
}

class Component {
 public:
  static constexpr std::size_t size = 1 + ducts;  // y, q_1 … q_6
  using State = Numbers<size>;

  explicit Component(const ReferenceRig& rig) : rig_(rig), open_(rig.open) {
    const double area = pi * rig.d * rig.d / 4.0;
    inertance_ = rig.rho * rig.l / area;
    laminar_ = 128.0 * rig.rho * rig.nu * rig.l / (pi * std::pow(rig.d, 4));
    turbulent_ = rig.rho * rig.minor_loss / (2.0 * area * area);
  }

  void open(unsigned ducts_open, State& x) {
    open_ = ducts_open;
    for (std::size_t j = 0; j < ducts; ++j) {
      if ((open_ >> j & 1U) == 0U) x[1 + j] = 0.0;
    }
  }

  [[nodiscard]] double coil(const State& x, double e) const { return rig_.has_fdva ? rig_.k_c * (e - x[0]) : 0.0; }
  [[nodiscard]] double force(const State& x, double e, double v) const {
    return rig_.k_b * e + rig_.b_b * v + coil(x, e);
  }
  [[nodiscard]] State rates(const State& x, double e) const {
    State rate{};
    if (!rig_.has_fdva) return rate;
    const double pressure = coil(x, e) / rig_.A_p;
    for (std::size_t j = 0; j < ducts; ++j) {
      if ((open_ >> j & 1U) == 0U) continue;
      const double q = x[1 + j];
      rate[0] += q / rig_.A_p;
      rate[1 + j] = (pressure - laminar_ * q - turbulent_ * q * std::fabs(q)) / inertance_;
    }
    return rate;
  }

 private:
  ReferenceRig rig_;
  unsigned open_;
  double inertance_{}, laminar_{}, turbulent_{};
};

class Car {
 public:
  using State = Numbers<4>;  // z_w, v_w, z_b, v_b

  explicit Car(const ReferenceRig& rig) : rig_(rig) {}

  [[nodiscard]] double wheel_load(const State& x, const Point& foot) const {
    const double f = rig_.k_t * (foot.x - x[0]) + rig_.b_t * (foot.v - x[1]);
    return rig_.lifts_off ? std::max(f, -9.81 * (rig_.m_b + rig_.m_w)) : f;
  }
  [[nodiscard]] State rates(const State& x, const Point& foot, double component) const {
    const double up = component + rig_.virtual_damping * (x[1] - x[3]);
    return {x[1], (wheel_load(x, foot) - up) / rig_.m_w, x[3], up / rig_.m_b};
  }

 private:
  ReferenceRig rig_;
};

ReferenceSample sample_of(const Car& car, const Car::State& x, const Point& foot, double component) {
  const Car::State rate = car.rates(x, foot, component);
  return {x[0], x[2], rate[1], rate[3], foot.x - x[0], x[0] - x[2], car.wheel_load(x, foot), 0.0, 0.0, 0.0};
}

double sign(double v) { return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0); }

Point at(const ReferenceInput& in) { return {in.position, in.velocity}; }

std::vector<ReferenceSample> run_quarter_car(const ReferenceRig& rig, double period,
                                             const std::vector<ReferenceInput>& input, int fine,
                                             const std::function<unsigned(std::size_t)>& open) {
  using State = Numbers<4 + Component::size>;
  const Car car(rig);
  Component component(rig);
  const auto car_of = [](const State& x) { return Car::State{x[0], x[1], x[2], x[3]}; };
  const auto component_of = [](const State& x) {
    Component::State c;
    std::copy(x.begin() + 4, x.end(), c.begin());
    return c;
  };
  State x{input[0].position, 0.0, input[0].position, 0.0};
  double friction = 0.0;
  const double h = period / fine;
  std::vector<ReferenceSample> samples;
  const auto record = [&](std::size_t k) {
    const double force =
        component.force(component_of(x), x[0] - x[2], x[1] - x[3]) + friction + input[k].actuator_force;
    samples.push_back(sample_of(car, car_of(x), at(input[k]), force));
  };
  record(0);
  for (std::size_t k = 0; k + 1 < input.size(); ++k) {
    if (open) {
      Component::State c = component_of(x);
      component.open(open(k), c);
      std::copy(c.begin(), c.end(), x.begin() + 4);
    }
    for (int i = 0; i < fine; ++i) {
      const auto step = [&](double dry) {
        return rk4(x, h, [&](double s, const State& now) {
          const double t = (i + s) / fine;
          const Component::State c = component_of(now);
          const double e = now[0] - now[2], v = now[1] - now[3];
          const double actuator = input[k].actuator_force + t * (input[k + 1].actuator_force - input[k].actuator_force);
          const Car::State a = car.rates(car_of(now), cubic(at(input[k]), at(input[k + 1]), t, period),
                                         component.force(c, e, v) + dry + actuator);
          const Component::State b = component.rates(c, e);
          State rate;
          std::copy(b.begin(), b.end(), std::copy(a.begin(), a.end(), rate.begin()));
          return rate;
        });
      };
      State next = step(0.0);
      if (rig.dry_friction > 0.0) {
        const double stopping = (next[1] - next[3]) / (h * (1.0 / rig.m_w + 1.0 / rig.m_b));
        friction = std::clamp(stopping, -rig.dry_friction, rig.dry_friction);
        next = step(friction);
      }
      x = next;
    }
    record(k + 1);
  }
  return samples;
}

/// hil and component_bench: the machine reads the deflection of a fine step long ago.
std::vector<ReferenceSample> run_machine(const ReferenceRig& rig, double period,
                                         const std::vector<ReferenceInput>& input, int fine,
                                         const std::function<unsigned(std::size_t)>& open) {
  const bool with_car = rig.kind == ReferenceRig::Kind::hil;
  const double h = period / fine;
  const auto late = static_cast<std::size_t>(std::lround(rig.delay / h));
  const Car car(rig);
  Component component(rig);
  Car::State x{input[0].position, 0.0, input[0].position, 0.0};
  Component::State c{};
  const Point start = with_car ? Point{0.0, 0.0} : Point{input[0].position, 0.0};
  c[0] = start.x;
  std::vector<Point> commanded{start};  // at every fine step
  const auto reached_at = [&](std::size_t step) { return step < late ? start : commanded[step - late]; };
  double held = rig.k_b * start.x;
  std::vector<ReferenceSample> samples;
  const auto record = [&](std::size_t k, const Point& command, const Point& reached) {
    ReferenceSample s{};
    if (with_car) s = sample_of(car, x, at(input[k]), held);
    s.x_cmd = command.x;
    s.x_act = reached.x;
    s.F = held;
    samples.push_back(s);
  };
  record(0, start, start);
  for (std::size_t k = 0; k + 1 < input.size(); ++k) {
    if (open) component.open(open(k), c);
    for (int i = 0; i < fine; ++i) {
      const std::size_t step = k * static_cast<std::size_t>(fine) + static_cast<std::size_t>(i);
      const auto input_at = [&](double s) { return cubic(at(input[k]), at(input[k + 1]), (i + s) / fine, period); };
      if (with_car) {
        x = rk4(x, h, [&](double s, const Car::State& now) { return car.rates(now, input_at(s), held); });
        commanded.push_back({x[0] - x[2], x[1] - x[3]});
      } else {
        commanded.push_back(input_at(1.0));
      }
      const Point from = reached_at(step), to = reached_at(step + 1);
      c = rk4(c, h,
              [&](double s, const Component::State& now) { return component.rates(now, cubic(from, to, s, h).x); });
    }
    const Point reached = reached_at(commanded.size() - 1);
    held = component.force(c, reached.x, reached.v) + rig.dry_friction * sign(reached.v);
    record(k + 1, commanded.back(), reached);
  }
  return samples;
}

}  // namespace

std::vector<ReferenceSample> run_reference(const ReferenceRig& rig, double period,
                                           const std::vector<ReferenceInput>& input, int fine,
                                           const std::function<unsigned(std::size_t)>& open) {
  if (rig.kind == ReferenceRig::Kind::quarter_car) return run_quarter_car(rig, period, input, fine, open);
  return run_machine(rig, period, input, fine, open);
}

}  // namespace support
