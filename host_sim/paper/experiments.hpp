// The paper's experiments, computed from the shipped rigs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/trip.hpp"
#include "host_sim/paper/transfer_estimate.hpp"
#include "host_sim/stability/map/stability_map.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"

namespace host_sim::paper {

using stability::Complex;

/// Linear analysis of a loop at one setting.
struct Loop {
  std::string name;
  firmware::RigDescription description;
  stability::StabilityAnalysis analysis;
  stability::NyquistData nyquist;
  Complex wheel_root;  ///< the root nearest to the wheel's frequency
};

/// Free decay or growth after a bump of the road: firmware and nonlinear model, without sensor noise.
struct KickedRun {
  std::string name;
  std::vector<double> time, deflection, wheel_acceleration;  ///< [s], [m] at the machine, [m/s²]
  firmware::Trip trip;  ///< the end of the road, or the reason of the firmware's stop
  double predicted{};   ///< growth rate of the sampled loop: ln|z|/T of its wheel mode [1/s]
  double measured{};    ///< growth rate of the run between kick and end [1/s]
};

/// Fig. 3: the wheel root of one loop over one variable.
struct WheelRootPath {
  std::string name;
  stability::Axis axis;
  std::vector<Complex> roots;
};

/// |F_w/z_r| with delay divided by that without delay, linear loop.
struct WheelLoadGrowth {
  double peak_ratio{};     ///< peak with delay divided by peak without
  double peak_hz{};        ///< frequency of the peak with delay
  double without_hz{};     ///< frequency of the peak without delay
  double ratio_at_peak{};  ///< ratio at peak_hz
};

/// Responses estimated from a run over a road.
struct RoadRun {
  std::string name;
  TransferEstimate wheel_load, second;  ///< F_w ÷ z_r; hil: z̈_b ÷ z_r, quarter_car: soft sensor ÷ z_r
};

struct Experiments {
  Loop linear;           ///< Eqs. (1)–(3), Table 1, 10 ms
  Loop absorber;         ///< FDVA, b̃ = 1140 N s/m
  Loop absorber_at_700;  ///< FDVA, b̃ = 700 N s/m
  std::vector<WheelRootPath> over_damping, over_delay;
  stability::StabilityMap map;  ///< of the absorber over τ and b̃

  std::vector<double> frequency_hz;
  stability::BodeData late, ideal;  ///< absorber at 1140 N s/m with its delay, and without any
  WheelLoadGrowth growth;
  RoadRun late_run, ideal_run;  ///< the same two as nonlinear runs over a class B road
  std::vector<KickedRun> kicks;

  firmware::RigDescription quarter_car;  ///< force sensor with a mass
  stability::BodeData quarter_car_true;  ///< its linear response, without that mass
  RoadRun rig_run, simulated_run;        ///< as measured, with noise; the rig without its mass and noise
  double absorber_hz{};                  ///< √(k_c/b)/2π with the ducts of the description open [Hz]
};

/// Computes all experiments in about two seconds; `progress` is called with the share that is done.
[[nodiscard]] Experiments experiment(const std::function<void(double)>& progress = {});

inline constexpr double reported_unstable_damping = 700.0;  ///< b̃ [N s/m]: the paper's section 2
inline constexpr double road_run_seconds = 120.0;

}  // namespace host_sim::paper
