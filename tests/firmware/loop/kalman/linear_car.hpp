// A quarter car on a first-order road, written down and simulated without the product: what a right filter is judged
// by.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>
#include <vector>

#include "firmware/loop/kalman/kalman_settings.hpp"
#include "hal/sensor_source.hpp"
#include "model/rig/rig_parameters.hpp"

namespace support {

/// x = [z_b ż_b z_w ż_w z_r], ẋ = A x + B w, one-sided S_w = 1; class B at 27.78 m/s, the paper's car (physics.md).
struct LinearCar {
  static constexpr double m_b = 290.0, m_w = 40.0, k_t = 200e3, b_t = 100.0, k_b = 31500.0, b_b = 1140.0;
  static constexpr double cut_off = 0.05, period = 1e-3;
  using Vector = Eigen::Matrix<double, 5, 1>;
  using Matrix = Eigen::Matrix<double, 5, 5>;

  /// `step`: between two samples [s].
  explicit LinearCar(double step = period) {
    const double corner = 2.0 * std::numbers::pi * cut_off;
    const double gain = 2.0 * std::numbers::pi * 0.1 * std::sqrt(64e-6 * 27.78);
    a << 0, 1, 0, 0, 0,                                                                            //
        -k_b / m_b, -b_b / m_b, k_b / m_b, b_b / m_b, 0,                                           //
        0, 0, 0, 1, 0,                                                                             //
        k_b / m_w, b_b / m_w, -(k_b + k_t) / m_w, -(b_b + b_t) / m_w, (k_t - b_t * corner) / m_w,  //
        0, 0, 0, 0, -corner;
    b << 0, 0, 0, b_t * gain / m_w, gain;
    // Van Loan: exp([−A BBᵀ/2; 0 Aᵀ] h) holds Φ and Q.
    Eigen::Matrix<double, 10, 10> joint = Eigen::Matrix<double, 10, 10>::Zero();
    joint.topLeftCorner<5, 5>() = -a * step;
    joint.topRightCorner<5, 5>() = 0.5 * b * b.transpose() * step;
    joint.bottomRightCorner<5, 5>() = a.transpose() * step;
    const Eigen::Matrix<double, 10, 10> e = joint.exp();
    phi = e.bottomRightCorner<5, 5>().transpose();
    q = phi * e.topRightCorner<5, 5>();
    q = 0.5 * (q + q.transpose()).eval();
  }

  /// Row of a channel that the car has.
  [[nodiscard]] Vector row(model::Channel channel) const {
    Vector c = Vector::Zero();
    switch (channel) {
      case model::Channel::z_r:
        c(4) = 1.0;
        break;
      case model::Channel::zdd_b:
        c = a.row(1).transpose();
        break;
      case model::Channel::zdd_w:
        c = a.row(3).transpose();
        break;
      case model::Channel::dz_w:
        c(4) = 1.0;
        c(2) = -1.0;
        break;
      case model::Channel::dz_b:
        c(2) = 1.0;
        c(0) = -1.0;
        break;
      default:  // F_w
        c << 0, 0, -k_t, -b_t, k_t - b_t * 2.0 * std::numbers::pi * cut_off;
    }
    return c;
  }
  [[nodiscard]] static double noise(model::Channel channel) {
    switch (channel) {
      case model::Channel::z_r:
        return 2e-5;
      case model::Channel::zdd_b:
      case model::Channel::zdd_w:
        return 0.05;
      case model::Channel::F_w:
        return 10.0;
      default:
        return 5e-5;
    }
  }

  [[nodiscard]] static model::RigParameters<double> rig() {
    model::RigParameters<double> rig;
    rig.body.mass = m_b;
    rig.wheel.mass = m_w;
    rig.tyre = {k_t, b_t};
    rig.suspension = {k_b, b_b};
    return rig;
  }

  /// Settings of a filter with these channels for this car and road.
  [[nodiscard]] static firmware::KalmanSettings settings(const std::vector<model::Channel>& channels) {
    firmware::KalmanSettings settings;
    settings.bandwidth = 0.0;
    settings.cut_off = cut_off;
    for (const model::Channel channel : channels) settings.noise[model::index(channel)] = noise(channel);
    return settings;
  }

  Matrix a, phi, q;
  Vector b;
};

/// Seeded noise.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : generator_(seed) {}
  double operator()() { return distribution_(generator_); }

 private:
  std::mt19937_64 generator_;
  std::normal_distribution<double> distribution_;
};

/// The car in motion, from rest: as runs and recordings of rigs begin, and where the filter begins.
class DrivenCar {
 public:
  explicit DrivenCar(std::uint64_t seed, double period = LinearCar::period)
      : car_(period), normal_(seed), noise_(factor(car_.q)) {}
  void step() { x_ = (car_.phi * x_ + noise_ * draw()).eval(); }
  [[nodiscard]] const LinearCar::Vector& x() const { return x_; }
  [[nodiscard]] const LinearCar& car() const { return car_; }
  [[nodiscard]] double truth(model::Channel channel) const { return car_.row(channel).dot(x_); }
  [[nodiscard]] double reading(model::Channel channel) {
    return truth(channel) + LinearCar::noise(channel) * normal_();
  }

 private:
  [[nodiscard]] static LinearCar::Matrix factor(const LinearCar::Matrix& covariance) {
    const Eigen::SelfAdjointEigenSolver<LinearCar::Matrix> solver(covariance);
    return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  }
  LinearCar::Vector draw() {
    LinearCar::Vector v;
    for (int i = 0; i < 5; ++i) v(i) = normal_();
    return v;
  }

  LinearCar car_;
  Normal normal_;
  LinearCar::Vector x_ = LinearCar::Vector::Zero();
  LinearCar::Matrix noise_;
};

}  // namespace support
