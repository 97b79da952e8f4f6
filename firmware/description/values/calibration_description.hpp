// What a calibration certificate says of the sensor of a channel: [calibration.CHANNEL].
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/text/calendar_date.hpp"
#include "model/components/channel.hpp"

namespace firmware {

/// A sensor reads (1 + δ) · truth + o. The certificate bounds both by expanded uncertainties, k standard deviations each
/// (JCGM 100:2008, 6.2).
struct CalibrationDescription {
  double gain = 0.0;    ///< of δ, relative
  double offset = 0.0;  ///< of o [SI]
  double k = 2.0;       ///< coverage factor of both
  std::optional<CalendarDate> date, valid_until;
  std::string certificate;                              ///< its number
  std::string serial;                                   ///< of the sensor that is fitted
  std::string certificate_serial;                       ///< of the sensor that the certificate is for
  std::optional<model::Channel> certificate_channel{};  ///< that the certificate is for

  [[nodiscard]] double standard_gain() const { return gain / k; }      ///< standard deviation of δ
  [[nodiscard]] double standard_offset() const { return offset / k; }  ///< of o [SI]
};

/// By model::Channel; nullopt: nothing is known of the sensor's calibration.
using Calibrations = std::array<std::optional<CalibrationDescription>, model::channel_count>;

/// Why a certificate does not speak of this sensor on that day, one sentence each without a full stop; empty: it does.
///
///   expired   valid_until < recorded
///   early     recorded < date
///   foreign   another serial number than that of the sensor, or another channel than that of the table
[[nodiscard]] std::vector<std::string> certificate_objections(const Calibrations& calibrations,
                                                              const CalendarDate& recorded);

}  // namespace firmware
