#include "host_sim/stability/margins/frequency_response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::stability {
namespace {

std::vector<double> in_rad(const std::vector<double>& hz) {
  std::vector<double> omega;
  omega.reserve(hz.size());
  for (const double f : hz) omega.push_back(full_turn * f);
  return omega;
}

template <class Response>
ResponseCurve curve(std::string name, std::string unit, const Response& response, const std::vector<double>& omega) {
  ResponseCurve result{std::move(name), std::move(unit), {}, unwrapped_phase(response, omega)};
  for (const double w : omega) result.magnitude.push_back(std::abs(response(w)));
  return result;
}

}  // namespace

RoadResponse::RoadResponse(const LinearRig& rig, double delay, double machine_delay)
    : car_(rig.car),
      lever_ratio_(rig.lever_ratio),
      area_force_(rig.area_force),
      behind_over_(rig.force_sensor.numerator(0, 0)),
      behind_under_(rig.force_sensor.denominator()),
      delay_(delay),
      machine_delay_(machine_delay) {
  std::tie(machine_over_, machine_under_) = std::pair(rig.machine_response()[0], rig.machine_response()[1]);
  std::tie(component_over_, component_under_) = std::pair(rig.component_response()[0], rig.component_response()[1]);
}

std::vector<model::Channel> RoadResponse::outputs() {
  using model::Channel;
  return {Channel::z_w,  Channel::z_b, Channel::zdd_w, Channel::zdd_b, Channel::dz_w,
          Channel::dz_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F};
}

Complex RoadResponse::operator()(model::Channel output, double omega) const {
  const Complex s(0.0, omega);
  const auto delayed = [&](double delay) { return std::polar(1.0, -omega * delay); };
  const Complex machine = machine_over_(s) / machine_under_(s) * delayed(machine_delay_);
  const Complex component = component_over_(s) / component_under_(s);
  const Complex behind = behind_over_(s) / behind_under_(s) * delayed(delay_ - machine_delay_);

  const Eigen::RowVectorXd deflection = car_.c.row(0) - car_.c.row(1);
  Eigen::MatrixXcd m = -car_.a.cast<Complex>();
  m -= (machine * component * behind) * (car_.b.col(0) * deflection).cast<Complex>();
  m.diagonal().array() += s;
  const Eigen::VectorXcd road = car_.b.col(1).cast<Complex>() + s * car_.b.col(2).cast<Complex>();
  const Eigen::VectorXcd x = m.partialPivLu().solve(road);
  const auto of_car = [&](Eigen::Index row) {
    return (car_.c.row(row).cast<Complex>() * x)(0) + car_.d(row, 1) + s * car_.d(row, 2);
  };
  const Complex z_w = of_car(0), z_b = of_car(1), travel = lever_ratio_ * (z_w - z_b);
  switch (output) {
    case model::Channel::z_w:
      return z_w;
    case model::Channel::z_b:
      return z_b;
    case model::Channel::zdd_w:
      return s * s * z_w;
    case model::Channel::zdd_b:
      return s * s * z_b;
    case model::Channel::dz_w:
      return 1.0 - z_w;
    case model::Channel::dz_b:
      return z_w - z_b;
    case model::Channel::x_cmd:
      return travel;
    case model::Channel::F_w:
      return of_car(2);
    case model::Channel::x_act:
      return machine * travel;
    case model::Channel::F:
      return component * machine * travel + (area_force_ ? x(*area_force_) : Complex());
    default:
      throw std::logic_error("a channel that is no output of the road response");
  }
}

std::vector<double> frequencies(double from_hz, double to_hz, std::size_t count, const std::vector<Complex>& roots) {
  std::vector<double> hz;
  for (std::size_t i = 0; i < count; ++i) {
    hz.push_back(from_hz * std::pow(to_hz / from_hz, static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  for (const Complex s : roots) {
    const double centre = s.imag() / full_turn, width = std::max(std::abs(s.real()) / full_turn, 1e-6 * centre);
    if (!(centre > from_hz && centre < to_hz) || width > 0.2 * centre) continue;
    for (int i = -30; i <= 30; ++i) {
      const double f = centre + width * std::sinh(0.15 * i);
      if (f > from_hz && f < to_hz) hz.push_back(f);
    }
  }
  std::sort(hz.begin(), hz.end());
  hz.erase(std::unique(hz.begin(), hz.end()), hz.end());
  return hz;
}

BodeData bode(const LinearRig& rig, double delay, double machine_delay, const std::vector<double>& frequency_hz) {
  BodeData data;
  data.frequency_hz = frequency_hz;
  const std::vector<double> omega = in_rad(frequency_hz);
  const DelayEquation equation = rig.equation(delay);
  const auto loop = [&](double w) {
    const Complex s(0.0, w);
    return equation.q()(s) / equation.p()(s) * equation.delayed(s);
  };
  data.loop = curve("loop", "1", loop, omega);
  const RoadResponse response(rig, delay, machine_delay);
  for (const model::Channel channel : RoadResponse::outputs()) {
    std::string unit(model::unit(channel));
    unit = unit == "m" ? "1" : unit + "/m";
    data.outputs.push_back(curve(
        std::string(model::name(channel)), unit, [&](double w) { return response(channel, w); }, omega));
  }
  return data;
}

Peak peak(const RoadResponse& response, model::Channel output, double from_hz, double to_hz) {
  const auto size = [&](double hz) { return std::abs(response(output, full_turn * hz)); };
  Peak best;
  const double ratio = std::pow(to_hz / from_hz, 1.0 / 4000.0);
  for (double hz = from_hz; hz <= to_hz; hz *= ratio) {
    if (const double value = size(hz); value > best.magnitude) best = {hz, value};
  }
  constexpr double golden = std::numbers::phi - 1.0;
  double low = best.frequency_hz / ratio, high = best.frequency_hz * ratio;
  for (int i = 0; i < 60; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (size(a) > size(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  best.frequency_hz = 0.5 * (low + high);
  best.magnitude = size(best.frequency_hz);
  return best;
}

NyquistData nyquist(const DelayEquation& equation, const std::vector<Complex>& closed_loop) {
  NyquistData data;
  const std::vector<Complex> poles = roots(equation.p());
  const double top = equation.radius(0.0);
  // Offset from the axis: a thousandth of the slowest motion, at most half the distance to the nearest unstable pole or
  // root.
  double slowest = top, unstable = top;
  for (const auto* set : {&poles, &closed_loop}) {
    for (const Complex s : *set) {
      if (std::abs(s) > 1e-6) slowest = std::min(slowest, std::abs(s));
      if (s.real() > 1e-9 * std::abs(s) && s != Complex()) unstable = std::min(unstable, s.real());
    }
  }
  data.offset = std::min(1e-3 * slowest, 0.5 * unstable);
  for (const Complex s : poles) data.open_loop_unstable += s.real() > data.offset ? 1 : 0;

  const auto loop = [&](double omega) {
    const Complex s(data.offset, omega);
    return equation.q()(s) / equation.p()(s) * equation.delayed(s);
  };
  // Refined until neither L nor 1 + L turns by more than a hundredth of a turn between points, so that lines look
  // smooth.
  const auto add = [&](const auto& self, double low, Complex at_low, double high, Complex at_high, int depth) -> void {
    const double turned = std::max(std::abs(std::arg(times(at_high, std::conj(at_low)))),
                                   std::abs(std::arg(times(1.0 + at_high, std::conj(1.0 + at_low)))));
    if (depth > 0 && turned > full_turn / 100.0) {
      const double middle = 0.5 * (low + high);
      const Complex at_middle = loop(middle);
      self(self, low, at_low, middle, at_middle, depth - 1);
      self(self, middle, at_middle, high, at_high, depth - 1);
      return;
    }
    data.omega.push_back(high);
    data.loop.push_back(at_high);
  };
  constexpr int pieces = 400;
  double before = 0.0;
  Complex value = loop(0.0);
  data.omega.push_back(before);
  data.loop.push_back(value);
  const double first = 1e-2 * data.offset;
  for (int i = 0; i <= pieces; ++i) {
    const double omega = first * std::pow(1.1 * top / first, static_cast<double>(i) / pieces);
    const Complex at = loop(omega);
    add(add, before, value, omega, at, 40);
    before = omega;
    value = at;
  }
  // 1 + L starts real and ends where |L| < 1, right of the imaginary axis; its remaining turn to 0 is its own angle.
  double turned = 0.0;
  for (std::size_t i = 1; i < data.loop.size(); ++i) {
    turned += std::arg(times(1.0 + data.loop[i], std::conj(1.0 + data.loop[i - 1])));
  }
  turned -= std::arg(1.0 + data.loop.back());
  data.encirclements = static_cast<int>(std::lround(2.0 * turned / full_turn));
  data.closed_loop_unstable = data.open_loop_unstable - data.encirclements;
  return data;
}

}  // namespace host_sim::stability
