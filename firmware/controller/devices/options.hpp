// What rig_controller is told on its command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace firmware::controller {

struct Options {
  enum class Task : unsigned char { run, check, list, ask, help, version, unit_times };
  Task task = Task::run;
  std::string rig;
  std::string out;
  std::string histogram;  ///< a file for what the loop took; empty: none
  std::string road = "iso8608:B";
  double speed = 27.78;    ///< [m/s]
  double duration = 60.0;  ///< [s]
  std::uint64_t seed = 1;
  bool realtime = true;
  bool simulated = false;           ///< the rig's model instead of devices
  bool virtual_time = false;        ///< simulated, and nobody sleeps
  bool start = false;               ///< arm and start at once, without an operator at the socket
  bool wait = false;                ///< for the operator, with a simulated rig too
  std::string socket;               ///< of the operator; empty: the usual one, if the program waits
  std::string request;              ///< to the program that listens there, Task::ask
  bool overwrite = false;           ///< an earlier recording
  double part_minutes = 0.0;        ///< length of a part of the recording [min]; 0: one part
  std::uint64_t cycles = 1;         ///< of the road; 0: without end
  std::string programme;            ///< file of blocks in place of one road; empty: none
  std::string replay;               ///< the recording in place of devices; empty: none
  std::string publish;              ///< address for UDP datagrams; empty: none
  bool publish_remote = false;      ///< that address may be another machine
  std::uint64_t publish_every = 1;  ///< of so many periods one is published
  std::optional<double> bandwidth;  ///< of an ISO 8608 road [Hz]
  std::optional<double> cut_off;    ///< of an ISO 8608 road [Hz]
};

/// The options, or in `trouble` the line that says what is wrong.
[[nodiscard]] Options read_options(int argc, char** argv, std::string& trouble);

extern const char* const usage;

}  // namespace firmware::controller
