// An uncertainty budget: how much each source adds to the uncertainty of an estimate or a prediction.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace host_sim::identification {

/// A budget as the Guide to the Expression of Uncertainty in Measurement has it (JCGM 100:2008, 5.1.2 and 6.2):
///
///   (1)  u_c² = u_noise² + Σ u_calibration² + Σ u_tolerance² + u_discretisation² + u_model²
///   (2)  U = coverage · u_c        half of ci95
///
/// noise: of the sensors and of the input, as it passes the model. tolerance: of a described parameter. discretisation:
/// what the steps of the simulation are off at most, a uniform distribution, so the bound ÷ √3. model: what the residual
/// holds beyond the known noise. coverage is not 1.96 where few blocks determine the variance (Student), where U adds the
/// error of the steps as a bound, or where a tolerance alone holds a parameter (√3 of a uniform distribution).
struct UncertaintyBudget {
  enum class Source : unsigned char { noise, calibration, tolerance, discretisation, model };
  struct Part {
    Source source{};
    std::string of{};       ///< calibration: the channel; tolerance: the parameter
    double standard = 0.0;  ///< [unit of the value]
  };
  double combined = 0.0;  ///< u_c [unit of the value]; 0: there is none
  double coverage = 0.0;
  std::vector<Part> parts{};  ///< the largest first

  [[nodiscard]] double share(const Part& part) const;  ///< of u_c²
};

[[nodiscard]] std::string_view name(UncertaintyBudget::Source source);
/// "calibration of F"
[[nodiscard]] std::string words(const UncertaintyBudget::Part& part);
/// "mostly calibration of F: 68 %"; empty without a part, and where it is noise, as usual.
[[nodiscard]] std::string largest_part(const UncertaintyBudget& budget);

}  // namespace host_sim::identification
