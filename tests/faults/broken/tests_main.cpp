// broken_tests [NUMBER] [gtest options] -- the control loop's tests with the safety function of that line of functions.txt broken; 0: none.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/faults/broken/broken.hpp"

int rigtwin_break = 0;

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (argc > 1) rigtwin_break = std::atoi(argv[1]);
  return RUN_ALL_TESTS();
}
