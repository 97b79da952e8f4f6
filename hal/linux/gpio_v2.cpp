// GPIO lines by libgpiod 2.x.
#include <gpiod.h>

#include <array>
#include <cerrno>

#include "hal/linux/gpio.hpp"
#include "hal/linux/gpio_common.hpp"

namespace hal::linux {
namespace {

template <auto release>
struct Release {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Release<gpiod_chip_close>>;
using ChipInfo = std::unique_ptr<gpiod_chip_info, Release<gpiod_chip_info_free>>;
using LineInfo = std::unique_ptr<gpiod_line_info, Release<gpiod_line_info_free>>;
using Request = std::unique_ptr<gpiod_line_request, Release<gpiod_line_request_release>>;
using Settings = std::unique_ptr<gpiod_line_settings, Release<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Release<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Release<gpiod_request_config_free>>;
using Events = std::unique_ptr<gpiod_edge_event_buffer, Release<gpiod_edge_event_buffer_free>>;

std::string label_of(gpiod_chip* chip) {
  const ChipInfo info(::gpiod_chip_get_info(chip));
  return info ? ::gpiod_chip_info_get_label(info.get()) : "";
}

Chip find_chip(const std::string& label, std::string& trouble) {
  std::string seen, closed;
  for (const std::string& path : gpio_chip_paths()) {
    Chip chip(::gpiod_chip_open(path.c_str()));
    if (!chip) {
      closed += "; " + path + ": " + words_of(errno);
      continue;
    }
    const std::string name = label_of(chip.get());
    if (name == label) return chip;
    seen += (seen.empty() ? "" : ", ") + name;
  }
  trouble = "GPIO chip '" + label + "' is not there, found " + (seen.empty() ? "none" : seen) + closed +
            "; see rig_controller --list";
  return nullptr;
}

int find_line(gpiod_chip* chip, const std::string& label, const std::string& name, std::string& trouble) {
  const int offset = ::gpiod_chip_get_line_offset_from_name(chip, name.c_str());
  if (offset < 0) trouble = place_of(label, name) + " is not there; rig_controller --list shows the names";
  return offset;
}

bool is_used(gpiod_chip* chip, unsigned offset, std::string& user) {
  const LineInfo info(::gpiod_chip_get_line_info(chip, offset));
  if (!info || !::gpiod_line_info_is_used(info.get())) return false;
  const char* consumer = ::gpiod_line_info_get_consumer(info.get());
  user = consumer != nullptr ? consumer : "the kernel";
  return true;
}

Request request(gpiod_chip* chip, gpiod_line_config* lines, const std::string& consumer) {
  const RequestConfig config(::gpiod_request_config_new());
  if (!config) return nullptr;
  ::gpiod_request_config_set_consumer(config.get(), consumer.c_str());
  return Request(::gpiod_chip_request_lines(chip, config.get(), lines));
}

}  // namespace

struct OutputLines::Lines {
  Chip chip;
  Request request;
  std::size_t count = 0;
  unsigned first = 0;

  int write(unsigned bits) {
    std::array<gpiod_line_value, capacity> values{};
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = (bits >> i & 1U) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    }
    return ::gpiod_line_request_set_values(request.get(), values.data());
  }
};

OutputLines::OutputLines(std::unique_ptr<Lines> lines) : lines_(std::move(lines)) {}
OutputLines::~OutputLines() { lines_->write(lines_->first); }

Opened<OutputLines> OutputLines::open(const Wanted& wanted) {
  require(!wanted.lines.empty() && wanted.lines.size() <= capacity, "one to eight output lines");
  Opened<OutputLines> opened;
  auto lines = std::make_unique<Lines>();
  lines->first = wanted.first;
  lines->count = wanted.lines.size();
  lines->chip = find_chip(wanted.chip, opened.trouble);
  if (!lines->chip) return opened;
  const Settings settings(::gpiod_line_settings_new());
  const LineConfig config(::gpiod_line_config_new());
  if (!settings || !config) {
    opened.trouble = "GPIO chip '" + wanted.chip + "': " + words_of(errno);
    return opened;
  }
  ::gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  ::gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
  std::array<unsigned, capacity> offsets{};
  for (std::size_t i = 0; i < lines->count; ++i) {
    const int offset = find_line(lines->chip.get(), wanted.chip, wanted.lines[i], opened.trouble);
    if (offset < 0) return opened;
    offsets[i] = static_cast<unsigned>(offset);
    ::gpiod_line_settings_set_output_value(
        settings.get(), (wanted.first >> i & 1U) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
    ::gpiod_line_config_add_line_settings(config.get(), &offsets[i], 1, settings.get());
  }
  lines->request = request(lines->chip.get(), config.get(), wanted.consumer);
  if (!lines->request) {
    const int error = errno;
    std::string user = "the kernel";
    std::size_t guilty = 0;
    for (std::size_t i = 0; i < lines->count; ++i) {
      if (!is_used(lines->chip.get(), offsets[i], user)) continue;
      guilty = i;
      break;
    }
    opened.trouble = refusal(wanted.chip, wanted.lines[guilty], user, error);
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
  Request request;
  Events events;
  unsigned offset = 0;
};

EdgeLine::EdgeLine(std::unique_ptr<Line> line) : line_(std::move(line)) {}
EdgeLine::~EdgeLine() = default;

Opened<EdgeLine> EdgeLine::open(const Wanted& wanted) {
  Opened<EdgeLine> opened;
  auto line = std::make_unique<Line>();
  line->chip = find_chip(wanted.chip, opened.trouble);
  if (!line->chip) return opened;
  const int offset = find_line(line->chip.get(), wanted.chip, wanted.line, opened.trouble);
  if (offset < 0) return opened;
  line->offset = static_cast<unsigned>(offset);
  line->events.reset(::gpiod_edge_event_buffer_new(16));
  const Settings settings(::gpiod_line_settings_new());
  const LineConfig config(::gpiod_line_config_new());
  if (!settings || !config || !line->events) {
    opened.trouble = "GPIO chip '" + wanted.chip + "': " + words_of(errno);
    return opened;
  }
  ::gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  ::gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  ::gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  ::gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
  if (wanted.bias == Bias::pull_up) ::gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_UP);
  if (wanted.bias == Bias::pull_down) ::gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_DOWN);
  ::gpiod_line_config_add_line_settings(config.get(), &line->offset, 1, settings.get());
  line->request = request(line->chip.get(), config.get(), wanted.consumer);
  if (!line->request) {
    const int error = errno;
    std::string user = "the kernel";
    static_cast<void>(is_used(line->chip.get(), line->offset, user));
    opened.trouble = refusal(wanted.chip, wanted.line, user, error);
    return opened;
  }
  opened.device.reset(new EdgeLine(std::move(line)));
  return opened;
}

Result<EdgeLine::State> EdgeLine::read() {
  State state;
  for (;;) {
    const Result<bool> waits = edge_waits(::gpiod_line_request_get_fd(line_->request.get()));
    if (!waits) return waits.fault();
    if (!*waits) break;
    const int taken = ::gpiod_line_request_read_edge_events(line_->request.get(), line_->events.get(), 16);
    if (taken < 0) return fault_of(errno);
    for (int i = 0; i < taken; ++i) {
      gpiod_edge_event* event = ::gpiod_edge_event_buffer_get_event(line_->events.get(), static_cast<unsigned long>(i));
      if (::gpiod_edge_event_get_event_type(event) != GPIOD_EDGE_EVENT_RISING_EDGE || state.active) continue;
      state.active = true;
      state.since = nanoseconds(static_cast<std::int64_t>(::gpiod_edge_event_get_timestamp_ns(event)));
    }
  }
  const gpiod_line_value level = ::gpiod_line_request_get_value(line_->request.get(), line_->offset);
  if (level == GPIOD_LINE_VALUE_ERROR) return fault_of(errno);
  state.now = level == GPIOD_LINE_VALUE_ACTIVE;
  state.active = state.active || state.now;
  return state;
}

std::string list_gpio() {
  std::string text;
  for (const std::string& path : gpio_chip_paths()) {
    const Chip chip(::gpiod_chip_open(path.c_str()));
    const ChipInfo chip_info(chip ? ::gpiod_chip_get_info(chip.get()) : nullptr);
    if (!chip_info) {
      text += path + ": " + words_of(errno) + "\n";
      continue;
    }
    const std::size_t lines = ::gpiod_chip_info_get_num_lines(chip_info.get());
    text += path + " '" + label_of(chip.get()) + "', " + std::to_string(lines) + " lines\n";
    for (unsigned i = 0; i < lines; ++i) {
      const LineInfo info(::gpiod_chip_get_line_info(chip.get(), i));
      if (!info) continue;
      const char* name = ::gpiod_line_info_get_name(info.get());
      std::string user;
      const bool used = is_used(chip.get(), i, user);
      if (name == nullptr && !used) continue;
      text += "  " + std::to_string(i) + " '" + (name != nullptr ? name : "") + "'" +
              (::gpiod_line_info_get_direction(info.get()) == GPIOD_LINE_DIRECTION_OUTPUT ? " output" : " input");
      if (used) text += ", held by '" + user + "'";
      text += "\n";
    }
  }
  return text.empty() ? "no GPIO chip\n" : text;
}

std::string gpio_library() { return std::string("libgpiod ") + ::gpiod_api_version(); }

}  // namespace hal::linux
