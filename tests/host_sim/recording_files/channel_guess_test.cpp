// Guesses of channels from names and units, and what must not be guessed.
#include "host_sim/recording_files/tables/channel_guess.hpp"

#include <gtest/gtest.h>

#include "firmware/description/text/units.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/tables/headings.hpp"

namespace {

using firmware::Dimension;
using model::RigKind;

std::string guess(const char* heading, std::optional<RigKind> kind = std::nullopt) {
  const host_sim::NameAndUnit parts = host_sim::split_heading(heading);
  const auto unit = firmware::find_unit(parts.unit);
  const auto guessed = host_sim::guess_channel(parts.name, unit ? std::optional(unit->dimension) : std::nullopt, kind);
  return guessed ? std::string(firmware::quantity_name(guessed->quantity)) : "";
}

// Words of both languages, compounds, paths, abbreviations of textbooks.
TEST(ChannelGuess, KnowsTheNamesThatEngineersUseOnAQuarterCar) {
  for (const auto& [heading, channel] :
       std::initializer_list<std::pair<const char*, const char*>>{{"Weg Rad [mm]", "z_w"},
                                                                  {"Radweg [mm]", "z_w"},
                                                                  {"Fußpunktweg (mm)", "z_r"},
                                                                  {"Straßenanregung in mm", "z_r"},
                                                                  {"road displacement [m]", "z_r"},
                                                                  {"Aufbaubeschleunigung [g]", "zdd_b"},
                                                                  {"bodyAcceleration [m/s^2]", "zdd_b"},
                                                                  {"acc wheel [g]", "zdd_w"},
                                                                  {"Beschl. Radträger / m/s²", "zdd_w"},
                                                                  {"unsprung mass position [mm]", "z_w"},
                                                                  {"sprung mass position [mm]", "z_b"},
                                                                  {"Federweg [mm]", "dz_b"},
                                                                  {"Suspension Deflection [mm]", "dz_b"},
                                                                  {"Reifeneinfederung [mm]", "dz_w"},
                                                                  {"tire deflection [mm]", "dz_w"},
                                                                  {"Radlast [kN]", "F_w"},
                                                                  {"dynamic wheel load [N]", "F_w"},
                                                                  {"Aktorkraft [N]", "F_act"},
                                                                  {"Actuator Force [N]", "F_act"},
                                                                  {"Model Root/Plant/Weg Rad [mm]", "z_w"},
                                                                  {"z_s [m]", "z_b"},
                                                                  {"zu", "z_w"},
                                                                  {"ddz_b", "zdd_b"},
                                                                  {"Kolbenweg [mm]", ""},
                                                                  {"Daempferkraft [N]", ""},
                                                                  {"Weg [mm]", ""}}) {
    EXPECT_EQ(guess(heading, RigKind::quarter_car), channel) << heading;
  }
}

TEST(ChannelGuess, KnowsTheNamesThatEngineersUseOnATestMachine) {
  for (const auto& [heading, channel] :
       std::initializer_list<std::pair<const char*, const char*>>{{"Sollweg [mm]", "x_cmd"},
                                                                  {"Istweg [mm]", "x_act"},
                                                                  {"Weg Soll [mm]", "x_cmd"},
                                                                  {"Axial Displacement [mm]", "x_act"},
                                                                  {"Axial Displacement Command [mm]", "x_cmd"},
                                                                  {"Stroke [in]", "x_act"},
                                                                  {"Hub [mm]", "x_act"},
                                                                  {"Kraft [kN]", "F"},
                                                                  {"Dämpferkraft [N]", "F"},
                                                                  {"Load Cell [lbf]", "F"},
                                                                  {"Axial Force Command [kN]", ""},
                                                                  {"Axial Displacement Error [mm]", ""},
                                                                  {"Axial Force Max [kN]", ""},
                                                                  {"Temperatur [-]", ""},
                                                                  {"Piston Velocity [mm/s]", ""},
                                                                  {"Force [mm]", ""},
                                                                  {"Pressure [bar]", ""}}) {
    EXPECT_EQ(guess(heading, RigKind::component_bench), channel) << heading;
  }
}

// Without a rig the words decide which kind it is.
TEST(ChannelGuess, DecidesByTheWordsWhereTheRigIsNotKnown) {
  EXPECT_EQ(guess("Weg Rad [mm]"), "z_w");
  EXPECT_EQ(guess("Weg [mm]"), "x_act");
  EXPECT_EQ(guess("Kraft [kN]"), "F");
  EXPECT_TRUE(host_sim::names_a_place("Aufbau"));
  EXPECT_FALSE(host_sim::names_a_place("Kraft"));
}

// A factor of each unit against its definition.
TEST(Units, AreConvertedByTheirDefinitions) {
  const auto factor = [](const char* unit) {
    return firmware::find_unit(unit).value_or(firmware::Unit{firmware::Dimension::none, 0.0}).scale;
  };
  EXPECT_EQ(factor("mm"), 1e-3);
  EXPECT_EQ(factor("µm"), 1e-6);
  EXPECT_EQ(factor("μm"), 1e-6);
  EXPECT_EQ(factor("in"), 0.0254);
  EXPECT_EQ(factor("kN"), 1e3);
  EXPECT_EQ(factor("KN"), 1e3);
  EXPECT_EQ(factor("mN"), 1e-3);
  EXPECT_EQ(factor("MN"), 1e6);
  EXPECT_NEAR(factor("lbf"), 4.4482216152605, 1e-13);
  EXPECT_EQ(factor("g"), 9.80665);
  EXPECT_EQ(factor("bar"), 1e5);
  EXPECT_NEAR(factor("psi"), 6894.757293168, 1e-6);
  EXPECT_EQ(factor("Sec"), 1.0);
  EXPECT_EQ(factor("10 mm"), 0.01);
  for (const char* unit : {"m/s²", "m/s^2", "m/s2", "m/s**2", "m s^-2", "m·s⁻²"}) EXPECT_EQ(factor(unit), 1.0) << unit;
  EXPECT_FALSE(firmware::find_unit("furlong"));
  EXPECT_FALSE(firmware::find_unit(""));
}

TEST(Units, AreFoundInHeadings) {
  const auto parts = [](const char* heading) {
    const host_sim::NameAndUnit split = host_sim::split_heading(heading);
    return split.name + "|" + split.unit;
  };
  EXPECT_EQ(parts("Weg Rad [mm]"), "Weg Rad|mm");
  EXPECT_EQ(parts("Weg Rad (mm)"), "Weg Rad|mm");
  EXPECT_EQ(parts("Weg Rad / mm"), "Weg Rad|mm");
  EXPECT_EQ(parts("a_b / m/s²"), "a_b|m/s²");
  EXPECT_EQ(parts("Zeit in ms"), "Zeit|ms");
  EXPECT_EQ(parts("Kraft, kN"), "Kraft|kN");
  EXPECT_EQ(parts("Weg_Rad_mm"), "Weg_Rad|mm");
  EXPECT_EQ(parts("Kraft_N"), "Kraft|N");
  EXPECT_EQ(parts("z_s"), "z_s|");
  EXPECT_EQ(parts("Signal (2)"), "Signal (2)|");
  EXPECT_EQ(parts("F_w"), "F_w|");
}

// The mapping goes into [channels] and nothing else moves.
TEST(WriteChannels, PutsEntriesIntoTheTableAndLeavesTheRest) {
  const firmware::ChannelMap map{{"z_w", {"Weg \"Rad\"", 1e-3, 0.0}}, {"F_w", {"Last", 1000.0, 5.0}}};
  const std::string before =
      "kind = \"quarter_car\"  # mine\n\n[channels]  # by hand\nz_w = { column = \"old\" }\nz_r = { column = \"r\" "
      "}\n\n[body]\nmass = 1.0\n";
  EXPECT_EQ(host_sim::with_channels(before, map, "from rec.csv"),
            "kind = \"quarter_car\"  # mine\n\n[channels]  # by hand\nz_r = { column = \"r\" }\n# from rec.csv\n"
            "F_w = { column = \"Last\", scale = 1000.0, offset = 5.0 }\nz_w = { column = \"Weg \\\"Rad\\\"\", scale = "
            "0.001 }\n\n[body]\nmass = 1.0\n");
  EXPECT_EQ(host_sim::with_channels("a = 1\n", {{"F", {"K", 1.0, 0.0}}}, ""),
            "a = 1\n\n[channels]\nF = { column = \"K\", scale = 1.0 }\n");
}

}  // namespace
