#include "hal/linux/gpio.hpp"

#include <dirent.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <string_view>

#include "hal/linux/gpio_common.hpp"

namespace hal::linux {

std::vector<std::string> gpio_chip_paths() {
  std::vector<std::string> paths;
  constexpr std::string_view prefix = "gpiochip";
  DIR* folder = ::opendir("/dev");
  if (folder == nullptr) return paths;
  while (const dirent* entry = ::readdir(folder)) {
    const std::string name = entry->d_name;
    if (name.starts_with(prefix)) paths.push_back("/dev/" + name);
  }
  ::closedir(folder);
  std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;  // 10 after 9
  });
  return paths;
}

std::string place_of(const std::string& chip, const std::string& line) {
  return "GPIO line '" + line + "' of chip '" + chip + "'";
}

std::string refusal(const std::string& chip, const std::string& line, const std::string& user, int error) {
  if (error == EBUSY) {
    return place_of(chip, line) + " is busy, held by '" + user + "'; end that program or choose another line";
  }
  return place_of(chip, line) + ": " + words_of(error);
}

Fault fault_of(int error) { return error == EAGAIN || error == EINTR ? Fault::timeout : Fault::disconnected; }

Result<bool> edge_waits(int descriptor) {
  pollfd ready{descriptor, POLLIN, 0};
  while (::poll(&ready, 1, 0) < 0) {
    if (errno != EINTR) return fault_of(errno);
  }
  if ((ready.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return Fault::disconnected;
  return (ready.revents & POLLIN) != 0;
}

}  // namespace hal::linux
