// What the paper did with its rigs, done with ours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/trip.hpp"
#include "host_sim/paper/transfer_estimate.hpp"
#include "host_sim/rig_description.hpp"
#include "host_sim/stability/analysis.hpp"
#include "host_sim/stability/frequency_response.hpp"
#include "host_sim/stability/stability_map.hpp"

namespace host_sim::paper {

using stability::Complex;

/// A loop at one setting: what linear analysis says of it.
struct Loop {
  std::string name;
  RigDescription description;
  stability::StabilityAnalysis analysis;
  stability::NyquistData nyquist;
  Complex wheel_root;  ///< the root nearest to the wheel's frequency
};

/// The rig, kicked by a bump of its road, left to itself: through firmware and nonlinear model, without sensor noise.
struct KickedRun {
  std::string name;
  std::vector<double> time, deflection, wheel_acceleration;  ///< [s], [m] at the machine, [m/s²]
  firmware::Trip trip;                                       ///< the road's end, or what the firmware stopped it for
  double predicted{};  ///< growth by the sampled loop: ln|z|/T of its wheel mode [1/s]
  double measured{};   ///< growth in the run, between kick and end [1/s]
};

/// Fig. 3: one variable, the wheel's root of one loop.
struct WheelRootPath {
  std::string name;
  stability::Axis axis;
  std::vector<Complex> roots;
};

/// |F_w/z_r| with delay over without, of the linear loop.
struct WheelLoadGrowth {
  double peak_ratio{};     ///< highest value with over highest value without
  double peak_hz{};        ///< where that with delay lies
  double without_hz{};     ///< where that without lies
  double ratio_at_peak{};  ///< both at peak_hz
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

  RigDescription quarter_car;            ///< force sensor with a mass
  stability::BodeData quarter_car_true;  ///< its linear response, without that mass
  RoadRun rig_run, simulated_run;        ///< as measured, with noise; the rig without its mass and noise
  double absorber_hz{};                  ///< √(k_c/b)/2π with the ducts of the description open [Hz]
};

/// Takes about two seconds; `progress` is called with the share that is done.
[[nodiscard]] Experiments experiment(const std::function<void(double)>& progress = {});

inline constexpr double reported_unstable_damping = 700.0;  ///< b̃ [N s/m]: the paper's section 2
inline constexpr double road_run_seconds = 120.0;

}  // namespace host_sim::paper
