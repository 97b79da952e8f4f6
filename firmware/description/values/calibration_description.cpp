#include "firmware/description/values/calibration_description.hpp"

namespace firmware {

std::vector<std::string> certificate_objections(const Calibrations& calibrations, const CalendarDate& recorded) {
  std::vector<std::string> objections;
  for (std::size_t c = 0; c < calibrations.size(); ++c) {
    if (!calibrations[c]) continue;
    const CalibrationDescription& one = *calibrations[c];
    const std::string channel(model::name(model::channel_at(c)));
    const std::string certificate =
        "the certificate " + (one.certificate.empty() ? "" : one.certificate + " ") + "of " + channel;
    if (one.valid_until && *one.valid_until < recorded) {
      objections.push_back(certificate + " expired on " + date_text(*one.valid_until) + ", before the recording (" +
                           date_text(recorded) + ")");
    }
    if (one.date && recorded < *one.date) {
      objections.push_back(certificate + " is of " + date_text(*one.date) + ", after the recording (" +
                           date_text(recorded) + ")");
    }
    if (!one.certificate_serial.empty() && one.certificate_serial != one.serial) {
      objections.push_back(certificate + " is foreign: it is for the sensor " + one.certificate_serial + ", but " +
                           one.serial + " is fitted");
    }
    if (one.certificate_channel && model::index(*one.certificate_channel) != c) {
      objections.push_back(certificate + " is foreign: it is for the channel " +
                           std::string(model::name(*one.certificate_channel)));
    }
  }
  return objections;
}

}  // namespace firmware
