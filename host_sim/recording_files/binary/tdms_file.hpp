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

struct TdmsFile {
  std::vector<TdmsChannel> channels;                         ///< in the order of their first appearance
  std::map<std::string, TdmsValue, std::less<>> properties;  ///< of the file
  bool cut_off = false;                                      ///< the last segment is not complete
};

/// Reads the bytes of a TDMS file. Segments: lead-in (tag "TDSm", contents, version, offsets), metadata (objects with
/// the index of their raw data and properties), raw data (chunks, contiguous or interleaved, of either byte order).
/// Linear and polynomial scales of raw counts are applied. Not read: DAQmx raw data, complex numbers, texts. InputError
/// for bytes that are not such a file or contradict themselves; an incomplete last segment is read up to its last whole
/// chunk.
///
/// Source: National Instruments, "TDMS File Format Internal Structure", 2024.
[[nodiscard]] TdmsFile parse_tdms(std::string_view bytes, std::string_view source);

}  // namespace host_sim
