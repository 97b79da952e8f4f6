// Pushes and knocks from outside are events, each with its own time. The rigs come from tests/truth, which shares no
// code with the model.
#include "host_sim/identification/select/external_event.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"

namespace {

using host_sim::identification::Diagnosis;
using host_sim::identification::RecordingFault;

/// Events on the body [s], [N].
truth::Truth with_events(truth::Truth truth, const std::vector<truth::Event>& events) {
  truth.rough.events = events;
  return truth;
}

/// The events that a diagnosis names, in the order of time, are these, within what their intervals allow: a half sine
/// is quiet at its two ends, so a soft push may lose `soft` of its length there.
void expect_events(const Diagnosis& found, const std::vector<truth::Event>& events, double soft) {
  const std::string said = host_sim::identification::sentence(found);
  std::vector<RecordingFault> named;
  for (const RecordingFault& fault : found.recording_faults) {
    if (fault.name == "event") named.push_back(fault);
  }
  std::sort(named.begin(), named.end(), [](const RecordingFault& a, const RecordingFault& b) {
    return a.parameters.at("from_s").value < b.parameters.at("from_s").value;
  });
  ASSERT_EQ(named.size(), events.size()) << said;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const double edge = host_sim::identification::thresholds::event_edge + soft * (events[e].to - events[e].from);
    EXPECT_NEAR(named[e].parameters.at("from_s").value, events[e].from, edge) << said;
    EXPECT_NEAR(named[e].parameters.at("to_s").value, events[e].to, edge) << said;
    EXPECT_GT(named[e].confidence, 0.9);
  }
}

Diagnosis diagnosis_with(const truth::Truth& truth) {
  return sample::diagnosis_of(truth, [](sample::Columns&) {});
}

// A knock leaves slow motion of the body. It is too weak to show in a short stretch, and is no event of its own.
TEST(ExternalEvent, KnocksOfTheBodyAreToldFromTheMotionThatTheyLeave) {
  const std::vector<truth::Event> knocks{{"body", 5.775, 5.790, 276.0},
                                         {"body", 7.893, 7.898, -518.0},
                                         {"body", 11.410, 11.428, 636.0},
                                         {"body", 13.401, 13.407, -528.0}};
  const Diagnosis found = diagnosis_with(with_events(sample::quarter_car(5), knocks));
  EXPECT_TRUE(found.effects.empty()) << host_sim::identification::sentence(found);
  EXPECT_FALSE(found.unexplained) << host_sim::identification::sentence(found);
  expect_events(found, knocks, 0.0);
}

// Beside a strong event, what stands out in 0.25 s by noise alone is none: it must be worth its own price.
TEST(ExternalEvent, APushAddsNoSecondOne) {
  const std::vector<truth::Event> pushes{{"body", 5.0, 5.822, 110.0}};
  const Diagnosis found = diagnosis_with(with_events(sample::quarter_car(5), pushes));
  expect_events(found, pushes, 0.1);
}

// Two seconds after a push of 0.8 s the body still moves by half of the noise. That is no law: it is left out.
TEST(ExternalEvent, WhatAPushLeavesIsNoLaw) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("events", 2026123001));
  EXPECT_TRUE(found.laws.empty()) << host_sim::identification::sentence(found);
  EXPECT_FALSE(found.unexplained) << host_sim::identification::sentence(found);
  EXPECT_EQ(found.effects.size(), 2U) << host_sim::identification::sentence(found);
}

// A stretch of 0.25 s begins at 12.5 s: the knock stands at the end of the one before, where its window is nearly zero.
TEST(ExternalEvent, AKnockAtTheEndOfAStretchIsLeftOutWhole) {
  const std::vector<truth::Event> knocks{{"body", 12.478, 12.494, 700.0}};
  const Diagnosis found = diagnosis_with(with_events(sample::quarter_car(5), knocks));
  EXPECT_FALSE(found.unexplained) << host_sim::identification::sentence(found);
  expect_events(found, knocks, 0.0);
}

// The balances of the description do not hold beside a mount; those of what the found model leaves do.
TEST(ExternalEvent, APushBesideAnEffectHasItsOwnTime) {
  const std::vector<truth::Event> pushes{{"body", 5.86, 6.76, 150.0}};
  const Diagnosis found = diagnosis_with(with_events(sample::quarter_car(2, "single:quarter_car:top_mount"), pushes));
  ASSERT_EQ(found.effects.size(), 1U) << host_sim::identification::sentence(found);
  EXPECT_EQ(found.effects[0].effect.entry->name, "top_mount");
  expect_events(found, pushes, 0.1);
}

// Two records behind a filter of 205 Hz that nobody describes: what the model gets wrong of it is loudest in 2 s of the
// second, and no balance fails there.
TEST(ExternalEvent, NothingActsWhereTheBalancesHold) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("noise_coloured", 2026112701));
  for (const RecordingFault& fault : found.recording_faults) {
    EXPECT_NE(fault.name, "event") << host_sim::identification::sentence(found);
  }
}

// Damping with a power of 2.96 that nobody describes: what viscous and quadratic damping leave is loudest in four short
// stretches, where it is fastest. The law explains these, too, so nothing acted from outside.
TEST(ExternalEvent, IsNotWhatALawExplains) {
  const truth::Truth truth = truth::draw_rough("neighbour_laws", 2026120101);
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_TRUE(found.recording_faults.empty()) << said;
  EXPECT_EQ(found.verdict, host_sim::identification::Verdict::named) << said;
  ASSERT_EQ(found.laws.size(), 1U) << said;
  EXPECT_NEAR(found.laws[0].law.values.back(), truth.unknown_parameters.at("exponent"), 0.1) << said;
  // Noise alone is left on what was held out, where it is fastest.
  const auto& gap = found.prediction_errors.at(model::Channel::F);
  EXPECT_LT(gap.after, 1.1 * gap.noise_floor);
}

}  // namespace
