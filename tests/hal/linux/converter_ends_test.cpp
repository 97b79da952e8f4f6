#include "hal/linux/converter_ends.hpp"

#include <gtest/gtest.h>

namespace {

using hal::linux::at_end_of_converter;

// Both ends of both formats, and the counts beside them. 65535 counts of an unsigned 16 bit converter were good before:
// 0.30518 N/count · 65535 − 10 kN is 9999.97 N, inside a range of ± 10 kN.
TEST(ConverterEnds, AreTheLowestAndTheHighestCount) {
  EXPECT_TRUE(at_end_of_converter(65535.0, 16, false));
  EXPECT_FALSE(at_end_of_converter(65534.0, 16, false));
  EXPECT_TRUE(at_end_of_converter(0.0, 16, false));
  EXPECT_FALSE(at_end_of_converter(1.0, 16, false));
  EXPECT_TRUE(at_end_of_converter(32767.0, 16, true));
  EXPECT_FALSE(at_end_of_converter(32766.0, 16, true));
  EXPECT_TRUE(at_end_of_converter(-32768.0, 16, true));
  EXPECT_FALSE(at_end_of_converter(-32767.0, 16, true));
  EXPECT_FALSE(at_end_of_converter(0.0, 16, true));
  EXPECT_TRUE(at_end_of_converter(4095.0, 12, false));
  EXPECT_TRUE(at_end_of_converter(-2048.0, 12, true));
  EXPECT_TRUE(at_end_of_converter(2147483647.0, 32, true));
  EXPECT_FALSE(at_end_of_converter(8388606.0, 24, true));
}

}  // namespace
