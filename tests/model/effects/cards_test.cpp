// The cards of the catalogue: complete, unambiguous, and with starts inside the bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "model/rig/rig_model.hpp"

namespace {

using model::EffectCard;
using model::EffectParameter;
using model::Linearisation;
using model::Reading;
using model::Subsystem;

/// visit(card) of every effect of the catalogue, once.
template <class Visitor>
void for_each_card(const Visitor& visit) {
  const model::Effects<double> effects;
  effects.for_each([&](const auto& slot) { visit(slot.effect.card); });
  effects.for_each_sensor([&](const auto& slot, model::Channel channel) {
    if (channel == model::channel_at(0)) visit(slot.effect.card);
  });
}

constexpr EffectParameter spring{.name = "stiffness",
                                 .unit = "N/m",
                                 .lower = 0.0,
                                 .upper = 1e8,
                                 .starts = {.scale = model::scales::force, .factors = {1.0}}};

constexpr EffectCard<1> card_of(const EffectParameter& parameter) {
  return {.name = "spring",
          .subsystem = Subsystem::suspension,
          .rigs = model::every_rig,
          .parameters = {{parameter}},
          .equation = "F_s += stiffness · dz_b",
          .shows = "a force in proportion to the deflection",
          .linearisation = Linearisation::left_out};
}

// A name stands for one effect in rig descriptions, and for one parameter in its table.
TEST(EffectCards, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for_each_card([&](const auto& card) {
    EXPECT_TRUE(names.insert(card.name).second) << card.name;
    std::set<std::string_view> parameters;
    for (const EffectParameter& p : card.parameters) EXPECT_TRUE(parameters.insert(p.name).second) << card.name;
  });
  EXPECT_EQ(names.size(), 35U);
}

// An effect that contains another one names an effect of the same part, and says what they have in common.
TEST(EffectCards, SayWhatTheyContain) {
  for_each_card([&](const auto& card) {
    const bool common =
        std::any_of(card.parameters.begin(), card.parameters.end(), [](const auto& p) { return p.from_contained; });
    EXPECT_EQ(common, !card.contains.empty()) << card.name;
    if (card.contains.empty()) return;
    bool there = false;
    for_each_card([&](const auto& other) {
      if (other.name != card.contains) return;
      there = other.parameters.size() == 1 && other.subsystem == card.subsystem;
    });
    EXPECT_TRUE(there) << card.name << " contains " << card.contains;
  });
}

// A fit starts inside the bounds of its parameter: on a rig of the usual size, a car on a road of class B.
TEST(EffectCards, StartFitsInsideTheBounds) {
  const model::MotionScales car{.force = 300.0,
                                .deflection = 4e-3,
                                .deflection_peak = 14e-3,
                                .velocity = 0.08,
                                .velocity_peak = 0.3,
                                .acceleration = 5.0,
                                .tyre_force = 400.0,
                                .tyre_deflection = 2e-3,
                                .foot_acceleration = 8.0,
                                .ripple_period = 5e-3,
                                .channel = 300.0};
  for_each_card([&](const auto& card) {
    for (const EffectParameter& p : card.parameters) {
      SCOPED_TRACE(std::string(card.name) + "." + std::string(p.name));
      EXPECT_TRUE(p.lower >= 0.0 || (p.lower < p.neutral && p.neutral < p.upper));
      if (p.starts.read != Reading::nothing) continue;
      for (const double factor : p.starts.factors) {
        EXPECT_GT(factor * p.starts.scale(car), p.lower);
        EXPECT_LT(factor * p.starts.scale(car), p.upper);
      }
    }
  });
}

// A rig that stands still has scales of zero; the starts of a fit need not be useful then, but no signal may be raised.
TEST(EffectCards, BearARigThatStandsStill) {
  for_each_card([&](const auto& card) {
    for (const EffectParameter& p : card.parameters) {
      if (p.starts.read != Reading::nothing) continue;
      EXPECT_FALSE(p.starts.scale({}) > p.upper) << card.name;
    }
  });
}

// The catalogue is compiled with complete cards only. Each thing that can be forgotten is noticed.
TEST(EffectCards, SayWhatTheyLack) {
  EXPECT_EQ(find_gap(card_of(spring)), "");

  auto nameless = card_of(spring);
  nameless.name = "";
  EXPECT_EQ(find_gap(nameless), "name, equation and how it shows");

  EffectParameter p = spring;
  p.unit = "";
  EXPECT_EQ(find_gap(card_of(p)), "name and unit of a parameter");

  p = spring;
  p.upper = p.lower;
  EXPECT_EQ(find_gap(card_of(p)), "bounds of a parameter");

  p = spring;
  p.starts = {};
  EXPECT_EQ(find_gap(card_of(p)), "where the fit of a parameter starts");
  p.starts = {.scale = model::scales::force, .factors = {1.0}, .read = Reading::repeated_extreme};
  EXPECT_EQ(find_gap(card_of(p)), "where the fit of a parameter starts");

  p = spring;
  p.fitted = false;
  EXPECT_EQ(find_gap(card_of(p)), "a parameter that is neither fitted nor read");
}

/// A law whose card calls it linear: the linearised loop would not contain it.
template <class S>
struct LinearLaw {
  S stiffness{};
  static constexpr EffectCard<1> card = [] {
    EffectCard<1> linear = card_of(spring);
    linear.linearisation = Linearisation::exact;
    return linear;
  }();
  static constexpr auto values = std::array{&LinearLaw::stiffness};
  [[nodiscard]] constexpr S suspension_force(S deflection, S /*velocity*/) const { return stiffness * deflection; }
};
static_assert(!model::RigEffect<LinearLaw<double>>);

/// Parameters and a card, but nothing that acts: a misspelt function would look like this.
template <class S>
struct Idle {
  S stiffness{};
  static constexpr EffectCard<1> card = card_of(spring);
  static constexpr auto values = std::array{&Idle::stiffness};
};
static_assert(!model::RigEffect<Idle<double>>);
static_assert(!model::SensorEffect<Idle<double>>);

}  // namespace
