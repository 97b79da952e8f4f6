#include "firmware/description/text/quantity.hpp"

#include <array>

namespace firmware {
namespace {

constexpr std::array<std::string_view, recorded_ducts> duct_names{"duct_1", "duct_2", "duct_3",
                                                                  "duct_4", "duct_5", "duct_6"};

}  // namespace

std::string_view quantity_name(Quantity quantity) {
  if (quantity == time_quantity) return "t";
  return quantity < first_duct ? model::channel_names[quantity - 1].name : duct_names[quantity - first_duct];
}

std::string_view quantity_unit(Quantity quantity) {
  if (quantity == time_quantity) return "s";
  return quantity < first_duct ? model::channel_names[quantity - 1].unit : std::string_view{};
}

std::optional<Quantity> find_quantity(std::string_view wanted) {
  for (Quantity q = 0; q < quantity_count; ++q) {
    if (quantity_name(q) == wanted) return q;
  }
  return std::nullopt;
}

bool is_recorded_quantity(std::string_view name) { return find_quantity(name).has_value(); }

}  // namespace firmware
