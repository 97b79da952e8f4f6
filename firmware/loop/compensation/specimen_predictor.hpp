// The Smith predictor: the force that the delay keeps back, from a model of the component.
#pragma once

#include <array>
#include <cstddef>

#include "firmware/loop/compensation/settings.hpp"
#include "model/components/machine.hpp"
#include "model/numerics/delay_line.hpp"

namespace firmware::compensation {

/// The force of the component at the wanted deflection x less that at the deflection that the machine has reached:
///
///   (1)  F = F_m + Ĝ (x − x̂_m),   x̂_m = M̂ x
///   (2)  Ĝ e = k_b e + b_b ė + k_c (e − y)
///   (3)  ÿ = n/(I A_p²) k_c (e − y) − R/I ẏ             n ducts open; the oil's laminar losses only
///
/// M̂ is the assumed machine: its delay, lag and resonance. e moves on the cubic between samples. Ĝ is linear, so it
/// runs on the difference alone. Leaves out: every law and effect of the component, its minor losses. This is the one
/// method that computes with the component that the rig measures. Source: Smith, Closer control of loops with dead
/// time, 1957.
class SpecimenPredictor {
 public:
  using Stroke = model::Stroke<double>;
  using Line = model::DelayLine<Stroke, 256>;

  struct State {
    Line line{};
    model::Machine<double>::State machine = model::Machine<double>::State::Zero();
    Stroke delayed{}, reached{}, difference{};
    model::Column<double, 2> piston = model::Column<double, 2>::Zero();  ///< y, ẏ
  };

  SpecimenPredictor(const Settings& settings, double period);

  void start(State& x, const Stroke& at) const;
  /// The wanted deflection of this instant.
  void step(State& x, const Stroke& wanted, int open_ducts) const;
  /// Ĝ (x − x̂_m) at this instant [N].
  [[nodiscard]] double force(const State& x) const;

  [[nodiscard]] std::size_t reach() const;  ///< samples of the line that step() reads

 private:
  struct Step {
    model::Block<double, 2, 2> state = model::Block<double, 2, 2>::Zero();
    model::Block<double, 2, 4> stroke = model::Block<double, 2, 4>::Zero();
  };

  Component component_;
  double period_;
  double delay_;  ///< [samples]
  model::Machine<double> machine_;
  std::array<Step, model::duct_capacity + 1> steps_{};  ///< by the number of open ducts
};

}  // namespace firmware::compensation
