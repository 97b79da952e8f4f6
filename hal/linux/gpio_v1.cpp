// GPIO lines by libgpiod 1.6.
#include <gpiod.h>

#include <array>
#include <cerrno>

#include "hal/linux/gpio.hpp"
#include "hal/linux/gpio_common.hpp"

namespace hal::linux {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { ::gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

Chip find_chip(const std::string& label, std::string& trouble) {
  std::string seen, closed;
  for (const std::string& path : gpio_chip_paths()) {
    Chip chip(::gpiod_chip_open(path.c_str()));
    if (!chip) {
      closed += "; " + path + ": " + words_of(errno);
      continue;
    }
    const std::string name = ::gpiod_chip_label(chip.get());
    if (name == label) return chip;
    seen += (seen.empty() ? "" : ", ") + name;
  }
  trouble = "GPIO chip '" + label + "' is not there, found " + (seen.empty() ? "none" : seen) + closed +
            "; see rig_controller --list";
  return nullptr;
}

gpiod_line* find_line(gpiod_chip* chip, const std::string& label, const std::string& name, std::string& trouble) {
  gpiod_line* line = ::gpiod_chip_find_line(chip, name.c_str());
  if (line == nullptr) trouble = place_of(label, name) + " is not there; rig_controller --list shows the names";
  return line;
}

std::string user_of(gpiod_line* line) {
  const char* user = ::gpiod_line_consumer(line);
  return user != nullptr ? user : "the kernel";
}

}  // namespace

struct OutputLines::Lines {
  Chip chip;
  gpiod_line_bulk bulk{};
  unsigned first = 0;

  int write(unsigned bits) {
    std::array<int, capacity> values{};
    for (unsigned i = 0; i < bulk.num_lines; ++i) values[i] = static_cast<int>(bits >> i & 1U);
    return ::gpiod_line_set_value_bulk(&bulk, values.data());
  }
};

OutputLines::OutputLines(std::unique_ptr<Lines> lines) : lines_(std::move(lines)) {}

OutputLines::~OutputLines() {
  lines_->write(lines_->first);
  ::gpiod_line_release_bulk(&lines_->bulk);
}

Opened<OutputLines> OutputLines::open(const Wanted& wanted) {
  require(!wanted.lines.empty() && wanted.lines.size() <= capacity, "one to eight output lines");
  Opened<OutputLines> opened;
  auto lines = std::make_unique<Lines>();
  lines->first = wanted.first;
  lines->chip = find_chip(wanted.chip, opened.trouble);
  if (!lines->chip) return opened;
  ::gpiod_line_bulk_init(&lines->bulk);
  std::array<int, capacity> values{};
  for (std::size_t i = 0; i < wanted.lines.size(); ++i) {
    gpiod_line* line = find_line(lines->chip.get(), wanted.chip, wanted.lines[i], opened.trouble);
    if (line == nullptr) return opened;
    ::gpiod_line_bulk_add(&lines->bulk, line);
    values[i] = static_cast<int>(wanted.first >> i & 1U);
  }
  gpiod_line_request_config config{};
  config.consumer = wanted.consumer.c_str();
  config.request_type = GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
  config.flags = wanted.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (::gpiod_line_request_bulk(&lines->bulk, &config, values.data()) != 0) {
    const int error = errno;
    for (std::size_t i = 0; i < wanted.lines.size(); ++i) {  // whose fault? the one that is taken
      gpiod_line* line = lines->bulk.lines[i];
      if (opened.trouble.empty() || ::gpiod_line_is_used(line)) {
        opened.trouble = refusal(wanted.chip, wanted.lines[i], user_of(line), error);
      }
      if (::gpiod_line_is_used(line)) break;
    }
    return opened;
  }
  opened.device.reset(new OutputLines(std::move(lines)));
  return opened;
}

Result<void> OutputLines::write(unsigned bits) {
  if (lines_->write(bits) != 0) return fault_of(errno);
  return {};
}

struct EdgeLine::Line {
  Chip chip;
  gpiod_line* line = nullptr;
  int descriptor = -1;
};

EdgeLine::EdgeLine(std::unique_ptr<Line> line) : line_(std::move(line)) {}
EdgeLine::~EdgeLine() { ::gpiod_line_release(line_->line); }

Opened<EdgeLine> EdgeLine::open(const Wanted& wanted) {
  Opened<EdgeLine> opened;
  auto line = std::make_unique<Line>();
  line->chip = find_chip(wanted.chip, opened.trouble);
  if (!line->chip) return opened;
  line->line = find_line(line->chip.get(), wanted.chip, wanted.line, opened.trouble);
  if (line->line == nullptr) return opened;
  int flags = wanted.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (wanted.bias == Bias::pull_up) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
  if (wanted.bias == Bias::pull_down) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  if (::gpiod_line_request_both_edges_events_flags(line->line, wanted.consumer.c_str(), flags) != 0) {
    const int error = errno;
    opened.trouble = refusal(wanted.chip, wanted.line, user_of(line->line), error);
    return opened;
  }
  line->descriptor = ::gpiod_line_event_get_fd(line->line);
  opened.device.reset(new EdgeLine(std::move(line)));
  return opened;
}

Result<EdgeLine::State> EdgeLine::read() {
  State state;
  for (;;) {
    const Result<bool> waits = edge_waits(line_->descriptor);
    if (!waits) return waits.fault();
    if (!*waits) break;
    gpiod_line_event event{};
    if (::gpiod_line_event_read_fd(line_->descriptor, &event) != 0) return fault_of(errno);
    if (event.event_type != GPIOD_LINE_EVENT_RISING_EDGE || state.active) continue;
    state.active = true;
    state.since = nanoseconds(static_cast<std::int64_t>(event.ts.tv_sec) * 1'000'000'000 + event.ts.tv_nsec);
  }
  const int level = ::gpiod_line_get_value(line_->line);
  if (level < 0) return fault_of(errno);
  state.now = level == 1;
  state.active = state.active || state.now;
  return state;
}

std::string list_gpio() {
  std::string text;
  for (const std::string& path : gpio_chip_paths()) {
    const Chip chip(::gpiod_chip_open(path.c_str()));
    if (!chip) {
      text += path + ": " + words_of(errno) + "\n";
      continue;
    }
    text += path + " '" + ::gpiod_chip_label(chip.get()) + "', " + std::to_string(::gpiod_chip_num_lines(chip.get())) +
            " lines\n";
    for (unsigned i = 0; i < ::gpiod_chip_num_lines(chip.get()); ++i) {
      gpiod_line* line = ::gpiod_chip_get_line(chip.get(), i);
      if (line == nullptr) continue;
      const char* name = ::gpiod_line_name(line);
      const char* user = ::gpiod_line_consumer(line);
      if (name == nullptr && user == nullptr) continue;
      text += "  " + std::to_string(i) + " '" + (name != nullptr ? name : "") + "'" +
              (::gpiod_line_direction(line) == GPIOD_LINE_DIRECTION_OUTPUT ? " output" : " input");
      if (user != nullptr) text += std::string(", held by '") + user + "'";
      text += "\n";
    }
  }
  return text.empty() ? "no GPIO chip\n" : text;
}

std::string gpio_library() { return std::string("libgpiod ") + ::gpiod_version_string(); }

}  // namespace hal::linux
