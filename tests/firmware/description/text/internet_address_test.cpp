// HOST:PORT, as every command line takes it.
#include "firmware/description/text/internet_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/description/text/input_error.hpp"

namespace {

using firmware::HostPortRule;
using firmware::parse_host;
using firmware::parse_host_port;

std::string error_of(const std::string& text, HostPortRule rule = {}) {
  try {
    return "no error: " + parse_host_port("--to", text, rule).text();
  } catch (const firmware::UsageError& error) {
    return error.what();
  }
}

TEST(InternetAddress, IsTakenApartAndWrittenAgain) {
  struct Case {
    const char *text, *host, *written;
    int port;
    bool loopback;
  };
  for (const Case& c : {Case{"localhost:9870", "127.0.0.1", "127.0.0.1:9870", 9870, true},
                        Case{"127.8.9.10:65535", "127.8.9.10", "127.8.9.10:65535", 65535, true},
                        Case{"192.168.1.7:1", "192.168.1.7", "192.168.1.7:1", 1, false},
                        Case{"[::1]:9870", "::1", "[::1]:9870", 9870, true},
                        Case{"[fd00::7]:80", "fd00::7", "[fd00::7]:80", 80, false}}) {
    const auto address = parse_host_port("--to", c.text);
    EXPECT_EQ(address.host(), c.host);
    EXPECT_EQ(address.text(), c.written);
    EXPECT_EQ(address.port(), c.port);
    EXPECT_EQ(address.loopback, c.loopback) << c.text;
  }
  EXPECT_EQ(parse_host_port("--to", "9870", {.port_alone = true}).text(), "127.0.0.1:9870");
  EXPECT_EQ(parse_host_port("--to", "localhost:0", {.any_port = true}).port(), 0);
  EXPECT_EQ(parse_host("::1")->host(), "::1");
  EXPECT_EQ(parse_host("[::1]")->host(), "::1");
}

// A name would be looked up, which may wait and may lead elsewhere tomorrow; every address of the machine at once is no
// place to send to.
TEST(InternetAddress, SaysInOneLineWhatIsWrong) {
  const std::string end = ", expected HOST:PORT, such as localhost:9870 or [::1]:9870";
  for (const char* text : {"", "localhost", "[::1]", "127.0.0.1"}) {
    EXPECT_EQ(error_of(text), "--to '" + std::string(text) + "' does not fit: there is no port" + end);
  }
  for (const char* port : {"", "0", "65536", "98x", "-1", "+1", " 1", "99999999999999999999"}) {
    EXPECT_EQ(error_of("localhost:" + std::string(port)), "--to 'localhost:" + std::string(port) +
                                                              "' does not fit: the port '" + port +
                                                              "' is no number from 1 to 65535" + end);
  }
  for (const char* host : {"", "rig.example", "1.2.3", "0.0.0.0", "[::]", "[::1", "[]", "[127.0.0.1]"}) {
    EXPECT_EQ(error_of(std::string(host) + ":9870"),
              "--to '" + std::string(host) + ":9870' does not fit: the host '" + host +
                  "' is neither localhost nor the address of one machine in numbers" + end);
  }
  EXPECT_EQ(error_of("::1:9870"), "--to '::1:9870' does not fit: an IPv6 address stands in brackets" + end);
  EXPECT_THAT(error_of("x", {.port_alone = true, .any_port = true}),
              testing::HasSubstr("the port 'x' is no number from 0 to 65535, expected HOST:PORT or PORT, such as"));
  for (const char* host : {"", "0.0.0.0", "::", "example.org"}) EXPECT_FALSE(parse_host(host)) << host;
}

}  // namespace
