#include "host_sim/recording_files/export/universal_records.hpp"

#include <cmath>
#include <utility>

#include "host_sim/recording_files/export/columns.hpp"
#include "host_sim/report/formatted.hpp"

namespace host_sim::universal {
namespace {

using model::Channel;

// Header records fill 80 columns. Data lines end with their last number and delimiters with −1, because some readers
// take blanks for numbers.
void put(std::string& file, std::string record) {
  record.resize(80, ' ');
  file += record + "\n";
}

void begin(std::string& file, int dataset) {
  file += dataset_end();
  put(file, formatted("%6d", dataset));
}

// The records have columns of bytes: letters beyond ASCII are Latin-1, which has "Ö" and "°" in one byte.
std::string field(std::string_view text, std::size_t most) {
  std::string plain = latin_1(text);
  for (char& c : plain) {
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  }
  return plain.substr(0, most);
}

void put_axis(std::string& file, const Axis& axis) {
  put(file, formatted("%10d%5d%5d%5d %-20s %-20s", axis.type, axis.length, axis.force, 0, field(axis.label, 20).c_str(),
                      field(axis.unit, 20).c_str()));
}

std::string number(int width, int digits, double value) {
  return std::isfinite(value) ? formatted("%*.*E", width, digits, value) : formatted("%*s", width, "NaN");
}

}  // namespace

Axis axis_for(std::string_view unit, std::string_view label) {
  const auto named = [label](Axis axis) {
    if (label != "NONE") axis.label = label;
    return axis;
  };
  if (unit == "N") return named({9, 0, 1, "Force", "N"});
  if (unit == "m") return named({8, 1, 0, "Displacement", "m"});
  if (unit == "m/s") return named({11, 1, 0, "Velocity", "m/s"});
  if (unit == "m/s²") return named({12, 1, 0, "Acceleration", "m/s^2"});
  return {0, 0, 0, std::string(label), unit.empty() ? "NONE" : std::string(unit)};
}

int node_of(Channel channel) {
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

std::string units_dataset() {
  std::string file;
  begin(file, 164);
  put(file, formatted("%10d%-20s%10d", 1, "SI: Metric Abs (SI)", 2));
  put(file, "  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00");
  put(file, "  2.73149999999999977D+02");
  return file + dataset_end();
}

std::string function_header(const Function& f) {
  constexpr std::size_t name_width = 10, line_width = 80;
  std::string file;
  begin(file, 58);
  for (const std::string& line : f.id) put(file, field(line, line_width));
  const auto direction = [](int node) { return node == 0 ? 0 : 3; };
  put(file, formatted("%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d", static_cast<int>(f.type), f.number, 0, 0,
                      field(f.response, name_width).c_str(), f.response_node, direction(f.response_node),
                      field(f.reference, name_width).c_str(), f.reference_node, direction(f.reference_node)));
  put(file, formatted("%10d%10zu%10d%13.5E%13.5E%13.5E", f.complex ? 6 : 4, f.points, f.even ? 1 : 0, f.first,
                      f.increment, 0.0));
  for (const Axis& axis : {f.abscissa, f.ordinate, f.denominator, Axis{}}) put_axis(file, axis);
  return file;
}

std::string function_numbers(std::span<const double> numbers, bool even) {
  std::string file;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    file += !even && i % 2 == 0 ? number(13, 5, numbers[i]) : number(20, 12, numbers[i]);
    if (i % 4 == 3 || i + 1 == numbers.size()) file += '\n';
  }
  return file;
}

std::string dataset_end() { return "    -1\n"; }

}  // namespace host_sim::universal
