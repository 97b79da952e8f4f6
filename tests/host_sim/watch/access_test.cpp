#include "host_sim/watch/access.hpp"

#include <gtest/gtest.h>

namespace {

using namespace host_sim::watch;

TEST(WatchAccess, MakesATokenThatNobodyGuesses) {
  const std::string token = random_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(token, random_token());
}

TEST(WatchAccess, ComparesWholeTexts) {
  EXPECT_TRUE(equal_in_constant_time("", ""));
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "xbc", "abcd"}) EXPECT_FALSE(equal_in_constant_time("abc", other));
}

TEST(WatchAccess, KnowsItsOwnNames) {
  for (const char* host : {"localhost:8080", "127.0.0.1:8080"})
    EXPECT_TRUE(is_own_host(host, "127.0.0.1", 8080)) << host;
  for (const char* host : {"", "localhost", "localhost:80", "localhost:8081", "evil.example:8080", "evil.example",
                           "localhost.evil.example:8080", "127.0.0.1.evil.example:8080", "127.0.0.2:8080",
                           "xlocalhost:8080", "localhost:8080x"}) {
    EXPECT_FALSE(is_own_host(host, "127.0.0.1", 8080)) << host;
  }
  EXPECT_TRUE(is_own_host("localhost", "127.0.0.1", 80));
  EXPECT_TRUE(is_own_host("[::1]:8080", "::1", 8080));
  EXPECT_TRUE(is_own_host("192.168.1.7:8080", "192.168.1.7", 8080));
  EXPECT_FALSE(is_own_host("localhost:8080", "192.168.1.7", 8080));
}

TEST(WatchAccess, KnowsItsOwnPage) {
  EXPECT_TRUE(is_own_origin("http://localhost:8080", "127.0.0.1", 8080));
  for (const char* origin :
       {"null", "", "https://localhost:8080", "http://localhost:3000", "http://evil.example", "localhost:8080"}) {
    EXPECT_FALSE(is_own_origin(origin, "127.0.0.1", 8080)) << origin;
  }
}

}  // namespace
