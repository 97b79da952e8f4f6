// What a device answers: a value, or one of few faults that tell the caller what to do.
#pragma once

#include "hal/require.hpp"

namespace hal {

/// Why a device did not do what was asked, named after what the caller has to do.
enum class Fault : unsigned char {
  timeout,       ///< nothing in time: bridge this period, ask again in the next
  disconnected,  ///< the device is gone: make the rig safe; it must be opened anew before the next start
  refused,       ///< not taken over, so what the device does now is unknown: make the rig safe, write again
};

/// A value of type T, or the fault that kept it away. T has a default value; nothing is allocated, nothing is thrown.
template <class T>
class [[nodiscard]] Result {
 public:
  constexpr Result(const T& value) : value_(value), good_(true) {}
  constexpr Result(Fault fault) : fault_(fault) {}

  [[nodiscard]] constexpr explicit operator bool() const { return good_; }

  /// The value; asking a fault for its value is a broken assumption.
  [[nodiscard]] constexpr const T& operator*() const {
    require(good_, "a result that is a fault has no value");
    return value_;
  }
  [[nodiscard]] constexpr T& operator*() {
    require(good_, "a result that is a fault has no value");
    return value_;
  }
  [[nodiscard]] constexpr const T* operator->() const { return &**this; }

  /// The fault; asking a value for its fault is a broken assumption.
  [[nodiscard]] constexpr Fault fault() const {
    require(!good_, "a result that is a value has no fault");
    return fault_;
  }

 private:
  T value_{};
  Fault fault_ = Fault::timeout;
  bool good_ = false;
};

/// Done, or the fault that kept it from being done. `return {};` says done.
template <>
class [[nodiscard]] Result<void> {
 public:
  constexpr Result() = default;
  constexpr Result(Fault fault) : fault_(fault), good_(false) {}

  [[nodiscard]] constexpr explicit operator bool() const { return good_; }
  [[nodiscard]] constexpr Fault fault() const {
    require(!good_, "a result that is a value has no fault");
    return fault_;
  }

 private:
  Fault fault_ = Fault::timeout;
  bool good_ = true;
};

}  // namespace hal
