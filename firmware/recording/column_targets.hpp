// Assigns the columns of a file to quantities, from their headings and from [channels] of the rig description.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"

namespace firmware {

/// The text without blanks and tabs around it; where nothing is left, an empty part of it.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The heading of a column: "F_w [N]" has text "F_w [N]", name "F_w", unit "N".
struct Heading {
  std::string text;
  std::string name;
  std::optional<std::string> unit;
};
[[nodiscard]] Heading read_heading(std::string_view text);

/// The quantity of one column of a file:   value = scale × column + offset.
struct Target {
  Quantity quantity;
  double scale = 1.0;
  double offset = 0.0;

  [[nodiscard]] double value(double column) const {
    if (scale == 1.0 && offset == 0.0) return column;  // −0 stays −0
    return (quantity == time_quantity ? in_seconds(column, scale) : scale * column) + offset;
  }

  /// [s] A time stamp that was printed in a unit: the double nearest to the printed value in seconds, where the unit is
  /// a whole part of a second (stamp ÷ 1000 for milliseconds, and not stamp × 0.001).
  [[nodiscard]] static double in_seconds(double stamp, double scale);
};

/// The scale of a column, for every reader: `given` by its entry in [channels]; without one that of the unit which the
/// heading states; 1 where it states none. InputError (at `line` of the file) for a unit of another dimension or an
/// unknown one. `column`: its name, for the error.
[[nodiscard]] double column_scale(std::optional<double> given, std::string_view unit, Quantity quantity,
                                  std::string_view column, std::string_view source, std::size_t line);

/// The target of each column: first by the entries of the map, then by the names of the quantities. Columns without a
/// target are ignored. InputErrors (at `line` of the file): no column t, no known channel, two columns for one
/// quantity, two quantities from one column, a unit that column_scale() refuses.
[[nodiscard]] std::vector<std::optional<Target>> find_targets(const std::vector<Heading>& headings,
                                                              const ChannelMap& map, std::string_view source,
                                                              std::size_t line);

}  // namespace firmware
