#include "firmware/controller/recording/spans.hpp"

#include <array>
#include <cstdio>
#include <map>

namespace firmware::controller {
namespace {

constexpr std::uint64_t microsecond = 1000;

}  // namespace

std::string line(const char* what, const Histogram& h) {
  const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) * 1e-3; };
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "  %-17s C:%8llu Min:%9.1f P50:%9.1f P99:%9.1f P99.9:%9.1f Max:%9.1f us\n",
                what, static_cast<unsigned long long>(h.count()), us(h.lowest()), us(h.quantile(0.5)),
                us(h.quantile(0.99)), us(h.quantile(0.999)), us(h.highest()));
  return text.data();
}

std::string as_cyclictest(const Spans& spans) {
  const std::array<const Histogram*, 3> columns{&spans.wake_up, &spans.step, &spans.age};
  std::map<std::uint64_t, std::array<std::uint64_t, columns.size()>> rows;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c]->for_each_class(
        [&](std::uint64_t longest, std::uint64_t count) { rows[longest / microsecond][c] += count; });
  }
  std::string text = "# wake-up latency, step time, sample age [us]\n# Histogram\n";
  const auto append = [&text](const char* form, std::uint64_t number) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), form, static_cast<unsigned long long>(number));
    text += digits.data();
  };
  for (const auto& [row, counts] : rows) {
    append("%06llu", row);
    for (std::size_t c = 0; c < counts.size(); ++c) append(c == 0 ? " %06llu" : "\t%06llu", counts[c]);
    text += '\n';
  }
  const auto summary = [&](const char* what, const char* form, auto figure) {
    text += what;
    for (const Histogram* column : columns) append(form, figure(*column));
    text += '\n';
  };
  summary("# Total:", " %09llu", [](const Histogram& h) { return h.count(); });
  summary("# Min Latencies:", " %05llu", [](const Histogram& h) { return h.lowest() / microsecond; });
  summary("# Avg Latencies:", " %05llu", [](const Histogram& h) { return h.mean() / microsecond; });
  summary("# Max Latencies:", " %05llu", [](const Histogram& h) { return h.highest() / microsecond; });
  return text;
}

}  // namespace firmware::controller
