#include "host_sim/stability/map/stability_map.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "host_sim/stability/map/boundary.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::stability {
namespace {

constexpr std::size_t most_followed = 8;

/// A vertical line between the first roots and the others, in the first gap that is wide enough for the count.
double line_below(const std::vector<Complex>& roots) {
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const double room = 0.1 + 0.1 * std::abs(roots[i]);
    const double gap = i + 1 < roots.size() ? roots[i].real() - roots[i + 1].real() : 2.0 * room;
    if (gap > 0.02 * room || i + 1 == roots.size()) return roots[i].real() - std::min(0.5 * gap, room);
  }
  return 0.0;
}

}  // namespace

void RootTracker::search(const DelayEquation& equation) {
  ++searches_;
  // Starts with a line just left of the rightmost root and moves left until there are roots to follow.
  roots_ = characteristic_roots(equation, -20.0).roots;
  if (roots_.size() > most_followed) roots_.resize(most_followed);
}

bool RootTracker::follow(const DelayEquation& equation) {
  if (roots_.empty()) return false;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    Complex s = roots_[i];
    if (!settle(equation, s)) continue;
    if (s.imag() < 0.0) s = std::conj(s);
    const bool known = std::any_of(roots_.begin(), roots_.begin() + static_cast<std::ptrdiff_t>(kept),
                                   [s](Complex other) { return std::abs(s - other) < 1e-7 * (1.0 + std::abs(s)); });
    if (!known) roots_[kept++] = s;
  }
  roots_.resize(kept);
  if (roots_.empty()) return false;
  std::sort(roots_.begin(), roots_.end(), [](Complex a, Complex b) { return a.real() > b.real(); });
  const double line = line_below(roots_);
  int found = 0;
  for (const Complex s : roots_) found += s.real() > line ? (s.imag() > 0.0 ? 2 : 1) : 0;
  try {
    return equation.roots_right_of(line) == found;
  } catch (const RootOnLine&) {
    return false;
  }
}

Complex RootTracker::rightmost(const DelayEquation& equation) {
  if (!follow(equation)) search(equation);
  return roots_.front();
}

DelayEquation LoopFamily::at(const std::vector<Setting>& settings) const {
  model::RigParameters<double> rig = rig_;
  const double* delay = nullptr;
  for (const Setting& setting : settings) {
    if (setting.variable == "tau") {
      delay = &setting.value;
    } else {
      parameter_of(rig, setting.variable) = setting.value;
    }
  }
  const LinearRig linear = linearise(rig);
  return linear.equation(delay != nullptr ? *delay : linear.delay() + extra_delay_);
}

StabilityMap stability_map(const LoopFamily& family, const Axis& x, const Axis& y, unsigned threads,
                           const std::function<void(double)>& progress) {
  StabilityMap map{x, y, {}, {}, {}, 0, threads};
  if (map.threads == 0) map.threads = std::max(1U, std::thread::hardware_concurrency());
  map.rightmost.resize(x.count * y.count);
  map.frequency.resize(x.count * y.count);
  // Roots are followed along the delay axis if there is one, because the polynomials do not change along it.
  const bool along_x = !y.is_delay();
  const Axis& inner = along_x ? x : y;
  const Axis& outer = along_x ? y : x;

  std::atomic<std::size_t> next{0}, done{0}, searches{0};
  std::mutex guard;
  std::exception_ptr failure;
  const auto work = [&](bool reports) {
    try {
      for (std::size_t line = next++; line < outer.count; line = next++) {
        RootTracker tracker;
        DelayEquation equation = family.at({{outer.variable, outer.value(line)}, {inner.variable, inner.value(0)}});
        for (std::size_t i = 0; i < inner.count; ++i) {
          if (inner.is_delay()) {
            equation.set_delay(inner.value(i));
          } else if (i > 0) {
            equation = family.at({{outer.variable, outer.value(line)}, {inner.variable, inner.value(i)}});
          }
          const Complex root = tracker.rightmost(equation);
          const std::size_t at = along_x ? line * x.count + i : i * x.count + line;
          map.rightmost[at] = root.real();
          map.frequency[at] = root.imag();
        }
        searches += tracker.searches();
        ++done;
        if (reports && progress) progress(static_cast<double>(done) / static_cast<double>(outer.count));
      }
    } catch (...) {
      const std::lock_guard lock(guard);
      if (!failure) failure = std::current_exception();
      next = outer.count;
    }
  };
  std::vector<std::thread> helpers;
  for (unsigned i = 1; i < map.threads; ++i) helpers.emplace_back(work, false);
  work(true);
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
  map.searches = searches;
  map.boundary = boundary(family, map);
  return map;
}

PoleSweep pole_sweep(const LoopFamily& family, const Axis& axis, double line) {
  PoleSweep sweep{axis, {}};
  for (std::size_t i = 0; i < axis.count; ++i) {
    sweep.roots.push_back(characteristic_roots(family.at({{axis.variable, axis.value(i)}}), line).roots);
  }
  return sweep;
}

}  // namespace host_sim::stability
