// A device that was opened, or why not.
#pragma once

#include <memory>
#include <string>

namespace hal::linux {

/// Opening may take heap and time; what comes of it is a device, or one line that says what is wrong and what to do.
template <class T>
struct Opened {
  std::unique_ptr<T> device;
  std::string trouble;  ///< empty when there is a device

  [[nodiscard]] explicit operator bool() const { return device != nullptr; }
};

/// A file of a device, opened for this program alone from here until it is closed (flock). −1: `trouble` says why;
/// another program that drives the same output is one reason.
[[nodiscard]] int open_alone(const std::string& path, int flags, std::string& trouble);

/// "No such device (ENODEV)" and the like become words; a missing permission also what to do about it.
[[nodiscard]] std::string words_of(int error);

}  // namespace hal::linux
