#include "hal/linux/opened.hpp"

#include <cerrno>
#include <cstring>

namespace hal::linux {

std::string words_of(int error) {
  std::string words = std::strerror(error);
  if (error == EACCES || error == EPERM) {
    words += "; add this user to the group that the udev rule names (README, to the rig), or start as root";
  }
  return words;
}

}  // namespace hal::linux
