#include "firmware/controller/devices/publish_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using firmware::controller::parse_publish_address;
using firmware::controller::publish_objection;

TEST(PublishAddress, IsThisMachineInEachOfItsNames) {
  for (const char* text : {"localhost:9870", "127.0.0.1:1", "127.8.9.10:65535", "[::1]:9870"}) {
    const auto address = parse_publish_address(text);
    ASSERT_TRUE(address.has_value()) << text;
    EXPECT_TRUE(address->loopback) << text;
    EXPECT_EQ(publish_objection(text, false), "") << text;
  }
}

// A name would be looked up, which may wait and may lead elsewhere tomorrow; every address of the machine at once is no
// place to send to.
TEST(PublishAddress, IsNotAnyText) {
  for (const char* text :
       {"", ":", "localhost", "localhost:", "localhost:0", "localhost:65536", "localhost:98x", ":9870",
        "rig.example:9870", "1.2.3:9870", "::1:9870", "[::1:9870", "0.0.0.0:9870", "[::]:9870", "state"}) {
    EXPECT_FALSE(parse_publish_address(text).has_value()) << text;
    EXPECT_THAT(publish_objection(text, true), testing::HasSubstr("expected HOST:PORT")) << text;
  }
}

// Values that leave the machine do so because somebody has said it twice.
TEST(PublishAddress, OfAnotherMachineNeedsASecondWord) {
  for (const char* text : {"192.168.1.7:9870", "128.0.0.1:9870", "[fe80::1]:9870"}) {
    const auto address = parse_publish_address(text);
    ASSERT_TRUE(address.has_value()) << text;
    EXPECT_FALSE(address->loopback) << text;
    EXPECT_THAT(publish_objection(text, false), testing::HasSubstr("--publish-remote")) << text;
    EXPECT_EQ(publish_objection(text, true), "") << text;
  }
}

}  // namespace
