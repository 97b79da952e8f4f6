#include "hal/linux/gpio.hpp"

#include <dirent.h>

#include <algorithm>
#include <string_view>

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

}  // namespace hal::linux
