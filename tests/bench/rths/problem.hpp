// The real-time hybrid simulation benchmark problem: plant, structure, converters, noise, criteria.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/loop/compensation/compensation.hpp"

namespace rths {

inline constexpr double rate = 4096.0;  ///< [Hz]
inline constexpr double period = 1.0 / rate;

/// A ground acceleration, straight between its samples.
struct Excitation {
  std::vector<double> time;          ///< [s]
  std::vector<double> acceleration;  ///< [m/s²], as recorded; the problem takes 0.4 of it
};
/// CSV with one header line. Throws std::runtime_error with file and line.
[[nodiscard]] Excitation read_excitation(const std::filesystem::path& file);

/// Numerical structure: three floors, lumped masses, modal damping.
struct Case {
  double mass;     ///< of each floor [kg]
  double damping;  ///< of each mode [1]
};
inline constexpr std::array<Case, 4> cases{{{1000.0, 0.05}, {1100.0, 0.04}, {1300.0, 0.03}, {1000.0, 0.03}}};

/// Physical plant: servo valve, actuator and specimen.
///
///   (1)  ÿ = −β₁ ẏ − β₂ y + a₁β₀ (g u − x)
///   (2)  ḟ = y − a₃ f − a₂ v
///   (3)  ẋ = v,  m v̇ = f − c v − k x,  c = 2ζ√(k m)
struct Plant {
  double stiffness = 1.19e6;  ///< k [N/m]
  double beta_1 = 425.0;
  double beta_2 = 9.9976e4;
  double a_3 = 3.3;

  static constexpr double mass = 29.13;            ///< m [kg]
  static constexpr double damping_ratio = 0.0097;  ///< ζ
  static constexpr double gain = 1.0261;           ///< g
  static constexpr double a_1_beta_0 = 2.1283e13;
  static constexpr double a_2 = 4.2297e6;

  [[nodiscard]] double damping() const;  ///< c [N s/m]
};
/// The plant of a seed: each value Gaussian about the nominal one, with the standard deviations of the problem.
[[nodiscard]] Plant perturbed(std::uint64_t seed);
/// 1/M(s) of the plant, u/x = a₀ + a₁ s + a₂ s² + a₃ s³ + …
[[nodiscard]] std::array<double, 4> inverse_of(const Plant& plant);

/// J1 [ms], J2 … J9 [%]; all infinite where the test grew without bound.
struct Criteria {
  std::array<double, 9> values{};
  double largest_force = 0.0;    ///< [N]
  double largest_command = 0.0;  ///< [m]
  double noise_force = 0.0;      ///< rms of what was added to the measured force [N]
  bool stable = true;
};

/// From the compensator's command, or the wanted displacement, to the plant's: a tracking controller of the problem.
enum class Controller : unsigned char {
  none,      ///< u = command
  baseline,  ///< lead, then PI on the tracking error, both by Tustin's rule
};

struct Method {
  std::string name;
  Controller controller = Controller::none;
  std::function<firmware::Compensation*()> compensation{};  ///< a fresh one; nullptr: none. The test deletes it
  bool late_force = true;                                   ///< the problem's force is one step late
};

struct Test {
  std::size_t structure = 0;  ///< index of the case
  Plant plant{};
  std::uint64_t seed = 1;  ///< of the noise
};

/// One test: the whole excitation at 4096 Hz. The structure takes the force measured a step before, held for a step.
[[nodiscard]] Criteria run(const Excitation& excitation, const Test& test, const Method& method);

}  // namespace rths
