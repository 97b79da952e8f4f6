// What diagnose leaves is a rig for every other command: each effect of the catalogue, on each kind of rig where it has
// a place, through simulate (the firmware in its loop), compare and stability, as files and as a shell meets them.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::CatalogueEntry;
using firmware::PlacedEffect;
using firmware::RigDescription;
using model::Channel;
using support::rigtwin;
using support::TemporaryFolder;

/// Sizes that a rig can have and that show on a road of class B.
std::vector<double> size_of(std::string_view effect) {
  static const std::map<std::string_view, std::vector<double>> sizes{{"actuator_delay", {0.0061}},
                                                                     {"actuator_lag", {0.0032}},
                                                                     {"actuator_resonance", {31.7, 0.62}},
                                                                     {"actuator_rate_limit", {0.093}},
                                                                     {"coulomb_friction", {47.3}},
                                                                     {"viscous_damping", {153.9}},
                                                                     {"quadratic_damping", {417.1}},
                                                                     {"progressive_spring", {9.7e6}},
                                                                     {"bump_stop", {0.0023, 71e3}},
                                                                     {"backlash", {0.0017}},
                                                                     {"top_mount", {2.9e5}},
                                                                     {"relaxation", {8.3e3, 0.037}},
                                                                     {"seal_friction", {19.1}},
                                                                     {"body_guide_friction", {37.9}},
                                                                     {"wheel_guide_friction", {43.3}},
                                                                     {"body_guide_damping", {101.3}},
                                                                     {"wheel_guide_damping", {83.9}},
                                                                     {"tyre_lift_off", {}},
                                                                     {"progressive_tyre", {3.1e9}},
                                                                     {"force_sensor_inertia", {4.7}},
                                                                     {"sensor_lag", {0.0043}},
                                                                     {"sensor_delay", {0.0037}},
                                                                     {"sensor_gain", {1.087}},
                                                                     {"sensor_offset", {113.0}},
                                                                     {"sensor_saturation", {291.0}},
                                                                     {"sensor_hold", {0.0071}},
                                                                     {"moving_mass", {6.3}},
                                                                     {"asymmetric_damper", {153.0}},
                                                                     {"stribeck_friction", {37.1, 0.61, 0.023}},
                                                                     {"bouc_wen", {6.1e4, 43.7, 0.13}},
                                                                     {"hardening_hysteresis", {4.3e4, 171.0, 5.7}},
                                                                     {"position_ripple", {0.0031, 9.3, -4.1}},
                                                                     {"air_leak", {0.0031}},
                                                                     {"stuck_area", {0.043}},
                                                                     {"gas_exponent", {1.13}}};
  return sizes.at(effect);
}

/// The largest nrmse of a channel that `compare` reports.
double worst_error(const std::filesystem::path& rig, const std::filesystem::path& data) {
  const auto ended = rigtwin({"compare", "--rig", rig.string(), "--data", data.string(), "--json", "-"});
  EXPECT_EQ(ended.status, 0) << ended.errors;
  double worst = 0.0;
  const auto json = nlohmann::json::parse(ended.output);
  for (const auto& channel : json["channels"]) {
    worst = std::max(worst, channel["nrmse"].is_number() ? channel["nrmse"].get<double>() : 0.0);
  }
  return worst;
}

nlohmann::json stability_of(const std::filesystem::path& rig) {
  const auto ended = rigtwin({"stability", "--rig", rig.string(), "--json", "-"});
  EXPECT_EQ(ended.status, 0) << ended.errors;
  return nlohmann::json::parse(ended.output);
}

class RoundTrip : public testing::TestWithParam<const char*> {
 protected:
  /// A rig that comes with the project, without effects and noise.
  void SetUp() override {
    plain = support::rig(GetParam());
    for (const PlacedEffect& effect : firmware::effects_of(plain.rig))
      firmware::remove_effect(plain.rig, *effect.entry, effect.channel);
    plain.noise = {};
    plain.range = {};
    plain.controller.stroke = 2.0;  // [m]; [m/s] for the road on which a tyre lifts off
    plain.controller.speed = 10.0;
    folder.write("plain.toml", format("given.toml", plain));
  }
  static std::string format(const char* given, const RigDescription& description) {
    return host_sim::identification::result_rig(description, description, given);
  }

  RigDescription plain;
  TemporaryFolder folder;
};

// The file holds the effect with its values to the bit; a recording simulated with it is explained with it, and not
// without it; stability's loop has its linear part, or says that it has none.
TEST_P(RoundTrip, OfEveryEffectThroughEveryCommand) {
  const auto rig = folder / "rig.toml", run = folder / "run.csv";
  const bool hil = plain.rig.kind == model::RigKind::hil;
  const auto stability_without = hil ? stability_of(folder / "plain.toml") : nlohmann::json();
  const Channel sensor = plain.rig.kind == model::RigKind::quarter_car ? Channel::F_w : Channel::F;
  for (const CatalogueEntry& entry : firmware::catalogue()) {
    const std::optional<Channel> channel = entry.of_channel ? std::optional(sensor) : std::nullopt;
    if (!has_place(plain.rig, entry, channel)) continue;
    if (plain.rig.air_spring.fitted && !entry.needs_air_spring) continue;  // the other rigs meet it
    SCOPED_TRACE(std::string(GetParam()) + " " + std::string(entry.name));
    const PlacedEffect effect{&entry, channel, size_of(entry.name)};
    RigDescription found = plain;
    firmware::put_effect(found.rig, effect);
    folder.write("rig.toml", format("given.toml", found));

    const auto again = firmware::effects_of(firmware::read_rig(rig).rig);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].entry, &entry);
    EXPECT_EQ(again[0].channel, channel);
    EXPECT_EQ(again[0].values, effect.values);

    // Lift-off takes a road of class D.
    const bool loud = entry.name == "tyre_lift_off";
    const auto simulated = rigtwin({"simulate", "--rig", rig.string(), "--road", loud ? "iso8608:D" : "iso8608:B",
                                    "--duration", loud ? "6" : "4", "--out", run.string()});
    ASSERT_EQ(simulated.status, 0) << simulated.errors;
    EXPECT_EQ(simulated.errors, "") << "nothing tripped";
    // Without noise the same model is left with the interpolation of its input and the rounding of corners in time; a
    // hold begins at a phase that compare does not know.
    const double with = worst_error(rig, run), without = worst_error(folder / "plain.toml", run);
    EXPECT_GT(without, 0.003);
    EXPECT_LT(with, entry.name == "sensor_hold" ? without : 0.2 * without) << without;

    if (!hil) continue;
    const auto stability = stability_of(rig);
    std::string left_out = stability["left_out"].dump();
    switch (entry.linearisation) {
      case model::Linearisation::exact:
      case model::Linearisation::tangent:
        EXPECT_EQ(left_out, stability_without["left_out"].dump());
        EXPECT_NE(stability["rightmost"], stability_without["rightmost"]);
        break;
      case model::Linearisation::left_out:
        EXPECT_NE(left_out.find(entry.name), std::string::npos) << left_out;
        EXPECT_EQ(stability["rightmost"], stability_without["rightmost"]);
        break;
      default:
        ADD_FAILURE() << "an effect of a hil rig that stability does not know";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, RoundTrip,
                         testing::Values("paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "paper_hil_aas"));

// Every effect has a place in one of these rigs at least: none is left out of the round trip.
TEST(RoundTripOfAll, MeetsEveryEffect) {
  for (const CatalogueEntry& entry : firmware::catalogue()) {
    bool somewhere = false;
    for (const char* name : {"paper_hil_fdva", "paper_rig_fdva", "paper_bench_fdva", "paper_hil_aas"}) {
      const auto rig = support::rig(name).rig;
      const std::optional<Channel> channel =
          entry.of_channel ? std::optional(rig.kind == model::RigKind::quarter_car ? Channel::F_w : Channel::F)
                           : std::nullopt;
      somewhere = somewhere || has_place(rig, entry, channel);
    }
    EXPECT_TRUE(somewhere) << entry.name;
    EXPECT_EQ(size_of(entry.name).size(), entry.parameters.size()) << entry.name;
  }
}

}  // namespace
