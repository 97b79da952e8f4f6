// Faults of the recorder are named as what they are: one cause, not several effects of sensors. The rigs come from
// tests/truth, which shares no code with the model.
#include "host_sim/identification/select/fault_candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/prepare/prepare.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "host_sim/identification/select/fault_rewrites.hpp"
#include "host_sim/identification/select/model_fitter.hpp"
#include "tests/host_sim/identification/faulty_recording.hpp"
#include "tests/support/report_page.hpp"

namespace {

using host_sim::identification::Diagnosis;
using host_sim::identification::RecordingFault;
using host_sim::identification::Verdict;
using model::Channel;
using sample::Columns;

const RecordingFault* fault_of(const Diagnosis& found, const std::string& name) {
  const auto at = std::find_if(found.recording_faults.begin(), found.recording_faults.end(),
                               [&](const RecordingFault& fault) { return fault.name == name; });
  return at != found.recording_faults.end() ? &*at : nullptr;
}

/// Within twice its own interval.
void expect_near(const host_sim::identification::Interval& found, double truth) {
  EXPECT_NEAR(found.value, truth, 1.0 * (found.upper - found.lower));
}

std::vector<Channel> sorted(std::vector<Channel> channels) {
  std::sort(channels.begin(), channels.end());
  return channels;
}

// Three channels late by 2.3 ms and slow by 66 ppm, beside an effect of the rig.
TEST(RecordingFaults, ASecondClockIsOneCauseBesideAnEffect) {
  const truth::Truth truth = sample::quarter_car(3, "single:quarter_car:body_guide_damping");
  const Diagnosis found = sample::diagnosis_of(truth, [](Columns& columns) {
    sample::put_on_clock(columns, {"zdd_w", "zdd_b", "dz_b"}, 2.3e-3, 66e-6);
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_FALSE(found.unexplained) << said;
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "body_guide_damping");
  const RecordingFault* const offset = fault_of(found, "clock_offset");
  const RecordingFault* const drift = fault_of(found, "clock_drift");
  ASSERT_TRUE(offset != nullptr && drift != nullptr) << said;
  EXPECT_EQ(sorted(offset->channels), sorted({Channel::zdd_w, Channel::zdd_b, Channel::dz_b})) << said;
  EXPECT_EQ(drift->channels, offset->channels);
  expect_near(offset->parameters.at("seconds"), 2.3e-3);
  expect_near(drift->parameters.at("ppm"), 66.0);
  EXPECT_GT(offset->confidence, 0.9);

  const auto json = host_sim::identification::to_json(found);
  ASSERT_EQ(json["recording"].size(), 2U);
  EXPECT_EQ(json["recording"][0]["name"], "clock_offset");
  EXPECT_EQ(json["recording"][0]["channels"].size(), 3U);
  EXPECT_EQ(json["recording"][1]["parameters"]["ppm"]["ci95"].size(), 2U);
  const std::string page =
      host_sim::identification::report_html(found, firmware::parse_rig(truth::rig_toml(truth), "rig.toml"));
  EXPECT_NE(page.find("clock_drift of"), std::string::npos);
}

// The input's own clock: everything else seems to be off, and the smaller group is named.
TEST(RecordingFaults, TheInputsClockIsTheOneThatIsOff) {
  const Diagnosis found = sample::diagnosis_of(sample::quarter_car(4), [](Columns& columns) {
    sample::put_on_clock(columns, {"z_r", "zdd_r"}, 1.5e-3, 0.0);
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  const RecordingFault* const offset = fault_of(found, "clock_offset");
  ASSERT_NE(offset, nullptr) << said;
  EXPECT_EQ(sorted(offset->channels), sorted({Channel::z_r, Channel::zdd_r})) << said;
  expect_near(offset->parameters.at("seconds"), 1.5e-3);
}

// 50 ppm in one channel: no effect of a sensor grows with time.
TEST(RecordingFaults, OneChannelWhoseClockDrifts) {
  const Diagnosis found = sample::diagnosis_of(
      sample::quarter_car(5), [](Columns& columns) { sample::put_on_clock(columns, {"F_w"}, 0.0, 50e-6); });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  const RecordingFault* const drift = fault_of(found, "clock_drift");
  ASSERT_NE(drift, nullptr) << said;
  EXPECT_EQ(drift->channels, std::vector<Channel>{Channel::F_w});
  expect_near(drift->parameters.at("ppm"), 50.0);
}

// One filter of 150 Hz on the accelerometers of wheel and body is no lag of two sensors.
TEST(RecordingFaults, ACommonFilterIsOneCause) {
  const Diagnosis found = sample::diagnosis_of(sample::quarter_car(6), [](Columns& columns) {
    sample::put_through_filter(columns, {"zdd_w", "zdd_b"}, 150.0);
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  const RecordingFault* const filter = fault_of(found, "common_filter");
  ASSERT_NE(filter, nullptr) << said;
  EXPECT_EQ(sorted(filter->channels), sorted({Channel::zdd_w, Channel::zdd_b})) << said;
  expect_near(filter->parameters.at("corner_hz"), 150.0);
  EXPECT_EQ(filter->parameters.at("order").value, 2.0);
}

// The same with the accelerometer of the foot point, which drives the simulation together with z_r.
TEST(RecordingFaults, ACommonFilterOfAllAccelerometers) {
  const Diagnosis found = sample::diagnosis_of(sample::quarter_car(6), [](Columns& columns) {
    sample::put_through_filter(columns, {"zdd_r", "zdd_w", "zdd_b"}, 150.0);
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  const RecordingFault* const filter = fault_of(found, "common_filter");
  ASSERT_NE(filter, nullptr) << said;
  EXPECT_EQ(sorted(filter->channels), sorted({Channel::zdd_r, Channel::zdd_w, Channel::zdd_b})) << said;
  expect_near(filter->parameters.at("corner_hz"), 150.0);
}

/// A car whose recording was changed, as what models are fitted to.
struct ChangedCar {
  template <class Change>
  explicit ChangedCar(const Change& change, std::vector<std::string> missing = {}) {
    using namespace host_sim::identification;
    truth::Truth truth = sample::quarter_car(6);
    truth.rough.missing = std::move(missing);
    const auto description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
    PreparedData data = prepare(description, {{sample::changed_recording(truth, change), Use::shared}});
    given = described_hypothesis(description, data.recordings);
    problem.emplace(std::move(data.recordings), given);
    fitter.emplace(*problem, search_space(description, problem->samples(), given).common, criterion);
  }

  host_sim::identification::Hypothesis given;
  std::optional<host_sim::identification::IdentificationProblem> problem;
  host_sim::identification::SelectionCriterion criterion;
  std::optional<host_sim::identification::ModelFitter> fitter;
};

/// A filter of second order, its corner [Hz] to be fitted.
host_sim::identification::PlacedFault filter_of(std::vector<Channel> channels, double corner) {
  host_sim::identification::PlacedFault filter;
  filter.kind = host_sim::identification::FaultKind::common_filter;
  filter.channels = std::move(channels);
  filter.order = 2;
  filter.values = {corner};
  filter.fitted = {true};
  return filter;
}

// The filter of zdd_w found first and zdd_b called late: zdd_b joins the filter. A channel that is late by twice what
// the filter makes of it does not.
TEST(RecordingFaults, ADelayThatIsTheFiltersJoinsIt) {
  using namespace host_sim::identification;
  for (const bool shared : {true, false}) {
    const ChangedCar car([shared](Columns& columns) {
      sample::put_through_filter(columns, {"zdd_w"}, 150.0);
      if (shared) sample::put_through_filter(columns, {"zdd_b"}, 150.0);
      if (!shared) sample::put_on_clock(columns, {"zdd_b"}, 3e-3, 0.0);
    });
    Hypothesis start = car.given;
    start.faults = {filter_of({Channel::zdd_w}, 160.0)};
    const firmware::PlacedEffect late{firmware::find_effect("sensor_delay"), Channel::zdd_b, {shared ? 1.5e-3 : 3e-3}};
    firmware::put_effect(start.rig, late);
    const CandidateModel split = car.fitter->refitted(start, {late});
    const auto joined = in_group(*car.fitter, split, 0);
    ASSERT_EQ(joined.has_value(), shared);
    if (!joined) continue;
    EXPECT_TRUE(joined->effects.empty());
    ASSERT_EQ(joined->faults().size(), 1U);
    EXPECT_EQ(sorted(joined->faults()[0].channels), sorted({Channel::zdd_w, Channel::zdd_b}));
    EXPECT_NEAR(joined->faults()[0].values[0], 150.0, 12.0) << "eight per cent";
  }
}

// Two channels are late, each of which was called a delay of its sensor: they are one late clock where they are late by
// the same, also where one of them drives the rig, so that all others are early; else two delays.
TEST(RecordingFaults, DelaysThatAreAlikeAreOneClock) {
  using namespace host_sim::identification;
  for (const auto& [first, other_late] : {std::pair{"zdd_w", 3e-3}, {"zdd_w", 1.5e-3}, {"z_r", 3e-3}}) {
    const Channel channel = *model::find_channel(first);
    const auto put_late = [name = std::string(first), other = other_late](Columns& columns) {
      sample::put_on_clock(columns, {name}, 3e-3, 0.0);
      sample::put_on_clock(columns, {"dz_b"}, other, 0.0);
    };
    const bool drives = channel == Channel::z_r;
    const ChangedCar car(put_late, drives ? std::vector<std::string>{"zdd_r"} : std::vector<std::string>{});
    Hypothesis start = car.given;
    const std::vector<firmware::PlacedEffect> late{
        {firmware::find_effect("sensor_delay"), channel, {3e-3}},
        {firmware::find_effect("sensor_delay"), Channel::dz_b, {other_late}}};
    for (const auto& effect : late) firmware::put_effect(start.rig, effect);
    const CandidateModel split = car.fitter->refitted(start, late);
    const auto one = in_one_fault(*car.fitter, split, 0);
    ASSERT_EQ(one.has_value(), other_late == 3e-3);
    EXPECT_FALSE(in_one_fault(*car.fitter, split, 1)) << "the first of them";
    if (!one) continue;
    EXPECT_TRUE(one->effects.empty());
    ASSERT_EQ(one->faults().size(), 1U);
    const PlacedFault& clock = one->faults()[0];
    EXPECT_EQ(clock.kind, FaultKind::clock);
    EXPECT_TRUE(clock.acts_on(Channel::dz_b) != drives);
    EXPECT_EQ(clock.channels.size(), drives ? 4U : 2U);
    EXPECT_NEAR(clock.values[0], drives ? -3e-3 : 3e-3, 5e-5);
  }
}

// A filter of two channels found with a corner that is too high, and the rest of its delay as a clock of both: the
// clock goes, the corner comes down. At 0 Hz the delay of a second order is √2/(2π corner), so 1.0 ms of 2.6 ms are the
// clock's.
TEST(RecordingFaults, AClockOfAFiltersOwnChannelsIsItsCorner) {
  using namespace host_sim::identification;
  const ChangedCar car([](Columns& columns) { sample::put_through_filter(columns, {"zdd_w", "zdd_b"}, 87.0); });
  const PlacedFault filter = filter_of({Channel::zdd_w, Channel::zdd_b}, 140.0);
  PlacedFault clock;
  clock.kind = FaultKind::clock;
  clock.channels = filter.channels;
  clock.values = {1.0e-3, 0.0};
  clock.fitted = {true, false};
  Hypothesis start = car.given;
  start.faults = {filter, clock};
  const CandidateModel split = car.fitter->refitted(start, {}, 0);
  EXPECT_FALSE(in_filter(*car.fitter, split, 0)) << "a filter is no clock";
  const auto whole = in_filter(*car.fitter, split, 1);
  ASSERT_TRUE(whole);
  ASSERT_EQ(whole->faults().size(), 1U);
  EXPECT_EQ(whole->faults()[0].kind, FaultKind::common_filter);
  EXPECT_NEAR(whole->faults()[0].values[0], 87.0, 2.0);
}

// The road's sensors and two more are behind one filter, with their noise, whose level and colour nobody declares: the
// others seem to be early, and the noise says why.
TEST(RecordingFaults, AFilterOfTheInputIsSeenInTheNoise) {
  truth::Truth truth = sample::quarter_car(6);
  truth.rough.noise_absent = true;
  const std::vector<std::string> channels{"z_r", "zdd_r", "zdd_b", "F_w"};
  for (const std::string& channel : channels) {
    truth.rough.recorder[channel].corner = 180.0;
    truth.rough.recorder[channel].order = 1;
  }
  const Diagnosis found = host_sim::identification::diagnose(
      firmware::parse_rig(truth::rig_toml(truth), "rig.toml"),
      {{firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv"),
        host_sim::identification::Use::shared}});
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_TRUE(found.effects.empty()) << said;
  EXPECT_TRUE(found.parameters_off.empty()) << said;
  EXPECT_EQ(fault_of(found, "clock_offset"), nullptr) << said;
  const RecordingFault* const filter = fault_of(found, "common_filter");
  ASSERT_NE(filter, nullptr) << said;
  EXPECT_EQ(sorted(filter->channels), sorted({Channel::z_r, Channel::zdd_r, Channel::zdd_b, Channel::F_w})) << said;
  EXPECT_NEAR(filter->parameters.at("corner_hz").value, 180.0, 9.0);
  EXPECT_GT(filter->confidence, 0.9);
}

/// Hum of one channel, in units of its noise.
struct Hum {
  const char* channel;
  double size, phase;
};

/// Of 50.1 Hz in these channels, these and no others are named, with their amplitudes.
void expect_hums_named(const truth::Truth& truth, const std::vector<Hum>& hums) {
  const Diagnosis found = sample::diagnosis_of(truth, [&](Columns& columns) {
    for (const Hum& hum : hums) {
      std::vector<double>& samples = columns.at(hum.channel);
      for (std::size_t k = 0; k < samples.size(); ++k) {
        const double angle = 2.0 * std::numbers::pi * 50.1 * 1e-3 * static_cast<double>(k) + hum.phase;
        samples[k] += hum.size * truth.noise.at(hum.channel) * std::cos(angle);
      }
    }
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  std::map<Channel, host_sim::identification::Interval> named;
  for (const RecordingFault& fault : found.recording_faults) {
    if (fault.name != "mains_hum") continue;
    named[fault.channels.front()] = fault.parameters.at("amplitude");
    expect_near(fault.parameters.at("hz"), 50.1);
  }
  EXPECT_EQ(named.size(), hums.size()) << said;
  for (const Hum& hum : hums) {
    const auto at = named.find(*model::find_channel(hum.channel));
    if (at == named.end()) {
      ADD_FAILURE() << hum.channel << " is not named: " << said;
    } else {
      expect_near(at->second, hum.size * truth.noise.at(hum.channel));
    }
  }
}

// Hum in two channels, below and above their noise.
TEST(RecordingFaults, MainsHumIsNamedByChannel) {
  expect_hums_named(sample::quarter_car(7), {{"F_w", 2.0, -0.5}, {"zdd_b", 0.5, 0.7}});
}

// z_r drives the simulation: its hum stands in every channel, one of which hums itself.
TEST(RecordingFaults, HumOfTheInputIsNotThatOfTheChannels) {
  expect_hums_named(sample::quarter_car(7), {{"z_r", 30.0, 0.4}, {"zdd_b", 2.0, 2.1}});
}

// z_r and zdd_r drive it together.
TEST(RecordingFaults, HumOfTheRoadsAccelerationIsItsOwn) {
  expect_hums_named(sample::quarter_car(7), {{"zdd_r", 3.0, 0.4}});
}

// Beside a loud accelerometer z_r counts as much at 50 Hz, and its hum is too small for the two to disagree.
TEST(RecordingFaults, HumOfTheRoadIsItsOwnBesideALoudAccelerometer) {
  truth::Truth truth = sample::quarter_car(7);
  truth.noise.at("zdd_r") *= 40.0;
  expect_hums_named(truth, {{"z_r", 0.25, 0.4}});
}

/// The readings of a quarter car whose damping changes: `change` of the share of the recording.
Columns with_damping(const truth::Truth& truth, Columns columns, const std::function<double(double)>& change) {
  const firmware::RigDescription description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  firmware::Recording recording;
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(columns.at("z_r").size(), 1000.0);
  recording[Channel::z_r] = columns.at("z_r");
  const host_sim::SimulationInput input = host_sim::simulation_input(description.rig, recording);
  host_sim::RigVariation variation;
  variation.every = 1;
  variation.at = [&](std::size_t k) {
    auto rig = description.rig;
    rig.suspension.damping *= 1.0 + change(static_cast<double>(k) / static_cast<double>(input.size()));
    return rig;
  };
  const auto response =
      host_sim::simulate(description.rig, input, host_sim::resting(description.rig, input), 0, 1, variation);
  for (const Channel channel : host_sim::response_channels(description.rig.kind, input)) {
    const auto column = columns.find(std::string(model::name(channel)));
    if (column != columns.end()) column->second = response[index(channel)];
  }
  return columns;
}

// Damping that fades by 15 %, in the model's own simulation: tests/truth has no parameter that changes.
TEST(RecordingFaults, DampingThatFadesIsADrift) {
  const truth::Truth truth = sample::quarter_car(10);
  const Diagnosis found = sample::diagnosis_of(truth, [&](Columns& columns) {
    columns = with_damping(truth, columns, [](double share) { return -0.15 * share; });
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  EXPECT_TRUE(found.effects.empty()) << said;
  const RecordingFault* const drift = fault_of(found, "drift");
  ASSERT_NE(drift, nullptr) << said;
  EXPECT_EQ(drift->path, "suspension.damping");
  expect_near(drift->parameters.at("per_cent_over_record"), -15.0);
}

// Damping that goes down, up and down again is no drift, though a drift explains a part of it: what it does is said to
// be unexplained.
TEST(RecordingFaults, DampingThatGoesUpAndDownIsNoDrift) {
  const truth::Truth truth = sample::quarter_car(10);
  const Diagnosis found = sample::diagnosis_of(truth, [&](Columns& columns) {
    columns = with_damping(truth, columns, [](double share) {
      return 0.15 * std::cos(2.0 * std::numbers::pi * 2.0 * share) - 0.05 * share;
    });
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(fault_of(found, "drift"), nullptr) << said;
  EXPECT_EQ(fault_of(found, "event"), nullptr) << said;
  EXPECT_TRUE(found.unexplained) << said;
}

// A push of 0.4 s on the force of a bench.
TEST(RecordingFaults, APushIsAnEvent) {
  truth::Wanted wanted;
  wanted.duration = 16.0;
  truth::Truth truth = truth::draw("single:component_bench:quadratic_damping", 11, wanted);
  truth.records.resize(1);
  const double size = 20.0 * truth.noise.at("F"), begin = truth.records[0].start;
  const Diagnosis found = sample::diagnosis_of(truth, [&](Columns& columns) {
    for (std::size_t k = 6200; k < 6600; ++k) columns.at("F")[k] += size;
  });
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects[0].effect.entry->name, "quadratic_damping");
  const RecordingFault* const event = fault_of(found, "event");
  ASSERT_NE(event, nullptr) << said;
  EXPECT_NEAR(event->parameters.at("from_s").value, begin + 6.2, 0.05);
  EXPECT_NEAR(event->parameters.at("to_s").value, begin + 6.6, 0.05);
}

// Nothing wrong: no fault is named.
TEST(RecordingFaults, ACleanRecordingHasNone) {
  for (const std::uint64_t seed : {8U, 9U}) {
    const Diagnosis found = sample::diagnosis_of(sample::quarter_car(seed), [](Columns&) {});
    EXPECT_EQ(found.verdict, Verdict::no_discrepancy) << host_sim::identification::sentence(found);
    EXPECT_FALSE(found.has_cause_in_recording());
  }
}

/// Diagnoses a rough recording behind one filter on these channels; the effects must be these.
void expect_behind_filter(std::uint64_t seed, std::vector<std::string> effects,
                          const std::vector<Channel>& channels = {Channel::x_act, Channel::F}) {
  const truth::Truth truth = truth::draw_rough("noise_coloured", seed);
  const truth::Recorder& recorder = truth.rough.recorder.at(std::string(model::name(channels.front())));
  const Diagnosis found = sample::diagnosis_of_all(truth);
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_EQ(found.verdict, Verdict::named) << said;
  std::vector<std::string> names;
  for (const auto& named : found.effects) names.emplace_back(named.effect.entry->name);
  std::sort(names.begin(), names.end());
  std::sort(effects.begin(), effects.end());
  EXPECT_EQ(names, effects) << said;
  const RecordingFault* const filter = fault_of(found, "common_filter");
  ASSERT_NE(filter, nullptr) << said;
  EXPECT_EQ(sorted(filter->channels), sorted(channels)) << said;
  EXPECT_NEAR(filter->parameters.at("corner_hz").value / recorder.corner, 1.0, 0.02) << said;
  EXPECT_EQ(filter->parameters.at("order").value, recorder.order) << said;
}

// A digital filter of first order, 340 Hz at 1 kHz: to each channel alone it is a lag or a delay of 0.27 ms, which the
// search has found before it knows the rig. The noise says that it is one filter.
TEST(RecordingFaults, AFilterTakesThePlaceOfWhatImitatesIt) {
  expect_behind_filter(203, {"quadratic_damping", "top_mount"});
}

// A saturated stroke behind a filter: its tops are round, and no value comes again.
TEST(RecordingFaults, ASaturationIsSeenBehindAFilter) { expect_behind_filter(2026120303, {"sensor_saturation"}); }

// A force whose tops are still where its noise is not: the sensor cuts it off, it is no component that yields.
TEST(RecordingFaults, ASaturatedForceIsSeenBehindAFilter) {
  expect_behind_filter(2026121306, {"sensor_offset", "sensor_saturation"});
}

// The input and one channel are behind a filter of first order, all others are not, and one of these is cut off behind
// where the input's filter is undone. The noise of the input says second order, so each of the two is called a lag
// first: lags that are alike are one filter.
TEST(RecordingFaults, AFilterOfTheInputStandsBeforeALimit) {
  expect_behind_filter(2026121305, {"sensor_saturation"}, {Channel::z_r, Channel::F_w});
}

/// Diagnoses a rough recording, of which nothing but these effects may be named.
void expect_only(const std::string& condition, std::uint64_t seed, std::vector<std::string> effects) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough(condition, seed));
  const std::string said = host_sim::identification::sentence(found);
  std::vector<std::string> names;
  for (const auto& named : found.effects) names.emplace_back(named.effect.entry->name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, effects) << said;
  EXPECT_FALSE(found.has_cause_in_recording()) << said;
  EXPECT_FALSE(found.unexplained) << said;
}

// Free play that is crossed in three samples makes pulses of F, which are no outliers, and a clock that drifts is late
// as well: no sensor beside it.
TEST(RecordingFaults, AClockHasADelayOfItsOwn) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("daq", 2026121308));
  const std::string said = host_sim::identification::sentence(found);
  ASSERT_EQ(found.effects.size(), 1U) << said;
  EXPECT_EQ(found.effects.front().effect.entry->name, "backlash") << said;
  const RecordingFault* const offset = fault_of(found, "clock_offset");
  ASSERT_NE(offset, nullptr) << said;
  ASSERT_NE(fault_of(found, "clock_drift"), nullptr) << said;
  EXPECT_NEAR(offset->parameters.at("seconds").value, 2.89e-3, 0.1e-3) << "twice its interval: " << said;
}

// The clock of a hold was set before all else was found; a clock of its channel made up for that.
TEST(RecordingFaults, AHoldIsNoLateClock) {
  expect_only("few_sensors", 2026121408, {"sensor_hold", "viscous_damping"});
}

// Two lags of 3.4 and 3.9 ms were a filter of both channels with a clock of one.
TEST(RecordingFaults, ALagOfEachIsNoFilter) { expect_only("rates", 2026121507, {"sensor_lag", "sensor_lag"}); }

// Late by 5.7 ms beside friction: in another minimum a clock of F_w with a drift of -0.5 +- 1.6 ppm was a little
// better.
TEST(RecordingFaults, ALateSensorIsNoClock) {
  expect_only("noise_absent", 2026121201, {"coulomb_friction", "sensor_delay"});
}

// The sweep crosses the wheel's resonance at its end, which is held out: what the dampings of the ducts leave there was
// taken for five events, and the lag beside them for a delay.
TEST(RecordingFaults, WhatOnlyTheEndExcitesIsNoEvent) {
  expect_only("sweeps", 2026122203, {"body_guide_damping", "sensor_lag"});
}

// zdd_b is rounded to 3.5 standard deviations of its declared noise and a third of its motion: where it stays on a
// step, neighbouring samples show less noise than rounding makes below 90 Hz.
TEST(RecordingFaults, ACoarseStepLeavesNoRest) {
  const Diagnosis found = sample::diagnosis_of_all(truth::draw_rough("daq", 2026122300));
  const std::string said = host_sim::identification::sentence(found);
  EXPECT_TRUE(found.effects.empty()) << said;
  EXPECT_FALSE(found.unexplained) << said;
  EXPECT_NE(fault_of(found, "quantisation"), nullptr) << said;
}

}  // namespace
