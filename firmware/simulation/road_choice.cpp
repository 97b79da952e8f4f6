#include "firmware/simulation/road_choice.hpp"

#include <cmath>
#include <string_view>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"

namespace firmware {

FootPointMotion motion_over(const RoadChoice& choice, const RigDescription& rig, std::size_t samples,
                            RecordingReader read) {
  constexpr std::string_view standard = "iso8608:";
  if (!choice.road.starts_with(standard)) {
    if (choice.bandwidth || choice.cut_off) {
      throw UsageError("--bandwidth and --cut-off shape an ISO 8608 road, expected neither with a road from a file");
    }
    return road_from_file(choice.road, choice.speed, rig.sample_rate, samples, read);
  }
  IsoRoad road;
  road.roughness = class_roughness(choice.road.substr(standard.size()));
  road.speed = choice.speed;
  road.cut_off = choice.cut_off.value_or(road.cut_off);
  road.seed = choice.seed;
  road.bandwidth = choice.bandwidth.value_or(default_bandwidth(rig.rig, rig.sample_rate));
  if (road.bandwidth > 0.2 * rig.sample_rate) {
    throw UsageError("--bandwidth is above a fifth of the sample rate, expected at most " +
                     shortest(0.2 * rig.sample_rate) + " Hz for this rig");
  }
  if (!(road.cut_off < road.bandwidth)) {
    throw UsageError("--cut-off " + shortest(road.cut_off) + " leaves nothing of the road, expected less than its " +
                     "bandwidth, " + shortest(road.bandwidth) + " Hz");
  }
  return drive_over(road, rig.sample_rate, samples);
}

FootPointMotion run_motion(const RoadChoice& choice, const RigDescription& rig, std::size_t samples,
                           RecordingReader read) {
  const bool file = !choice.road.starts_with("iso8608:") && !choice.bandwidth && !choice.cut_off;
  if (!file) return excitation(rig.rig, motion_over(choice, rig, samples, read), rig.sample_rate);
  RoadOrCommand made = road_or_command(choice.road, rig.rig.kind, choice.speed, rig.sample_rate, samples, read);
  return made.command ? std::move(made.motion) : excitation(rig.rig, std::move(made.motion), rig.sample_rate);
}

std::size_t samples_of(double duration, double sample_rate) {
  constexpr double most = 1e7;  // about 200 bytes a sample
  const double wanted = duration * sample_rate;
  if (!(wanted >= 1.0 && wanted <= most)) {
    throw UsageError("--duration " + shortest(duration) + " does not fit, expected " + shortest(1.0 / sample_rate) +
                     " to " + shortest(most / sample_rate) + " s at the sample rate of this rig");
  }
  return static_cast<std::size_t>(std::llround(wanted));
}

}  // namespace firmware
