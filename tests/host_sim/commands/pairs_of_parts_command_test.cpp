// Parts of a rig, two at a time in one description, through every command that takes one.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/program.hpp"

namespace pairs_of_parts_command_test {
namespace {

using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

struct Part {
  std::string_view name, text;
};

constexpr std::string_view car =
    "sample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\nstiffness = 200e3\ndamping = 100.0\n"
    "[noise]\nz_r = 2e-5\nzdd_r = 0.05\nzdd_w = 0.05\nzdd_b = 0.05\nF_w = 10.0\ndz_w = 5e-5\ndz_b = 5e-5\nF = 10.0\n"
    "x_act = 2e-5\n[limits]\nspeed = 1.5\n";
constexpr std::string_view spring = "[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n";
constexpr std::string_view no_spring = "[suspension]\nstiffness = 0.0\ndamping = 1140.0\n";

/// A part is one table or several; what stands in [machine] and [valves] is joined by hand.
const std::vector<Part>& parts() {
  static const std::vector<Part> all{
      {"lever", "[lever]\nat = [-0.08, 0.0, 0.08]\nratio = [0.75, 0.8, 0.85]\n"},
      {"lever with a kink at rest", "[lever]\nat = [-0.08, 0.0, 0.08]\nratio = [0.68, 0.8, 0.8]\n"},
      {"air spring", "[air_spring]\npressure = 7e5\narea = 40.64e-4\nvolume = 0.588e-3\nskyhook = 1000.0\n"},
      {"air spring behind a lever of 0.8", "[air_spring]\npressure = 7e5\narea = 50.8e-4\nvolume = 0.735e-3\n"},
      {"absorber",
       "[fdva]\npiston_area = 30e-4\nduct_diameter = 12e-3\nduct_length = 0.6361571127\noil_density = 860.0\n"
       "oil_viscosity = 32e-6\nminor_loss = 1.5\ncoupling_stiffness = 55e3\nducts = 6\nopen_ducts = 2\n"},
      {"curve",
       "[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 1.0]\nvalue = [-300.0, 0.0, "
       "150.0]\n"},
      {"gas damper",
       "[laws.gas]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 1.0]\nvalue = [-100.0, "
       "200.0, 350.0]\npreload = 200.0\n"},
      {"surface",
       "[laws.surface]\nplace = \"suspension\"\nover = [\"deflection\", \"velocity\"]\nat = [-0.1, 0.1]\nat_2 = "
       "[-1.0, 0.0, 1.0]\nvalue = [[-200.0, 0.0, 300.0], [-400.0, 0.0, 500.0]]\n"},
      {"stack",
       "[laws.bush]\nplace = \"suspension\"\nbranches = [{ stiffness = 8e3, slip_force = 12.0 }, { stiffness = "
       "6e3, time_constant = 0.02 }]\n"},
      {"tyre law",
       "[laws.tread]\nplace = \"tyre\"\nover = \"deflection\"\nat = [-0.02, 0.0, 0.02]\nvalue = [-100.0, 0.0, "
       "180.0]\n"},
      {"filter", "[estimator]\nkind = \"kalman\"\n"},
      {"compensation", "[compensation]\nkind = \"polynomial\"\n"},
      {"adaptive compensation", "[compensation]\nkind = \"adaptive_time_series\"\n"},
      {"delay", "[effects.actuator_delay]\ndelay = 0.006\n"},
      {"resonance", "[effects.actuator_resonance]\nfrequency = 60.0\ndamping_ratio = 0.7\n"},
      {"friction", "[effects.coulomb_friction]\nforce = 30.0\n"},
      {"two slopes", "[effects.asymmetric_damper]\ndifference = 300.0\n"},
      {"free play", "[effects.backlash]\ngap = 5e-4\n"},
      {"top mount", "[effects.top_mount]\nstiffness = 4e5\n"},
      {"bump stop", "[effects.bump_stop]\nclearance = 0.02\nstiffness = 1e5\n"},
      {"lag of F", "[effects.sensor_lag.F]\ntime_constant = 0.001\n"},
      {"hold", "[effects.sensor_hold.dz_b]\nperiod = 0.004\n"},
  };
  return all;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

 private:
  std::mt19937 random_;
};

struct Rig {
  std::string kind, name, text;
};

Rig drawn(Draw& draw) {
  constexpr std::array<std::string_view, 3> kinds{"quarter_car", "hil", "component_bench"};
  Rig rig{std::string(kinds[draw.below(8) % 3]), "", ""};
  const std::size_t a = draw.below(parts().size()), b = draw.below(parts().size());
  const bool varies = rig.kind == "hil" && draw.below(4) == 0;
  std::string text = "kind = \"" + rig.kind + "\"\n" + std::string(car);
  std::set<std::size_t> both{a, b};
  bool carried_by_air = false;
  for (const std::size_t i : both) {
    const std::string_view part = parts()[i].text;
    carried_by_air = carried_by_air || part.starts_with("[air_spring]");
    rig.name += " + " + std::string(parts()[i].name);
    text += part;
  }
  if (rig.kind == "hil") {
    text += std::string("[machine]\nvirtual_damping = 1140.0\n") +
            (varies ? "delay_swing = 1e-3\ndelay_jitter = 2e-4\n" : "");
  }
  if (both.count(4) > 0 && both.count(10) > 0) text += "[valves]\npolicy = \"rollout\"\n";
  rig.text = text + std::string(carried_by_air ? no_spring : spring);
  rig.name = rig.kind + rig.name + (varies ? " + delay that varies" : "");
  return rig;
}

/// Each command ends well or says in one line what does not fit; 6: the run was stopped by a limit, which is said.
bool ends_well(const Rig& rig, const std::vector<std::string>& words) {
  const Ended ended = rigtwin(words);
  const bool well = ended.status == 0 || ended.status == 3 || ended.status == 6;
  EXPECT_TRUE(well) << rig.name << ": " << words.front() << " ended with " << ended.status << ": " << ended.errors;
  return ended.status == 0;
}

// Law. No pair of parts ends in an internal error or a signal, whatever the command: it is computed or refused in words.
// RIGTWIN_PAIRS draws more than these few.
TEST(PairsOfPartsCommand, EndWellInEveryCommand) {
  const char* const wanted = std::getenv("RIGTWIN_PAIRS");
  const int draws = wanted != nullptr ? std::atoi(wanted) : 6;
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  Draw draw(20261130);
  int rigs = 0;
  for (int k = 0; k < draws; ++k) {
    const Rig rig = drawn(draw);
    std::ofstream(folder / "rig.toml") << rig.text;
    const bool ran = ends_well(
        rig, {"simulate", "--rig", at("rig.toml"), "--road", "iso8608:A", "--duration", "6", "--out", at("run.csv")});
    rigs += ran ? 1 : 0;
    ends_well(rig, {"fmu", "--rig", at("rig.toml"), "--out", at("rig.fmu")});
    if (rig.kind == "hil") {
      ends_well(rig, {"stability", "--rig", at("rig.toml"), "--json", at("stability.json")});
      std::ofstream(folder / "proven.toml") << rig.text;
      ends_well(rig, {"stability", "--write-limits", at("proven.toml")});
    }
    if (!ran) continue;
    ends_well(rig, {"compare", "--rig", at("rig.toml"), "--data", at("run.csv"), "--json", at("compare.json")});
    if (rig.kind == "quarter_car") {
      ends_well(rig, {"estimate", "--rig", at("rig.toml"), "--data", at("run.csv"), "--out", at("states.csv")});
    }
    if (wanted == nullptr || k % 8 != 0) continue;  // these two take ten times as long as all others
    ends_well(rig, {"plan", "--rig", at("rig.toml"), "--road", "iso8608:A", "--json", at("plan.json")});
    ends_well(rig, {"diagnose", "--rig", at("rig.toml"), "--data", at("run.csv"), "--out", at("diagnosis")});
  }
  EXPECT_GE(3 * rigs, draws);  // a third of what is drawn is a rig
}

}  // namespace
}  // namespace pairs_of_parts_command_test
