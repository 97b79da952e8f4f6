#include "firmware/controller/recording/trip_text.hpp"

#include <cstdio>

#include "firmware/description/text/input_error.hpp"

namespace firmware::controller {
namespace {

/// What a trip's value counts: " late periods", " N"; empty for a pure number.
std::string unit_of(const Trip& trip) {
  switch (trip.reason) {
    case Reason::late:
      return " late periods";
    case Reason::gap:
      return " s late";
    case Reason::speed:
    case Reason::measured_speed:
      return " m/s";
    case Reason::stroke:
    case Reason::measured_stroke:
    case Reason::following_error:
      return " m";
    case Reason::acceleration:
      return " m/s²";
    case Reason::arming_read_back:
    case Reason::arming_position:
    case Reason::arming_off_centre:
    case Reason::motion_without_power:
      return " m";
    case Reason::force:
    case Reason::arming_preload:
      return " N";
    default:
      return "";
  }
}

}  // namespace

std::string trip_text(const Trip& trip, const RigDescription& rig) {
  std::string text(name(trip.reason));
  if (trip.interlock >= 0) {
    const auto i = static_cast<std::size_t>(static_cast<unsigned char>(trip.interlock));
    const bool named = rig.hardware.gpio && i < rig.hardware.gpio->interlocks.size();
    return text + " " + (named ? one_line(rig.hardware.gpio->interlocks[i].name) : std::to_string(i + 1));
  }
  if (trip.channel) text += " of " + std::string(model::name(*trip.channel));
  if (!is_fault(trip.reason)) return text;
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, " (%.4g%s, limit %.4g)", trip.value, unit_of(trip).c_str(), trip.limit);
  return text + numbers;
}

std::string refusals_text(const Refusals& refusals, const RigDescription& rig) {
  std::string text;
  for (std::size_t i = 0; i < refusals.size(); ++i) text += (i > 0 ? "; " : "") + trip_text(refusals.at(i), rig);
  return text;
}

}  // namespace firmware::controller
