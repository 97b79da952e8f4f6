#include "firmware/recording/sample_checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"

namespace firmware {
namespace {

/// [places] of the stamps in a period, at least, from which the grid is recovered. Derivation: a stamp is off by half a
/// place, the offset of the last ones is known to a fifth of one; 0.7 places must stay below half a period. Half: rows
/// are taken for each other. Twice: 512 Hz in whole milliseconds is refused.
constexpr double fewest_places = 1.75;

bool all_are_single_precision(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(),
                     [](double x) { return static_cast<double>(static_cast<float>(x)) == x; });
}

// Six digits, for a message: rates and steps as a person would write them.
std::string rounded(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

// Unit of the last printed place of a stamp as large as `largest` [s].
double last_place(const StampRounding& rounding, double largest) {
  const double in_file = largest / rounding.scale;
  const double by_decimals = std::pow(10.0, -rounding.decimals);
  const double by_digits =
      in_file > 0.0 ? std::pow(10.0, std::floor(std::log10(in_file)) + 1.0 - rounding.significant_digits) : 0.0;
  return std::max(by_decimals, by_digits) * rounding.scale;
}

// Stamps kept in single precision are as coarse as that; with eight digits or fewer the printing is coarser still.
bool is_single(const std::vector<double>& time, const StampRounding& rounding) {
  return rounding.significant_digits > 8 && all_are_single_precision(time);
}

// Stamps that rise, and are rounded to places, rise by a place at least: 10 behind 9.99 is no stamp of tenths, though
// none before it has more than three digits. Of the stamps with as many digits before the point as the largest.
double smallest_rise(const std::vector<double>& time, double largest, double scale) {
  constexpr double rounding = 1.0 - 1e-12;
  const double decade = std::pow(10.0, std::floor(std::log10(largest / scale))) * scale * rounding;
  double smallest = INFINITY;
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (std::max(std::abs(time[k]), std::abs(time[k - 1])) < decade) continue;
    if (const double rise = time[k] - time[k - 1]; rise > 0.0) smallest = std::min(smallest, rise);
  }
  return smallest;
}

double printed_place(const std::vector<double>& time, const StampRounding& rounding, bool single) {
  const double largest = std::max(std::abs(time.front()), std::abs(time.back()));
  double place = last_place(rounding, largest);
  if (place > last_place({rounding.decimals, 17, rounding.scale}, largest)) {
    place = std::min(place, smallest_rise(time, largest, rounding.scale));
  }
  return std::max(place, single ? static_cast<double>(std::numeric_limits<float>::epsilon()) * largest : 0.0);
}

}  // namespace

double median_step(const std::vector<double>& time) {
  std::vector<double> steps(time.size() - 1);
  for (std::size_t k = 1; k < time.size(); ++k) steps[k - 1] = time[k] - time[k - 1];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

std::optional<double> rate_if_usual(const std::vector<double>& time, const StampRounding& rounding,
                                    std::optional<double> usual) {
  if (!usual || time.size() < 2) return usual;
  const double step = median_step(time);
  if (!(step > 0.0)) return usual;  // check_time() says what is wrong
  constexpr double clock_error = 1e-4;
  const double allowed = clock_error / *usual + stamp_error(time, rounding, 1.0 / *usual);
  return std::abs(step - 1.0 / *usual) <= allowed ? usual : std::nullopt;
}

bool recover_grid(Recording& recording, const StampRounding& rounding, std::optional<double> usual_rate) {
  std::vector<double>& time = recording.time;
  constexpr std::size_t least = 10;
  if (time.size() < least) return false;
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (!(time[k] > time[k - 1])) return false;
  }
  const double middle = median_step(time), place = printed_place(time, rounding, is_single(time, rounding));
  // Exact stamps repeat their step.
  const auto other = [&](double a, double b) { return std::abs(a - b) > 1e-3 * place + 1e-3 * middle; };
  // Rounded steps of one period are two neighbouring multiples of the place; of stamps as coarse as a third of the
  // period, the more frequent neighbour of the median is the other, and what is longer has lost rows.
  const auto steps_near = [&](double step) {
    std::size_t count = 0;
    for (std::size_t k = 1; k < time.size(); ++k) count += other(time[k] - time[k - 1], step) ? 0 : 1;
    return count;
  };
  const bool coarse = place > middle / 4.0;
  const double longer = coarse && steps_near(middle - place) > steps_near(middle + place) ? 0.5 : 1.5;
  std::size_t single = 0, odd = 0;
  double sum = 0.0;
  for (std::size_t k = 1; k < time.size(); ++k) {
    const double step = time[k] - time[k - 1];
    if (step > middle + longer * place) continue;  // rows are missing here
    sum += step;
    ++single;
    if (other(step, middle)) ++odd;
  }
  if (odd == 0 || single == 0) return false;
  double period = sum / static_cast<double>(single);
  if (usual_rate && std::abs(period * *usual_rate - 1.0) < 1e-4) period = 1.0 / *usual_rate;
  if (place > period / fewest_places) return false;
  // A stamp is up to half a place off its row; what the last ones were off on average (over ten) is taken away before
  // rows are counted.
  std::vector<double> number(time.size(), 0.0);
  double mean_n = 0.0, mean_t = 0.0, usual_offset = 0.0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (k > 0) {
      const double step = time[k] - time.front() - usual_offset - number[k - 1] * period;
      number[k] = number[k - 1] + std::max(1.0, std::round(step / period));
    }
    usual_offset += 0.1 * (time[k] - time.front() - number[k] * period - usual_offset);
    mean_n += number[k] / static_cast<double>(time.size());
    mean_t += (time[k] - time.front()) / static_cast<double>(time.size());
  }
  double nn = 0.0, nt = 0.0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    nn += (number[k] - mean_n) * (number[k] - mean_n);
    nt += (number[k] - mean_n) * (time[k] - time.front() - mean_t);
  }
  period = nt / nn;
  const double begin = time.front() + mean_t - period * mean_n;
  double worst = 0.0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    worst = std::max(worst, std::abs(time[k] - begin - number[k] * period));
  }
  if (worst > place * (1.0 + 1e-6)) return false;
  for (std::size_t k = 0; k < time.size(); ++k) time[k] = begin + number[k] * period;
  recording.remark = one_line(recording.source) + ": the times are rounded to " + rounded(1e3 * place) +
                     " ms; the rows lie on a grid of " + rounded(1.0 / period) + " Hz, up to " + rounded(1e3 * worst) +
                     " ms off";
  return true;
}

Objection object_to(Quantity quantity, double value) {
  if (!std::isfinite(value))
    return {std::string(quantity_name(quantity)) + " is " + shortest(value), "a finite number"};
  if (quantity >= first_duct && value != 0.0 && value != 1.0) {
    return {std::string(quantity_name(quantity)) + " is " + shortest(value), "1 (open) or 0 (closed)"};
  }
  return {};
}

InputError RecordingLocation::error(std::size_t k, std::string_view wrong, std::string_view expected) const {
  if (first_line > 0) return {source, first_line + k, wrong, expected};
  return {source, 0, "sample " + std::to_string(k + 1) + ": " + std::string(wrong), expected};
}

double stamp_error(const std::vector<double>& time, const StampRounding& rounding, double period) {
  const bool single = is_single(time, rounding);
  const double printed = printed_place(time, rounding, single);
  const double places = period / printed;
  const bool exact = !single && std::abs(places - std::round(places)) < 1e-3 && places > 0.5;
  return exact ? 0.0 : printed;
}

void check_time_rises(const Recording& recording, const RecordingLocation& location) {
  const std::vector<double>& time = recording.time;
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (time[k] > time[k - 1]) continue;
    const std::string stamp = shortest(time[k]) + " follows " + shortest(time[k - 1]);
    if (time[k] == time[k - 1])
      throw location.error(k, "time does not increase: " + stamp, "a later time in each sample");
    throw location.error(k, "time runs backwards: " + stamp, "a later time in each sample");
  }
}

void check_time(Recording& recording, const StampRounding& rounding, const RecordingLocation& location,
                std::optional<double> expected_rate) {
  const std::vector<double>& time = recording.time;
  const std::size_t n = time.size();
  if (n < 2) throw location.error(0, "there is only one sample", "at least two");
  check_time_rises(recording, location);

  constexpr double jitter = 1e-3;       // of T; these two are explained at read_recording
  constexpr double clock_error = 1e-4;  // of T
  const double largest = std::max(std::abs(time.front()), std::abs(time.back()));
  const double arithmetic = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  const double printed = printed_place(time, rounding, is_single(time, rounding));
  const double mean = (time.back() - time.front()) / static_cast<double>(n - 1);
  double period = expected_rate ? 1.0 / *expected_rate : mean;
  if (!expected_rate) {
    const double middle = median_step(time);
    if (std::abs(mean - middle) > printed + jitter * middle) period = middle;  // the mean holds a gap
    const double whole_rate = std::round(1.0 / period);
    const double mean_error = (printed + arithmetic) / static_cast<double>(n - 1) + 1e-9 * period;
    if (whole_rate >= 1.0 && std::abs(1.0 / whole_rate - period) <= std::min(mean_error, jitter * period)) {
      period = 1.0 / whole_rate;
    }
  }
  recording.sample_period = period;

  const double error = stamp_error(time, rounding, period) + arithmetic;
  const double tolerance = error + jitter * period;

  std::size_t odd = 1;
  while (odd < n && std::abs(time[odd] - time[odd - 1] - period) <= tolerance) ++odd;
  const auto rate_error = [&](std::size_t k, double step) {
    return location.error(k,
                          "the recording's rate is " + rounded(1.0 / step) + " Hz (steps of " + rounded(step) + " s)",
                          rounded(1.0 / period) + " Hz as in the rig description");
  };
  if (odd < n) {
    const double middle = median_step(time);
    if (expected_rate && std::abs(middle - period) > tolerance) throw rate_error(1, middle);
    const double step = time[odd] - time[odd - 1];
    throw location.error(odd,
                         (step > period ? "gap in time: " : "irregular time: ") + shortest(time[odd]) + " follows " +
                             shortest(time[odd - 1]),
                         "steps of " + rounded(period) + " s ± " + rounded(tolerance) + " s");
  }
  if (error > 0.5 * period) {
    throw location.error(1, "time is rounded to " + rounded(error) + " s",
                         "stamps that tell a gap from a step of " + rounded(period) + " s");
  }
  if (std::abs(mean - period) > clock_error * period + (error + 2.0 * jitter * period) / static_cast<double>(n - 1)) {
    throw rate_error(1, mean);
  }
}

}  // namespace firmware
