#include "hal/linux/opened.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hal::linux {

int open_alone(const std::string& path, int flags, std::string& trouble) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0) {
    trouble = path + ": " + words_of(errno);
    return -1;
  }
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  trouble = path + ": " + (errno == EWOULDBLOCK ? "another program drives it; end that program" : words_of(errno));
  ::close(file);
  return -1;
}

std::string words_of(int error) {
  std::string words = std::strerror(error);
  if (error == EACCES || error == EPERM) {
    words += "; add this user to the group that the udev rule names (README, to the rig), or start as root";
  }
  return words;
}

}  // namespace hal::linux
