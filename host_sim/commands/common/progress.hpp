// Progress of long work, shown at a terminal.
#pragma once

#include <string>

namespace host_sim {

/// One line on standard error with the time left, updated at most ten times a second; nothing when standard error is
/// not a terminal, or with --quiet. With --verbose a line for each tenth of the work instead, anywhere. The share shown
/// never goes back. The destructor removes the line, also after an exception.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(double share, const std::string& detail = {});  ///< share of the work done, 0 … 1
  void end();                                               ///< removes the line, before something is printed

 private:
  std::string what_;
  bool terminal_;
  double highest_ = 0.0;      // share shown so far
  double last_ = 0.0;         // when something was shown [s]
  double first_ = 0.0;        // when the work began [s]
  double first_share_ = 2.0;  // where it began: a resumed work does not begin at 0
  bool shown_ = false;
};

}  // namespace host_sim
