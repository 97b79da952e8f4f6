#include "host_sim/comparison/side_by_side.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "model/rig/rig_model.hpp"

namespace side_by_side_test {
namespace {

using host_sim::InitialState;
using host_sim::LaneUse;
using host_sim::Response;
using host_sim::SideBySideRig;
using host_sim::SimulationInput;
using model::Channel;
using model::RigKind;
using Rig = model::RigParameters<double>;

constexpr double period = 1e-3;       // [s]
constexpr std::size_t samples = 500;  // no multiple of a block, several blocks
constexpr model::MotionScales scales{.force = 300.0,
                                     .deflection = 5e-3,
                                     .deflection_peak = 1.5e-2,
                                     .velocity = 0.1,
                                     .velocity_peak = 0.3,
                                     .acceleration = 8.0,
                                     .tyre_force = 400.0,
                                     .tyre_deflection = 2e-3,
                                     .foot_acceleration = 5.0,
                                     .ripple_period = 5e-3,
                                     .channel = 1.0};

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double between(double lower, double upper) { return std::uniform_real_distribution<>(lower, upper)(generator_); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(generator_); }

 private:
  std::mt19937 generator_;
};

Rig plain_rig(Random& random, RigKind kind) {
  Rig rig;
  rig.kind = kind;
  rig.body.mass = random.between(200.0, 400.0);
  rig.wheel.mass = random.between(30.0, 50.0);
  rig.tyre.stiffness = random.between(1.5e5, 2.5e5);
  rig.tyre.damping = random.between(50.0, 150.0);
  rig.suspension.stiffness = random.between(2e4, 4e4);
  rig.has_fdva = random.chance(0.6);
  rig.suspension.damping = random.chance(0.2) ? 0.0 : random.between(500.0, 1500.0);
  if (kind == RigKind::hil) rig.machine.virtual_damping = random.between(1500.0, 2500.0);
  if (rig.has_fdva) {
    rig.fdva = {30e-4, 12e-3, random.between(0.4, 0.8), 860.0, 32e-6, 1.5, random.between(4e4, 7e4), 6, 0};
    rig.fdva.open_ducts = static_cast<int>(random.below(7));
  }
  return rig;
}

/// Effects as the fits of a diagnosis begin with them, each with a given probability.
void add_effects(Random& random, Rig& rig, double probability) {
  rig.effects.for_each([&](auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if (!Effect::card.rigs.contains(rig.kind) || (Effect::card.needs_fdva && !rig.has_fdva)) return;
    if (Effect::card.needs_air_spring) return;  // these rigs have none
    if (!random.chance(probability)) return;
    slot.active = true;
    for (std::size_t i = 0; i < Effect::values.size(); ++i) {
      const model::Starts& starts = Effect::card.parameters[i].starts;
      const double* const factor = starts.factors.begin() + random.below(starts.factors.size());
      slot.effect.*Effect::values[i] = *factor * starts.scale(scales);
    }
  });
}

/// Laws of each kind at some places, curves and surfaces as dampers and springs have them; not every rig has such
/// places.
void draw_laws(Random& random, Rig& rig) {
  const auto place = [&](std::size_t places = model::force_places) {
    return static_cast<model::LawPlace>(random.below(places));
  };
  for (std::size_t i = random.below(4); i > 0; --i) {
    model::CurveTable<double>& curve = rig.laws.curves[rig.laws.curve_count++];
    curve.place = place(model::force_places + 1);
    curve.channel = model::channel_at(random.below(model::channel_count));
    curve.over = random.chance(0.5) ? model::LawOver::velocity : model::LawOver::deflection;
    curve.count = static_cast<std::uint8_t>(2 + random.below(32));
    const double width = curve.over == model::LawOver::velocity ? 0.5 : 1e-2;
    for (std::size_t k = 0; k < curve.count; ++k) {
      const double from_middle = static_cast<double>(k) - 0.5 * static_cast<double>(curve.count - 1);
      curve.at[k] = width * (from_middle + random.between(-0.3, 0.3)) / curve.count;
      curve.value[k] = 200.0 * std::tanh(3.0 * curve.at[k] / width) + random.between(-5.0, 5.0);
    }
    if (curve.place == model::LawPlace::sensor || random.chance(0.7)) continue;
    std::sort(curve.value.begin(), curve.value.begin() + curve.count);
    curve.behind = random.between(1e4, 1e6);
  }
  if (random.chance(0.3)) {
    model::SurfaceTable<double>& surface = rig.laws.surfaces[rig.laws.surface_count++];
    surface.place = place();
    surface.rows = static_cast<std::uint8_t>(2 + random.below(16));
    surface.columns = static_cast<std::uint8_t>(2 + random.below(16));
    for (std::size_t i = 0; i < surface.rows; ++i) surface.deflection[i] = 1e-3 * static_cast<double>(i) - 5e-3;
    for (std::size_t j = 0; j < surface.columns; ++j) surface.velocity[j] = 0.05 * static_cast<double>(j) - 0.3;
    for (std::size_t i = 0; i < surface.rows; ++i) {
      for (std::size_t j = 0; j < surface.columns; ++j) {
        surface.value[i][j] = 300.0 * std::tanh(4.0 * surface.velocity[j]) * (1.0 + 20.0 * surface.deflection[i]);
      }
    }
  }
  for (std::size_t i = random.below(4); i > 0; --i) {
    const bool maxwell = random.chance(0.4);
    rig.laws.branches[rig.laws.branch_count++] = {
        place(), 2e4, maxwell ? 0.02 : 0.0, maxwell ? 0.0 : random.between(5.0, 60.0), random.chance(0.3) ? 1e-3 : 0.0};
  }
}

void add_laws(Random& random, Rig& rig) {
  do {
    rig.laws = {};
    draw_laws(random, rig);
  } while (model::find_fault(rig, period, model::usual_delay_capacity));
}

/// The same rig with other values; delays sometimes a whole number of samples.
Rig another(Random& random, const Rig& rig) {
  Rig other = rig;
  model::for_each_number(other, [&](double& number) { number *= random.between(0.9, 1.1); });
  const double wider = random.between(0.9, 1.1), harder = random.between(0.9, 1.1);  // points stay in their order
  for (model::CurveTable<double>& curve : other.laws.curves) {
    for (double& at : curve.at) at *= wider;
    for (double& value : curve.value) value *= harder * random.between(0.99, 1.01);
    curve.behind *= wider;
    if (curve.behind > 0.0) std::sort(curve.value.begin(), curve.value.begin() + curve.count);
  }
  for (model::SurfaceTable<double>& surface : other.laws.surfaces) {
    for (double& at : surface.deflection) at *= wider;
    for (double& at : surface.velocity) at *= harder;
  }
  for (model::BranchNumbers<double>& branch : other.laws.branches) {
    branch.stiffness *= wider;
    branch.time_constant *= harder;
    branch.slip_force *= harder;
  }
  auto& delay = other.effects.get<model::ActuatorDelay>().effect.delay;
  if (random.chance(0.4)) delay = std::ceil(delay / period) * period;
  return other;
}

SimulationInput input_of(Random& random, const Rig& rig) {
  SimulationInput input;
  input.period = period;
  const double a = random.between(5e-3, 2e-2), f = random.between(5.0, 80.0), g = random.between(100.0, 300.0);
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) * period;
    input.motion.push_back({a * std::sin(f * t) + 0.02 * a * std::sin(g * t),
                            a * f * std::cos(f * t) + 0.02 * a * g * std::cos(g * t), -a * f * f * std::sin(f * t)});
  }
  if (rig.kind == RigKind::component_bench) {
    input.deflection_reached = random.chance(0.3);
  } else if (rig.kind == RigKind::quarter_car && random.chance(0.3)) {
    for (std::size_t k = 0; k < samples; ++k) input.actuator_force.push_back(random.between(-50.0, 50.0));
  }
  if (rig.has_fdva && random.chance(0.4)) {
    model::OpenDucts open = model::first_ducts(rig.fdva.open_ducts);
    for (std::size_t k = 0; k < samples; ++k) {
      if (random.chance(0.02)) open = static_cast<model::OpenDucts>(random.below(64));
      input.ducts.push_back(open);
    }
  }
  return input;
}

std::vector<InitialState> starts_for(Random& random, std::size_t count) {
  std::vector<InitialState> starts(count);
  for (InitialState& start : starts) {
    for (int i = 0; i < 6; ++i) start(i) = random.between(-1.0, 1.0) * (i % 2 == 0 ? 2e-3 : 0.05);
  }
  return starts;
}

bool same_bits(double a, double b) { return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0; }

void expect_same_bits(const Response& alone, const Response& beside, const std::string& what) {
  for (std::size_t c = 0; c < alone.size(); ++c) {
    ASSERT_EQ(alone[c].size(), beside[c].size()) << what;
    for (std::size_t k = 0; k < alone[c].size(); ++k) {
      ASSERT_TRUE(same_bits(alone[c][k], beside[c][k]))
          << what << ": " << model::channel_names[c].name << " at sample " << k << ": " << alone[c][k] << " alone, "
          << beside[c][k] << " beside others";
    }
  }
}

class SideBySide : public testing::TestWithParam<LaneUse> {
 protected:
  void SetUp() override {
    if (!host_sim::has_lanes(GetParam())) GTEST_SKIP() << "this processor or build has no such registers";
  }
};

/// One random rig in several variants, alone and beside each other.
void check(unsigned seed, double probability, LaneUse use, bool laws = false) {
  Random random(seed);
  const auto kind = static_cast<RigKind>(random.below(3));
  Rig first = plain_rig(random, kind);
  add_effects(random, first, probability);
  if (laws) add_laws(random, first);
  const SimulationInput input = input_of(random, first);
  std::vector<Rig> rigs{first};
  const std::size_t count = 2 + random.below(9);
  while (rigs.size() < count) rigs.push_back(another(random, first));
  const std::vector<InitialState> starts = starts_for(random, count);
  const int substeps = random.chance(0.4) ? 3 : 1;

  std::vector<SideBySideRig> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back({&rigs[i], &starts[i], &input});
  const std::vector<Channel> channels = host_sim::response_channels(kind, input);
  const auto beside = host_sim::simulate_side_by_side(all, 0, substeps, channels, use);
  for (std::size_t i = 0; i < count; ++i) {
    expect_same_bits(host_sim::simulate(rigs[i], input, starts[i], 0, substeps), beside[i],
                     "seed " + std::to_string(seed) + ", rig " + std::to_string(i));
    if (testing::Test::HasFatalFailure()) return;
  }
}

// Law. A rig that is simulated beside others gets exactly the bits that it gets alone, whatever it consists of.
TEST_P(SideBySide, RigsWithoutEffectsKeepTheirBits) {
  for (unsigned seed = 1; seed <= 20 && !HasFatalFailure(); ++seed) check(seed, 0.0, GetParam());
}
TEST_P(SideBySide, RigsWithAFewEffectsKeepTheirBits) {
  for (unsigned seed = 100; seed <= 220 && !HasFatalFailure(); ++seed) check(seed, 0.12, GetParam());
}
TEST_P(SideBySide, RigsWithManyEffectsKeepTheirBits) {
  for (unsigned seed = 300; seed <= 340 && !HasFatalFailure(); ++seed) check(seed, 0.6, GetParam());
}

// Law. Laws, each lane with points of its own.
TEST_P(SideBySide, RigsWithLawsKeepTheirBits) {
  for (unsigned seed = 400; seed <= 480 && !HasFatalFailure(); ++seed) check(seed, 0.1, GetParam(), true);
}

// Law. Parameters that change while the rigs move, at the same samples.
TEST_P(SideBySide, RigsThatChangeKeepTheirBits) {
  for (unsigned seed = 500; seed <= 530; ++seed) {
    Random random(seed);
    Rig first = plain_rig(random, static_cast<RigKind>(random.below(3)));
    add_effects(random, first, 0.1);
    if (seed % 2 == 0) add_laws(random, first);
    const SimulationInput input = input_of(random, first);
    const std::vector<Rig> rigs{first, another(random, first), another(random, first), another(random, first)};
    const std::vector<InitialState> starts = starts_for(random, rigs.size());
    std::vector<host_sim::RigVariation> variations;
    for (const Rig& rig : rigs) {
      const double share = random.between(0.1, 0.5);
      variations.push_back({7 + random.below(2), [&rig, share](std::size_t k) {
                              Rig changed = rig;
                              changed.suspension.stiffness *= 1.0 - share * static_cast<double>(k) / samples;
                              return changed;
                            }});
    }
    variations[1].every = variations[2].every = variations[0].every;  // the last one may have no lane beside them
    std::vector<SideBySideRig> all;
    for (std::size_t i = 0; i < rigs.size(); ++i) all.push_back({&rigs[i], &starts[i], &input, &variations[i]});
    const std::vector<Channel> channels = host_sim::response_channels(first.kind, input);
    const auto beside = host_sim::simulate_side_by_side(all, 0, 2, channels, GetParam());
    for (std::size_t i = 0; i < rigs.size(); ++i) {
      expect_same_bits(host_sim::simulate(rigs[i], input, starts[i], 0, 2, variations[i]), beside[i],
                       "seed " + std::to_string(seed) + ", rig " + std::to_string(i));
      if (HasFatalFailure()) return;
    }
  }
}

// Point. Laws of other kinds, places or sizes are other parts; other points are other values.
TEST_P(SideBySide, RigsWithOtherLawsAreNotAlike) {
  Random random(9);
  Rig rig = plain_rig(random, RigKind::quarter_car);
  model::CurveTable<double>& curve = rig.laws.curves[rig.laws.curve_count++];
  curve.count = 3;
  curve.at = {-1.0, 0.0, 1.0};
  curve.value = {-300.0, 1.0, 200.0};
  rig.laws.branches[rig.laws.branch_count++] = {model::LawPlace::suspension, 1e4, 0.0, 30.0, 0.0};
  const auto with = [&](const auto& change) {
    Rig other = rig;
    change(other.laws);
    return other;
  };
  EXPECT_TRUE(host_sim::alike(rig, with([](auto& laws) { laws.curves[0].value[1] = -1.0; })));
  EXPECT_TRUE(host_sim::alike(rig, with([](auto& laws) { laws.branches[0].gap = 1e-3; })));
  EXPECT_FALSE(host_sim::alike(rig, with([](auto& laws) { laws.curves[0].over = model::LawOver::deflection; })));
  EXPECT_FALSE(host_sim::alike(rig, with([](auto& laws) { laws.curves[0].place = model::LawPlace::tyre; })));
  EXPECT_FALSE(host_sim::alike(rig, with([](auto& laws) { laws.curves[0].count = 2; })));
  EXPECT_FALSE(host_sim::alike(rig, with([](auto& laws) { laws.branches[0].time_constant = 0.1; })));
  EXPECT_FALSE(host_sim::alike(rig, with([](auto& laws) { laws.branch_count = 0; })));
}

// Law. Each effect of the catalogue by itself: a law that chooses wrongly between two lanes cannot hide behind others.
TEST_P(SideBySide, EachEffectAloneKeepsItsBits) {
  Random random(7);
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    Rig some;
    std::size_t effects = 0;
    some.effects.for_each([&](const auto&) { ++effects; });
    for (std::size_t wanted = 0; wanted < effects; ++wanted) {
      Rig first = plain_rig(random, kind);
      add_effects(random, first, 1.0);
      std::size_t i = 0;
      bool exists = false;
      first.effects.for_each([&](auto& slot) {
        slot.active = slot.active && i++ == wanted;
        exists = exists || slot.active;
      });
      if (!exists) continue;
      const SimulationInput input = input_of(random, first);
      const std::vector<Rig> rigs{first, another(random, first), another(random, first), another(random, first)};
      const std::vector<InitialState> starts = starts_for(random, rigs.size());
      std::vector<SideBySideRig> all;
      for (std::size_t r = 0; r < rigs.size(); ++r) all.push_back({&rigs[r], &starts[r], &input});
      const auto beside =
          host_sim::simulate_side_by_side(all, 0, 1, host_sim::response_channels(kind, input), GetParam());
      for (std::size_t r = 0; r < rigs.size(); ++r) {
        expect_same_bits(host_sim::simulate(rigs[r], input, starts[r]), beside[r],
                         "effect " + std::to_string(wanted) + ", rig " + std::to_string(r));
        if (HasFatalFailure()) return;
      }
    }
  }
}

// Point. Inputs that differ from rig to rig, as with several realisations of an input's noise.
TEST_P(SideBySide, EachRigMayHaveAnInputOfItsOwn) {
  Random random(3);
  Rig rig = plain_rig(random, RigKind::quarter_car);
  rig.effects.add(model::CoulombFriction<double>{20.0});
  std::vector<SimulationInput> inputs;
  SimulationInput base = input_of(random, rig);
  for (int i = 0; i < 5; ++i) {
    inputs.push_back(base);
    for (auto& m : inputs.back().motion) m.position += random.between(-1e-4, 1e-4);
  }
  const InitialState start = host_sim::resting(rig, base);
  std::vector<SideBySideRig> all;
  for (const SimulationInput& input : inputs) all.push_back({&rig, &start, &input});
  const auto beside =
      host_sim::simulate_side_by_side(all, 0, 2, host_sim::response_channels(rig.kind, base), GetParam());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    expect_same_bits(host_sim::simulate(rig, inputs[i], start, 0, 2), beside[i], "input " + std::to_string(i));
  }
}

// Point. Rigs with other parts are simulated, too, and only the wanted channels and samples are kept.
TEST_P(SideBySide, RigsThatAreNotAlikeAreSimulatedInGroups) {
  Random random(5);
  std::vector<Rig> rigs;
  for (int i = 0; i < 6; ++i) {
    rigs.push_back(plain_rig(random, RigKind::quarter_car));
    rigs.back().has_fdva = false;
    rigs.back().fdva = {};
    rigs.back().suspension.damping = 1000.0 + i;
    if (i % 2 == 1) rigs.back().effects.add(model::BumpStop<double>{5e-3, 1e5});
  }
  EXPECT_TRUE(host_sim::alike(rigs[0], rigs[2]));
  EXPECT_FALSE(host_sim::alike(rigs[0], rigs[1]));
  const SimulationInput input = input_of(random, rigs[0]);
  const auto starts = starts_for(random, rigs.size());
  std::vector<SideBySideRig> all;
  for (std::size_t i = 0; i < rigs.size(); ++i) all.push_back({&rigs[i], &starts[i], &input});
  const std::vector<Channel> channels{Channel::zdd_b, Channel::dz_b};
  const auto beside = host_sim::simulate_side_by_side(all, 123, 1, channels, GetParam());
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    expect_same_bits(host_sim::simulate(rigs[i], input, starts[i], 123, 1, channels), beside[i], std::to_string(i));
    EXPECT_EQ(beside[i][index(Channel::zdd_b)].size(), 123U);
    EXPECT_TRUE(beside[i][index(Channel::F_w)].empty());
  }
}

std::string name_of(const testing::TestParamInfo<LaneUse>& info) {
  constexpr std::array<const char*, 4> names{"Automatic", "One", "Four", "Eight"};
  return names.at(static_cast<std::size_t>(info.param));
}
INSTANTIATE_TEST_SUITE_P(Lanes, SideBySide,
                         testing::Values(LaneUse::automatic, LaneUse::one, LaneUse::four, LaneUse::eight), name_of);

}  // namespace
}  // namespace side_by_side_test
