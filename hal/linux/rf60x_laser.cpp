#include "hal/linux/rf60x_laser.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace hal::linux {
namespace {

constexpr std::uint8_t start_stream = 0x87;  // request 07h, marked by bit 7
constexpr std::uint8_t stop_stream = 0x88;

speed_t speed_of(unsigned baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    case 460800:
      return B460800;
    case 921600:
      return B921600;
    default:
      return B0;
  }
}

/// Raw, 8 data bits, even parity, one stop bit; a byte with a parity error is a 0, which has no bit 7 and counts as
/// garbage.
bool set_up(int port, speed_t speed) {
  termios line{};
  if (::tcgetattr(port, &line) != 0) return false;
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD | PARENB;
  line.c_cflag &= ~static_cast<tcflag_t>(PARODD | CSTOPB | CRTSCTS);
  line.c_iflag |= INPCK;
  line.c_cc[VMIN] = 1;  // nothing there is EAGAIN then, and 0 bytes are a line that hung up
  line.c_cc[VTIME] = 0;
  if (::cfsetispeed(&line, speed) != 0 || ::cfsetospeed(&line, speed) != 0) return false;
  if (::tcsetattr(port, TCSANOW, &line) == 0) return true;
  line.c_cflag &= ~static_cast<tcflag_t>(PARENB);  // a pseudo-terminal knows no parity
  return ::tcsetattr(port, TCSANOW, &line) == 0;
}

/// False: the driver knows no such thing, or does not grant it.
bool ask_low_latency(int port) {
  serial_struct serial{};
  if (::ioctl(port, TIOCGSERIAL, &serial) != 0) return false;
  serial.flags |= ASYNC_LOW_LATENCY;
  return ::ioctl(port, TIOCSSERIAL, &serial) == 0;
}

}  // namespace

Rf60xLaser::Rf60xLaser(const Wanted& wanted, int port)
    : wanted_(wanted), port_(port), byte_time_(nanoseconds(11'000'000'000 / static_cast<std::int64_t>(wanted.baud))) {}

Rf60xLaser::~Rf60xLaser() {
  const std::uint8_t request[2]{static_cast<std::uint8_t>(wanted_.address), stop_stream};
  static_cast<void>(!::write(port_, request, sizeof request));
  ::close(port_);
}

Opened<Rf60xLaser> Rf60xLaser::open(const Wanted& wanted) {
  Opened<Rf60xLaser> opened;
  const speed_t speed = speed_of(wanted.baud);
  if (speed == B0) {
    opened.trouble = "laser at " + wanted.port + ": no rate of " + std::to_string(wanted.baud) +
                     " baud; 9600, 19200 … 921600, as set in the sensor";
    return opened;
  }
  const int port = open_alone(wanted.port, O_RDWR | O_NOCTTY | O_NONBLOCK, opened.trouble);
  if (port < 0) {
    opened.trouble = "laser at " + opened.trouble;
    return opened;
  }
  opened.device.reset(new Rf60xLaser(wanted, port));
  const std::uint8_t request[2]{static_cast<std::uint8_t>(wanted.address & 0x7fU), start_stream};
  if (!set_up(port, speed) || ::write(port, request, sizeof request) != static_cast<ssize_t>(sizeof request)) {
    opened.trouble = "laser at " + wanted.port + ": " + words_of(errno) + "; expected a serial port";
    opened.device.reset();
    return opened;
  }
  opened.device->low_latency_ = ask_low_latency(port);
  return opened;
}

Result<void> Rf60xLaser::read(Frame& frame, Time now) {
  std::uint8_t bytes[512];
  for (;;) {
    const ssize_t got = ::read(port_, bytes, sizeof bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) break;
    if (got <= 0) return Fault::disconnected;
    for (ssize_t i = 0; i < got; ++i) {
      const auto result = parser_.take(bytes[i], now - byte_time_ * (got - i));
      if (result) keep(*result);
    }
    if (got < static_cast<ssize_t>(sizeof bytes)) break;
  }
  frame.channels[wanted_.channel] = newest_;
  return {};
}

void Rf60xLaser::keep(const Rf60xParser::Frame& result) {
  if (!result.renewed && newest_.taken != never) return;
  const double distance = static_cast<double>(result.counts) * wanted_.range / Rf60xParser::full_scale;
  newest_ = {wanted_.scale * distance + wanted_.offset, result.begun, Quality::good};  // (1)
  if (first_ == never) first_ = result.begun;
  ++renewed_;
}

Time Rf60xLaser::interval() const {
  if (renewed_ < 16) return {};
  return nanoseconds((newest_.taken - first_).ns / static_cast<std::int64_t>(renewed_ - 1));
}

std::string Rf60xLaser::warning(Time period) const {
  const Time each = interval();
  char text[256];
  if (each.ns == 0) {
    std::snprintf(text, sizeof text, "laser at %s: %llu results so far; is it set to %u baud and address %u?",
                  wanted_.port.c_str(), static_cast<unsigned long long>(renewed_), wanted_.baud, wanted_.address);
    return text;
  }
  if (2 * each.ns <= 3 * period.ns) return {};
  std::snprintf(text, sizeof text,
                "laser at %s: a result each %.2f ms%s, the loop asks each %.2f ms: its channel is up to %.2f ms old; "
                "lower the sampling period in the sensor",
                wanted_.port.c_str(), each.seconds() * 1e3,
                each > microseconds(4900) && each < microseconds(5100) ? " (the factory setting)" : "",
                period.seconds() * 1e3, each.seconds() * 1e3);
  return text;
}

}  // namespace hal::linux
