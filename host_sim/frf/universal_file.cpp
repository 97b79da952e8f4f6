#include "host_sim/frf/universal_file.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "firmware/description/text/quantity.hpp"
#include "host_sim/report/formatted.hpp"

namespace host_sim::frf {
namespace {

using model::Channel;

// Header records fill 80 columns. Data lines end with their last number and delimiters with −1, because some readers
// take blanks for numbers.
void put(std::string& file, std::string record) {
  record.resize(80, ' ');
  file += record + "\n";
}

void begin(std::string& file, int dataset) {
  file += "    -1\n";
  put(file, formatted("%6d", dataset));
}

void end(std::string& file) { file += "    -1\n"; }

int node(Channel channel) {
  switch (channel) {
    case Channel::z_r:
    case Channel::zdd_r:
      return 1;
    case Channel::z_w:
    case Channel::zdd_w:
      return 2;
    case Channel::z_b:
    case Channel::zdd_b:
      return 3;
    case Channel::dz_w:
    case Channel::F_w:
      return 4;
    default:
      return 5;
  }
}

// Quantity of an axis: specific data type and exponents of length and force.
struct Quantity {
  int type, length, force;
  const char *label, *unit;
};

constexpr Quantity frequency{18, 0, 0, "Frequency", "Hz"};
constexpr Quantity nothing{0, 0, 0, "NONE", "NONE"};

Quantity quantity(Channel channel) {
  const std::string_view unit = model::unit(channel);
  if (unit == "N") return {9, 0, 1, "Force", "N"};
  if (unit == "m") return {8, 1, 0, "Displacement", "m"};
  return {12, 1, 0, "Acceleration", "m/s^2"};
}

void put_axis(std::string& file, const Quantity& q) {
  put(file, formatted("%10d%5d%5d%5d %-20s %-20s", q.type, q.length, q.force, 0, q.label, q.unit));
}

void put_numbers(std::string& file, std::span<const double> numbers) {
  std::string record;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    record += formatted("%20.12E", numbers[i]);
    if (i % 4 == 3 || i + 1 == numbers.size()) file += std::exchange(record, {}) + "\n";
  }
}

enum class Function : int { response = 4, coherence = 6 };

void put_function(std::string& file, const Responses& r, const OutputResponse& o, Function function, int number) {
  const std::string output(model::name(o.output)), input(model::name(r.request.input));
  const bool response = function == Function::response;
  const std::string what = response ? std::string(name(r.request.estimator)) : "coherence";
  begin(file, 58);
  put(file, what + " " + output + " / " + input);
  put(file, formatted("rigtwin frf, %zu averages worth %.1f, block %zu samples at %.9g Hz", r.averages,
                      r.effective_averages, r.blocks.scheme.length, r.sample_rate));
  put(file, "NONE");
  put(file, r.request.instrument ? "instrument " + std::string(model::name(*r.request.instrument)) : "NONE");
  put(file, "NONE");
  put(file, formatted("%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d", static_cast<int>(function), number, 0, 0,
                      output.c_str(), node(o.output), 3, input.c_str(), node(r.request.input), 3));
  const double first = r.frequency.empty() ? 0.0 : r.frequency.front();
  put(file, formatted("%10d%10zu%10d%13.5E%13.5E%13.5E", response ? 6 : 4, r.frequency.size(), 1, first, r.resolution(),
                      0.0));
  put_axis(file, frequency);
  put_axis(file, response ? quantity(o.output) : Quantity{0, 0, 0, "Coherence", "NONE"});
  put_axis(file, response ? quantity(r.request.input) : nothing);
  put_axis(file, nothing);
  std::vector<double> numbers;
  for (std::size_t k = 0; k < r.frequency.size(); ++k) {
    const bool known = std::isfinite(o.magnitude[k]);
    if (response) {
      numbers.push_back(known ? o.magnitude[k] * std::cos(o.phase[k]) : 0.0);
      numbers.push_back(known ? o.magnitude[k] * std::sin(o.phase[k]) : 0.0);
    } else {
      numbers.push_back(known ? o.coherence[k] : 0.0);
    }
  }
  put_numbers(file, numbers);
  end(file);
}

}  // namespace

std::string to_universal_file(const Responses& responses) {
  std::string file;
  begin(file, 164);
  put(file, formatted("%10d%-20s%10d", 1, "SI: Metric Abs (SI)", 2));
  put(file, "  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00");
  put(file, "  2.73149999999999977D+02");
  end(file);
  int number = 0;
  for (const OutputResponse& output : responses.outputs) {
    ++number;
    put_function(file, responses, output, Function::response, number);
    put_function(file, responses, output, Function::coherence, number);
  }
  return file;
}

}  // namespace host_sim::frf
