// What happens on the simulated lines of the guest, timed: a helper of the guest's tests.
//
//   observer press PULL DOWN VALUES… = BITS    writes DOWN (pull-up, pull-down) to the file PULL and says after how
//   long each
//                                            VALUE file shows its one of the BITS, or that they never do
//   observer edges VALUE SECONDS               how often the file changes
//   observer hold CHIP OFFSET…                 takes lines for good, as another program would
#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

long long now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

void pause_for(long ns) {
  const timespec span{ns / 1'000'000'000, ns % 1'000'000'000};
  ::nanosleep(&span, nullptr);
}

char value_of(int file) {
  char value = '?';
  return ::pread(file, &value, 1, 0) == 1 ? value : '?';
}

int press(const std::vector<std::string>& words) {
  const int pull = ::open(words[0].c_str(), O_WRONLY);
  std::vector<int> files;
  std::size_t i = 2;
  for (; words[i] != "="; ++i) files.push_back(::open(words[i].c_str(), O_RDONLY));
  const std::string bits = words[i + 1];
  const long long begin = now();
  if (::write(pull, words[1].data(), words[1].size()) < 0) return 1;
  while (now() - begin < 5'000'000'000LL) {
    bool all = true;
    for (std::size_t j = 0; j < files.size(); ++j) all = all && value_of(files[j]) == bits[j];
    if (all) {
      std::printf("OBSERVED after %lld us\n", (now() - begin) / 1000);
      return 0;
    }
    pause_for(50'000);
  }
  std::printf("OBSERVED never\n");
  return 1;
}

int edges(const std::vector<std::string>& words) {
  const int file = ::open(words[0].c_str(), O_RDONLY);
  const long long end = now() + static_cast<long long>(std::atof(words[1].c_str()) * 1e9);
  char last = value_of(file);
  long count = 0;
  while (now() < end) {
    const char value = value_of(file);
    count += value != last ? 1 : 0;
    last = value;
    pause_for(200'000);
  }
  std::printf("OBSERVED %ld edges\n", count);
  return 0;
}

int hold(const std::vector<std::string>& words) {
  const int chip = ::open(words[0].c_str(), O_RDWR);
  gpio_v2_line_request request{};
  std::strcpy(request.consumer, "somebody-else");
  request.config.flags = GPIO_V2_LINE_FLAG_INPUT;
  for (std::size_t i = 1; i < words.size(); ++i) {
    request.offsets[request.num_lines++] = static_cast<unsigned>(std::atoi(words[i].c_str()));
  }
  if (::ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request) != 0) return 1;
  std::printf("HELD\n");
  std::fflush(stdout);
  ::pause();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 3) return 2;
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  if (words[0] == "press") return press(rest);
  if (words[0] == "edges") return edges(rest);
  return words[0] == "hold" ? hold(rest) : 2;
}
