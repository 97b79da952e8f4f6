// Guesses which quantity a column of a foreign file holds, from its name and unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/units.hpp"
#include "model/components/channel.hpp"

namespace host_sim {

/// A guess and the words that led to it.
struct ChannelGuess {
  firmware::Quantity quantity;
  std::string reason;  ///< "'weg': a displacement; 'rad': of the wheel"
  int words;           ///< number of words and abbreviations that agree
};

/// The channel that a column's name and the dimension of its unit suggest on a rig of this kind. Without a kind the
/// words decide: places (road, wheel, body) mean a quarter car, others a test machine.
///
///   kind of quantity   Weg, Position, Hub, displacement, stroke, travel → length; Beschleunigung, acc → acceleration;
///                      Kraft, Last, force, load → force. A unit that disagrees ends the guess.
///   place              Straße, Fußpunkt, road, base → z_r; Rad, Achse, wheel, unsprung → z_w; Aufbau, body, sprung →
///                      z_b; Reifen, tyre with a deflection → dz_w; Federweg, suspension deflection → dz_b
///   machine            Soll, command, reference → x_cmd; Ist, actual, feedback, Kolben, stroke → x_act
///   abbreviations      zr, zu, zs, Fz, xist … as the textbooks have them
///
/// A unit alone suggests nothing, except for names that say nothing either ("Channel 1 [mm]", "AI3 [N]"): rain is
/// measured in mm as well.
///
/// Names that speak of errors, limits, extremes, counts or temperatures are no channel. nullopt: nothing is suggested.
[[nodiscard]] std::optional<ChannelGuess> guess_channel(std::string_view name,
                                                        std::optional<firmware::Dimension> dimension,
                                                        std::optional<model::RigKind> kind);

/// Whether the name says what kind of signal it is ("Weg", "force", "body") or abbreviates a channel: then it is no
/// time.
[[nodiscard]] bool names_a_signal(std::string_view name);

/// Whether the name speaks of a place on a quarter car: with one such column the file is taken as a quarter car's.
[[nodiscard]] bool names_a_place(std::string_view name);

/// Whether the name is that of a time axis: Zeit, time, t, timestamp …; of a row number: sample, index, Nr …
[[nodiscard]] bool is_time_name(std::string_view name);
[[nodiscard]] bool is_sample_number_name(std::string_view name);

}  // namespace host_sim
