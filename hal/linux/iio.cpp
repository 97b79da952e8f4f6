#include "hal/linux/iio.hpp"

#include <fcntl.h>
#include <iio.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "hal/linux/converter_ends.hpp"

namespace hal::linux {
namespace {

struct CloseContext {
  void operator()(iio_context* context) const { ::iio_context_destroy(context); }
};
using Context = std::unique_ptr<iio_context, CloseContext>;

struct CloseBuffer {
  void operator()(iio_buffer* buffer) const { ::iio_buffer_destroy(buffer); }
};

std::string names_of(const iio_context* context, bool triggers) {
  std::string names;
  for (unsigned i = 0; i < ::iio_context_get_devices_count(context); ++i) {
    const iio_device* device = ::iio_context_get_device(context, i);
    if (::iio_device_is_trigger(device) != triggers) continue;
    const char* name = ::iio_device_get_name(device);
    names += (names.empty() ? "" : ", ") + std::string(name != nullptr ? name : ::iio_device_get_id(device));
  }
  return names.empty() ? "none" : names;
}

/// An id such as iio:device0 is one already; a name has to be looked up.
iio_device* find(const Context& context, const std::string& name, bool trigger, std::string& trouble) {
  iio_device* device = ::iio_context_find_device(context.get(), name.c_str());
  if (device != nullptr && ::iio_device_is_trigger(device) == trigger) return device;
  trouble = std::string(trigger ? "trigger '" : "converter '") + name + "' is not there, found " +
            names_of(context.get(), trigger) + "; see rig_controller --list";
  return nullptr;
}

Context open_context(std::string& trouble) {
  Context context(::iio_create_local_context());
  if (!context) trouble = "converters (libiio): " + words_of(errno) + "; does this kernel have IIO devices?";
  return context;
}

std::string place(const std::string& device, const std::string& channel) {
  return "converter '" + device + "', channel '" + channel + "'";
}

/// A program that was killed leaves its capture running, and the converter would take no trigger. False: somebody alive
/// captures it.
bool end_orphaned_capture(iio_device* device) {
  const std::string path = std::string("/dev/") + ::iio_device_get_id(device);
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return errno != EBUSY;
  ::close(file);
  static_cast<void>(::iio_device_buffer_attr_write_bool(device, "enable", false));
  return true;
}

iio_channel* find_channel(iio_device* device, const std::string& name, const std::string& id, bool output,
                          std::string& trouble) {
  iio_channel* channel = ::iio_device_find_channel(device, id.c_str(), output);
  if (channel == nullptr) trouble = place(name, id) + " is not there; see rig_controller --list";
  return channel;
}

}  // namespace

struct IioConverters::Capture {
  struct Source {
    iio_channel* channel;
    Input input;
    Reading newest{};
  };
  struct Device {
    iio_device* device;
    std::unique_ptr<iio_buffer, CloseBuffer> buffer{};
    iio_channel* stamp = nullptr;
    std::vector<Source> sources{};
  };

  Context context;
  std::vector<Device> devices;

  /// One sample from the kernel's queue into the sources.
  static void take(Device& device, Time now);
};

IioConverters::IioConverters(std::unique_ptr<Capture> capture) : capture_(std::move(capture)) {}
IioConverters::~IioConverters() {
  for (auto& device : capture_->devices) device.buffer.reset();  // before the context
}

Opened<IioConverters> IioConverters::open(const Wanted& wanted) {
  Opened<IioConverters> opened;
  auto capture = std::make_unique<Capture>();
  capture->context = open_context(opened.trouble);
  if (!capture->context) return opened;

  iio_device* trigger = nullptr;
  if (!wanted.trigger.empty()) {
    trigger = find(capture->context, wanted.trigger, true, opened.trouble);
    if (trigger == nullptr) return opened;
    if (wanted.rate > 0.0) {
      const long long whole = std::llround(wanted.rate);
      const int set = ::iio_device_attr_write_longlong(trigger, "sampling_frequency", whole);
      if (set < 0) {
        opened.trouble =
            "trigger '" + wanted.trigger + "' does not take " + std::to_string(whole) + " Hz: " + words_of(-set);
        return opened;
      }
    }
  }
  for (const Input& input : wanted.inputs) {
    iio_device* device = find(capture->context, input.device, false, opened.trouble);
    if (device == nullptr) return opened;
    iio_channel* channel = find_channel(device, input.device, input.input, false, opened.trouble);
    if (channel == nullptr) return opened;
    ::iio_channel_enable(channel);
    Capture::Device* known = nullptr;
    for (auto& d : capture->devices) {
      if (d.device == device) known = &d;
    }
    if (known == nullptr) {
      capture->devices.push_back({device});
      known = &capture->devices.back();
    }
    known->sources.push_back({channel, input});
  }
  for (auto& device : capture->devices) {
    const std::string& name = device.sources.front().input.device;
    if (!end_orphaned_capture(device.device)) {
      opened.trouble = "converter '" + name + "' is captured by another program; end that program";
      return opened;
    }
    // An older kernel has no such attribute and stamps by the time of day: ages would then be nonsense and show it.
    static_cast<void>(::iio_device_attr_write(device.device, "current_timestamp_clock", "monotonic"));
    device.stamp = ::iio_device_find_channel(device.device, "timestamp", false);
    if (device.stamp != nullptr) ::iio_channel_enable(device.stamp);
    if (trigger != nullptr) {
      const int set = ::iio_device_set_trigger(device.device, trigger);
      if (set < 0) {
        opened.trouble =
            "converter '" + name + "' does not take the trigger '" + wanted.trigger + "': " + words_of(-set);
        return opened;
      }
    }
  }
  for (auto& device : capture->devices) {
    device.buffer.reset(::iio_device_create_buffer(device.device, 1, false));
    if (!device.buffer) {
      const int error = errno;
      opened.trouble = "converter '" + device.sources.front().input.device +
                       "' cannot be captured: " + words_of(error) +
                       (error == EBUSY ? "; another program captures it" : "");
      for (auto& d : capture->devices) d.buffer.reset();
      return opened;
    }
    static_cast<void>(::iio_buffer_set_blocking_mode(device.buffer.get(), false));
  }
  opened.device.reset(new IioConverters(std::move(capture)));
  return opened;
}

void IioConverters::Capture::take(Device& device, Time now) {
  Time taken = now;
  if (device.stamp != nullptr) {
    std::int64_t stamp = 0;
    ::iio_channel_convert(device.stamp, &stamp, ::iio_buffer_first(device.buffer.get(), device.stamp));
    taken = nanoseconds(stamp);
  }
  for (Source& source : device.sources) {
    const void* from = ::iio_buffer_first(device.buffer.get(), source.channel);
    const iio_data_format* format = ::iio_channel_get_data_format(source.channel);
    double counts = 0.0;
    if (format->length <= 8) {
      std::int8_t n = 0;
      ::iio_channel_convert(source.channel, &n, from);
      counts = format->is_signed ? n : static_cast<std::uint8_t>(n);
    } else if (format->length <= 16) {
      std::int16_t n = 0;
      ::iio_channel_convert(source.channel, &n, from);
      counts = format->is_signed ? n : static_cast<std::uint16_t>(n);
    } else if (format->length <= 32) {
      std::int32_t n = 0;
      ::iio_channel_convert(source.channel, &n, from);
      counts = format->is_signed ? n : static_cast<std::uint32_t>(n);
    } else {
      std::int64_t n = 0;
      ::iio_channel_convert(source.channel, &n, from);
      counts = static_cast<double>(n);
    }
    const bool end = at_end_of_converter(counts, format->bits, format->is_signed);
    source.newest = {source.input.scale * counts + source.input.offset, taken,  // (1)
                     end ? Quality::clipped : Quality::good};
  }
}

Result<void> IioConverters::read(Frame& frame, Time now) {
  for (auto& device : capture_->devices) {
    for (int i = 0; i < 8; ++i) {  // more have no place in the kernel's queue
      const ssize_t got = ::iio_buffer_refill(device.buffer.get());
      if (got == -EAGAIN || got == -ETIMEDOUT || got == -EINTR) break;
      if (got <= 0) return Fault::disconnected;
      Capture::take(device, now);
    }
    for (const auto& source : device.sources) frame.channels[source.input.channel] = source.newest;
  }
  return {};
}

IioOutput::~IioOutput() { ::close(file_); }

Opened<IioOutput> IioOutput::open(const Wanted& wanted) {
  Opened<IioOutput> opened;
  const Context context = open_context(opened.trouble);
  if (!context) return opened;
  iio_device* device = find(context, wanted.device, false, opened.trouble);
  if (device == nullptr) return opened;
  iio_channel* channel = find_channel(device, wanted.device, wanted.output, true, opened.trouble);
  if (channel == nullptr) return opened;
  const char* attribute = ::iio_channel_attr_get_filename(channel, "raw");
  if (attribute == nullptr) {
    opened.trouble = place(wanted.device, wanted.output) + " has no raw value to write";
    return opened;
  }
  const std::string path = std::string("/sys/bus/iio/devices/") + ::iio_device_get_id(device) + "/" + attribute;
  const bool readable = ::access(path.c_str(), R_OK) == 0 || errno != EACCES;  // else it cannot be read back
  const int file = open_alone(path, readable ? O_RDWR : O_WRONLY, opened.trouble);
  if (file < 0) return opened;
  opened.device.reset(new IioOutput(wanted, file));
  return opened;
}

Result<void> IioOutput::write(double value) {
  long counts = std::lround((value - wanted_.offset) / wanted_.scale);
  if (counts < wanted_.lowest_counts) counts = wanted_.lowest_counts;
  if (counts > wanted_.highest_counts) counts = wanted_.highest_counts;
  char text[24];
  const auto end = std::to_chars(text, text + sizeof text, counts);
  const ssize_t size = end.ptr - text;
  for (;;) {
    if (::pwrite(file_, text, static_cast<std::size_t>(size), 0) == size) return {};
    if (errno == EINTR) continue;
    return errno == EAGAIN || errno == EBUSY ? Fault::timeout : Fault::disconnected;
  }
}

Result<double> IioOutput::read_back() const {
  char text[24];
  ssize_t size = -1;
  do {
    size = ::pread(file_, text, sizeof text, 0);
  } while (size < 0 && errno == EINTR);
  if (size < 0) return errno == ENODEV ? Fault::disconnected : Fault::refused;
  long counts = 0;
  if (std::from_chars(text, text + size, counts).ec != std::errc{}) return Fault::refused;
  return wanted_.scale * static_cast<double>(counts) + wanted_.offset;
}

IioCommand::IioCommand(const Wanted& wanted, Clock& clock, std::unique_ptr<IioOutput> output)
    : longest_(wanted.bounds.period), clock_(clock), output_(std::move(output)), limit_(wanted.bounds, wanted.rest) {
  const Result<double> shown = output_->read_back();
  if (shown && *shown >= wanted.bounds.lowest && *shown <= wanted.bounds.highest) {
    limit_ = CommandLimit(wanted.bounds, *shown);
  }
}

Opened<IioCommand> IioCommand::open(const Wanted& wanted, Clock& clock) {
  auto output = IioOutput::open(wanted.output);
  if (!output) return {nullptr, output.trouble};
  return {std::unique_ptr<IioCommand>(new IioCommand(wanted, clock, std::move(output.device))), {}};
}

Result<void> IioCommand::do_write(const Command& command) {
  const Time now = clock_.now();
  const double dt = last_ == never ? longest_ : (now - last_).seconds();
  last_ = now;
  return output_->write(limit_.limit(command.position, dt));
}

Opened<IioArea> IioArea::open(const IioOutput::Wanted& wanted) {
  auto output = IioOutput::open(wanted);
  if (!output) return {nullptr, output.trouble};
  if (!output.device->write(0.0)) return {nullptr, place(wanted.device, wanted.output) + " takes no value"};
  return {std::unique_ptr<IioArea>(new IioArea(std::move(output.device))), {}};
}

std::string list_iio() {
  std::string trouble;
  const Context context = open_context(trouble);
  if (!context) return trouble + "\n";
  std::string text;
  for (unsigned i = 0; i < ::iio_context_get_devices_count(context.get()); ++i) {
    const iio_device* device = ::iio_context_get_device(context.get(), i);
    const char* name = ::iio_device_get_name(device);
    text += std::string(::iio_device_is_trigger(device) ? "trigger " : "converter ") + ::iio_device_get_id(device) +
            " '" + (name != nullptr ? name : "") + "'\n";
    for (unsigned j = 0; j < ::iio_device_get_channels_count(device); ++j) {
      const iio_channel* channel = ::iio_device_get_channel(device, j);
      text += std::string("  ") + (::iio_channel_is_output(channel) ? "output '" : "input '") +
              ::iio_channel_get_id(channel) + "'" +
              (::iio_channel_is_scan_element(channel) ? ", can be captured" : "") + "\n";
    }
  }
  return text.empty() ? "no converter\n" : text;
}

std::string iio_library() {
  unsigned major = 0, minor = 0;
  char tag[8] = "";
  ::iio_library_get_version(&major, &minor, tag);
  return "libiio " + std::to_string(major) + "." + std::to_string(minor);
}

}  // namespace hal::linux
