// NI TDMS files by their published layout.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// A property's value: a number or a text. Time stamps are seconds since 1904-01-01 UTC.
struct TdmsValue {
  bool is_number = false;
  double number = 0.0;
  std::string text{};
};

/// One channel with the data of all segments.
struct TdmsChannel {
  std::string group;
  std::string name;
  std::map<std::string, TdmsValue, std::less<>> properties;
  std::vector<double> values;  ///< scaled; time stamps in seconds from `first_second`
  bool is_time_stamp = false;
  std::int64_t first_second = 0;  ///< whole seconds since 1904-01-01 UTC of the first time stamp
  std::string unreadable{};       ///< why the channel has no values: "text", "a scale of type Table"; empty: it has
};

using TdmsProperties = std::map<std::string, TdmsValue, std::less<>>;

struct TdmsFile {
  std::vector<TdmsChannel> channels;                          ///< in the order of their first appearance
  TdmsProperties properties;                                  ///< of the file
  std::map<std::string, TdmsProperties, std::less<>> groups;  ///< properties of the groups
  bool cut_off = false;                                       ///< the last segment is not complete
};

/// Reads the bytes of a TDMS file. Segments: lead-in (tag "TDSm", contents, version, offsets), metadata (objects with
/// the index of their raw data and properties), raw data (chunks, contiguous or interleaved, of either byte order).
/// DAQmx raw data are read by their scalers. Scales of raw counts stand on the channel, its group or the file; each
/// takes the raw counts or the result of another scale (Input_Source), and the last one is the value:
///
///   Linear  y = slope x + intercept     Polynomial  y = Σ cᵢ xⁱ     Table  linear between points     Add, Subtract
///
/// Not read: complex numbers, texts, other scales. InputError for bytes that are not such a file or contradict
/// themselves; of an incomplete last chunk each channel has what is there.
///
/// Source: National Instruments, "TDMS File Format Internal Structure", 2024; scales as npTDMS describes them (A.
/// Reeve, documentation, "DAQmx data and scaling").
[[nodiscard]] TdmsFile parse_tdms(std::string_view bytes, std::string_view source);

}  // namespace host_sim
