#include "firmware/recording/column_printer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace column_printer_test {
namespace {

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

void expect_shortest(const std::vector<double>& column) {
  firmware::ColumnPrinter printer;
  for (const double value : column) {
    std::string text;
    printer.print(value, text);
    ASSERT_EQ(text, shortest(value));
  }
}

// Law. What is printed is what std::to_chars prints, to the letter: replays and hashes of files rely on it.
TEST(ColumnPrinter, PrintsTheShortestDecimals) {
  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 18446744073709551616.0 - 0.5; };
  for (const double places : {1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e9, 1e12}) {
    for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e7, 1e12}) {
      std::vector<double> column;
      for (int k = 0; k < 200; ++k) column.push_back(std::round(size * uniform() * places) / places);
      expect_shortest(column);
      for (double& value : column) value = size * uniform();  // seventeen digits
      expect_shortest(column);
    }
  }
}

TEST(ColumnPrinter, PrintsWhatStandsAtTheEdges) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> column{0.0,
                             -0.0,
                             1.0,
                             -1.0,
                             0.001,
                             0.0009,
                             1e-5,
                             1e4,
                             1e5,
                             123e5,
                             1200000.0,
                             12000000.0,
                             1e15,
                             1e16,
                             1e22,
                             5e-324,
                             0.1,
                             0.30000000000000004,
                             9999999.5,
                             999999999999999.9,
                             0.5,
                             2.5,
                             std::numeric_limits<double>::quiet_NaN(),
                             infinity,
                             -infinity,
                             1.7976931348623157e308};
  expect_shortest(column);
  for (int k = 0; k < 40; ++k) column.insert(column.begin(), 0.1234567);  // with more decimals
  expect_shortest(column);
  for (int k = 0; k < 3000; ++k) column.insert(column.begin(), 1.0 / 3.0);  // after a pause
  expect_shortest(column);
}

}  // namespace
}  // namespace column_printer_test
