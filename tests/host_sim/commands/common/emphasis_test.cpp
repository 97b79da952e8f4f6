#include "host_sim/commands/common/emphasis.hpp"

#include <gtest/gtest.h>

namespace {

using host_sim::Emphasis;
using host_sim::emphasised;

TEST(Emphasised, OnATerminalThatShowsIt) {
  EXPECT_EQ(emphasised("x", Emphasis::bold, true, nullptr, "xterm"), "\033[1mx\033[0m");
  EXPECT_EQ(emphasised("x", Emphasis::error, true, "", "xterm"), "\033[1;31mx\033[0m");
}

TEST(Emphasised, NowhereElse) {
  EXPECT_EQ(emphasised("x", Emphasis::bold, false, nullptr, "xterm"), "x");
  EXPECT_EQ(emphasised("x", Emphasis::error, true, "1", "xterm"), "x");
  EXPECT_EQ(emphasised("x", Emphasis::error, true, nullptr, "dumb"), "x");
  EXPECT_EQ(emphasised("x", Emphasis::error, true, nullptr, nullptr), "x");
}

}  // namespace
