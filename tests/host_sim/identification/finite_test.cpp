// Finite or nothing: whatever rig, effects and recordings a user brings, a verdict holds numbers or there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/truth/random.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// An effect with parameters from the lowest to the highest that its card allows, or far beyond what a rig has.
firmware::PlacedEffect extreme_effect(truth::Random& random, model::RigKind kind,
                                      const std::vector<Channel>& channels) {
  for (;;) {
    const auto pick = static_cast<std::size_t>(random.below(static_cast<int>(firmware::catalogue().size())));
    const firmware::CatalogueEntry& entry = firmware::catalogue()[pick];
    if (!entry.rigs.contains(kind) || entry.needs_fdva) continue;
    firmware::PlacedEffect effect{&entry, std::nullopt, {}};
    if (entry.of_channel) {
      effect.channel = channels[static_cast<std::size_t>(random.below(static_cast<int>(channels.size())))];
    }
    for (const model::EffectParameter& card : entry.parameters) {
      const double high = std::min(std::max(card.upper, 1e-6), 1e12);
      const double size = random.logarithmic(std::max(card.lower, 1e-9 * high), high);
      effect.values.push_back(card.lower < 0.0 && random.chance(0.5) ? -size : size);
    }
    return effect;
  }
}

/// Spoils a channel as recorders and wiring do: far too large, constant, one spike, or a growing tone.
void spoil(truth::Random& random, std::vector<double>& values) {
  const int what = random.below(5);
  const double size = random.logarithmic(1e-6, 1e12);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (what == 0) values[k] *= size;
    if (what == 1 && k > values.size() / 2) values[k] = size;
    if (what == 2 && k == values.size() / 3) values[k] = size;
    if (what == 3) values[k] += 1e-3 * std::exp(1e-3 * static_cast<double>(k)) * std::sin(0.2 * static_cast<double>(k));
  }
}

/// "" for a verdict in which every number is finite, or for a refusal in one line; else what is wrong.
std::string fault_of(const firmware::RigDescription& description, firmware::Recording recording) {
  try {
    const Diagnosis found = diagnose(description, {{std::move(recording), Use::shared}});
    (void)to_json(found);  // refuses what is not finite
    (void)result_rig(found.rig, found.rig, "given.toml");
    const std::string page = report_html(found, description);
    return page.empty() ? "no report" : "";
  } catch (const firmware::InputError& error) {
    return std::string(error.what()).find('\n') == std::string::npos ? "" : error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
}

// Law. Random effects of extreme size in the description or in the rig that recorded, channels spoiled by random
// amounts: a verdict of finite numbers, or one line.
TEST(Finite, VerdictOrOneLineWhateverIsBrought) {
  truth::Random random(11);
  for (int round = 0; round < 12; ++round) {
    const sample::Given base = sample::given(round % 2 == 0 ? "none:component_bench" : "pair:component_bench",
                                             static_cast<std::uint64_t>(round) / 4 + 1);
    firmware::RigDescription description = base.description;
    firmware::Recording recording = base.recording;
    recording.time.resize(6500);
    for (const Channel channel : {Channel::F, Channel::x_act, Channel::x_cmd}) recording[channel].resize(6500);
    if (random.chance(0.7)) {
      const auto effect = extreme_effect(random, description.rig.kind, {Channel::F, Channel::x_act});
      firmware::put_effect(description.rig, effect);
      if (firmware::find_rig_fault(description.rig, recording.sample_period)) description = base.description;
    }
    if (random.chance(0.7)) {
      const std::array<Channel, 3> channels{Channel::F, Channel::x_act, Channel::x_cmd};
      spoil(random, recording[channels[static_cast<std::size_t>(random.below(3))]]);
    }
    const std::string fault = fault_of(description, std::move(recording));
    EXPECT_EQ(fault, "") << "round " << round;
  }
}

// Journey. Lift-off of the tyre and a bump stop, both hidden: softening springs and tyres that fit the first three
// quarters must not grow without bound in the last.
TEST(Finite, VerdictOnARigThatLeavesTheRoad) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const sample::Given rig = sample::given("single:quarter_car:tyre_lift_off", seed);
    EXPECT_EQ(fault_of(rig.description, rig.recording), "") << seed;
  }
}

// Fault. A description whose simulation diverges is refused in one line, which names both files.
TEST(Finite, RefusesADescriptionThatDiverges) {
  const sample::Given rig = sample::given("none:quarter_car");
  firmware::RigDescription description = rig.description;
  firmware::put_effect(description.rig, {firmware::find_effect("progressive_spring"), std::nullopt, {-1e9}});
  try {
    (void)diagnose(description, {{rig.recording, Use::shared}});
    FAIL() << "a verdict on a rig that flies apart";
  } catch (const firmware::InputError& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("rig.toml"), std::string::npos) << line;
    EXPECT_NE(line.find("without bound"), std::string::npos) << line;
  }
}

}  // namespace
