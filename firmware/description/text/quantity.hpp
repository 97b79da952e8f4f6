// The quantities that a recording may hold: time, the channels, the positions of the ducts.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "model/components/channel.hpp"

namespace firmware {

inline constexpr std::size_t recorded_ducts = 6;

/// A quantity by number: 0 time, then the channels in the order of model::Channel, then the ducts.
using Quantity = std::size_t;
inline constexpr Quantity time_quantity = 0;
inline constexpr Quantity first_duct = 1 + model::channel_count;
inline constexpr std::size_t quantity_count = first_duct + recorded_ducts;

[[nodiscard]] std::string_view quantity_name(Quantity quantity);  ///< "t", "F_w", "duct_1"
[[nodiscard]] std::string_view quantity_unit(Quantity quantity);  ///< "s", "N"; empty for ducts
[[nodiscard]] std::optional<Quantity> find_quantity(std::string_view name);

/// Whether a recording may have a column of this name: "t", a channel, "duct_1" … "duct_6".
[[nodiscard]] bool is_recorded_quantity(std::string_view name);

}  // namespace firmware
