#include "firmware/controller/devices/publish_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/description/text/internet_address.hpp"

namespace {

using firmware::parse_host_port;
using firmware::controller::publish_objection;

TEST(PublishAddress, IsThisMachineInEachOfItsNames) {
  for (const char* text : {"localhost:9870", "127.0.0.1:1", "127.8.9.10:65535", "[::1]:9870"}) {
    EXPECT_TRUE(parse_host_port("--publish", text).loopback) << text;
    EXPECT_EQ(publish_objection(text, false), "") << text;
  }
}

TEST(PublishAddress, IsNotAnyText) {
  EXPECT_EQ(publish_objection("localhost:65536", true),
            "--publish 'localhost:65536' does not fit: the port '65536' is no number from 1 to 65535, expected "
            "HOST:PORT, such as localhost:9870 or [::1]:9870");
  EXPECT_THAT(publish_objection("9870", true), testing::HasSubstr("there is no port"));
}

// Values that leave the machine do so because somebody has said it twice.
TEST(PublishAddress, OfAnotherMachineNeedsASecondWord) {
  for (const char* text : {"192.168.1.7:9870", "128.0.0.1:9870", "[fe80::1]:9870"}) {
    EXPECT_FALSE(parse_host_port("--publish", text).loopback) << text;
    EXPECT_THAT(publish_objection(text, false), testing::HasSubstr("--publish-remote")) << text;
    EXPECT_EQ(publish_objection(text, true), "") << text;
  }
}

}  // namespace
