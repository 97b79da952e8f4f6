// How far long work has got, for a person at a terminal.
#pragma once

#include <string>

namespace host_sim {

/// One line on standard error that renews itself, at most ten times a second; nothing when standard error is no
/// terminal. The line is wiped when the object dies, whatever happened.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(double share, const std::string& detail = {});  ///< share 0 … 1 of the work that is done

 private:
  std::string what_;
  bool terminal_;
  double last_ = 0.0;  // when something was shown [s]
  bool shown_ = false;
};

}  // namespace host_sim
