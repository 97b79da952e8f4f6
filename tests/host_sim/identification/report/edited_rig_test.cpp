// The description that diagnose leaves is the user's own, with other numbers.
#include "host_sim/identification/report/edited_rig.hpp"

#include <gtest/gtest.h>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/values/effects_by_name.hpp"

namespace {

using host_sim::identification::edited_rig;

constexpr std::string_view text = R"(# Our bench.  Do not move.
kind = "component_bench"
sample_rate = 1000.0   # Hz

[suspension]
stiffness = 30000.0    # N/m, from the data sheet
damping   = 1500       # N s/m

[noise]                # at rest, 3 May
F = 10.0
)";

firmware::RigDescription given() {
  firmware::RigDescription rig = firmware::parse_rig(text, "bench.toml");
  rig.text = text;
  return rig;
}

// Law. Comments, order and spelling stay; the number that changed is replaced where it stands; what is new follows; and
// it reads back as what was found.
TEST(EditedRig, KeepsCommentsAndReplacesNumbers) {
  firmware::RigDescription found = given();
  found.rig.suspension.damping = 1800.5;
  firmware::put_effect(found.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {45.0}});
  const std::string edited = edited_rig(given(), found);
  EXPECT_NE(edited.find("# Our bench.  Do not move.\n"), std::string::npos) << edited;
  EXPECT_NE(edited.find("stiffness = 30000.0    # N/m, from the data sheet\n"), std::string::npos) << edited;
  EXPECT_NE(edited.find("damping   = 1800.5       # N s/m\n"), std::string::npos) << edited;
  EXPECT_NE(edited.find("\n[effects.coulomb_friction]\nforce = 45.0\n"), std::string::npos) << edited;
  EXPECT_EQ(edited.find("[limits]"), std::string::npos) << "nobody asked for limits";
  EXPECT_EQ(firmware::format_rig(firmware::parse_rig(edited, "x")), firmware::format_rig(found));
}

// Law. What cannot be edited line by line is written in full, and reads back all the same.
TEST(EditedRig, WritesInFullWhatItCannotEdit) {
  firmware::RigDescription inlined = given();
  inlined.text =
      "kind = \"component_bench\"\nsample_rate = 1000.0\nsuspension = { stiffness = 30000.0, damping = "
      "1500.0 }\nnoise = { F = 10.0 }\n";
  firmware::RigDescription found = inlined;
  found.rig.suspension.damping = 1800.5;
  EXPECT_EQ(edited_rig(inlined, found), firmware::format_rig(found));
  firmware::RigDescription without = given();
  without.text.clear();
  EXPECT_EQ(edited_rig(without, found), firmware::format_rig(found));
}

}  // namespace
