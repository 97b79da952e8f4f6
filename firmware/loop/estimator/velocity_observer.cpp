#include "firmware/loop/estimator/velocity_observer.hpp"

#include "model/numerics/exact_discretisation.hpp"

namespace firmware {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double root_2 = 1.4142135623730951;

double angular(double frequency, double period) {
  const double highest = 0.25 / period;
  return two_pi * (frequency < highest ? frequency : highest);
}

}  // namespace

VelocityObserver::VelocityObserver(Inputs inputs, const Observers& settings, double period) : inputs_(inputs) {
  Eigen::Matrix<double, 3, 3> a = Eigen::Matrix<double, 3, 3>::Zero();
  Eigen::Matrix<double, 3, 1> by_y = Eigen::Matrix<double, 3, 1>::Zero();
  Eigen::Matrix<double, 3, 1> by_a = Eigen::Matrix<double, 3, 1>::Zero();
  switch (inputs) {
    case Inputs::nothing:
      break;
    case Inputs::displacement: {  // (3)
      const double w = angular(settings.differentiation, period);
      a << -root_2 * w, 1.0, 0.0, -w * w, 0.0, 0.0, 0.0, 0.0, 0.0;
      by_y << root_2 * w, w * w, 0.0;
      break;
    }
    case Inputs::acceleration: {  // (4)
      const double w = angular(settings.cross_over, period);
      a << 0.0, 1.0, 0.0, -w * w, -root_2 * w, 0.0, 0.0, 0.0, 0.0;
      by_a << 0.0, 1.0, 0.0;
      break;
    }
    case Inputs::both: {  // (1)
      const double w = angular(settings.cross_over, period);
      a << -2.0 * w, 1.0, 0.0, -2.0 * w * w, 0.0, -1.0, w * w * w, 0.0, 0.0;
      by_y << 2.0 * w, 2.0 * w * w, -w * w * w;
      by_a << 0.0, 1.0, 0.0;
      break;
    }
  }
  const model::ExactDiscretisation<double, 3> step(a, period);
  transition_ = step.transition();
  by_displacement_ = step.straight(by_y);
  by_acceleration_ = step.straight(by_a);
  state_.setZero();
}

double VelocityObserver::step(double displacement, double acceleration) {
  if (!started_) {
    started_ = true;
    if (inputs_ != Inputs::acceleration) state_(0) = displacement;
  } else if (inputs_ != Inputs::nothing) {
    Eigen::Matrix<double, 3, 1> next = model::product(transition_, state_);
    if (inputs_ != Inputs::acceleration) {
      next += by_displacement_.col(0) * displacement_;
      next += by_displacement_.col(1) * displacement;
    }
    if (inputs_ != Inputs::displacement) {
      next += by_acceleration_.col(0) * acceleration_;
      next += by_acceleration_.col(1) * acceleration;
    }
    state_ = next;
  }
  displacement_ = displacement;
  acceleration_ = acceleration;
  return state_(1);
}

}  // namespace firmware
