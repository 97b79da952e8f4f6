#include "firmware/controller/instance.hpp"

#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

#include "firmware/description/text/sha256.hpp"
#include "hal/linux/clock.hpp"

namespace firmware::controller {
namespace {

/// Letters, digits, '-' and '.', at most 64: what a host name may have, whatever the kernel was told.
std::string host_name() {
  std::array<char, 65> text{};
  if (::gethostname(text.data(), text.size() - 1) != 0) return "unknown";
  std::string name(text.data());
  const auto unusual = [](char c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return !letter && !(c >= '0' && c <= '9') && c != '-' && c != '.';
  };
  std::replace_if(name.begin(), name.end(), unusual, '_');
  return name.empty() ? "unknown" : name;
}

}  // namespace

std::string new_instance(const RigDescription& rig) {
  std::uint64_t run = 0;
  if (::getrandom(&run, sizeof run, GRND_NONBLOCK) != static_cast<ssize_t>(sizeof run)) {
    // Early after boot: process and time differ as well.
    run = static_cast<std::uint64_t>(hal::linux::MonotonicClock().now().ns) * 4'194'304U +
          static_cast<std::uint64_t>(::getpid());
  }
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(run));
  return sha256(rig.text).substr(0, 12) + "." + digits.data() + "@" + host_name();
}

}  // namespace firmware::controller
