#include "firmware/controller/publishing/datagram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "firmware/controller/recording/trip_text.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::Mode;
using firmware::Reason;
using firmware::Record;
using firmware::controller::DatagramWriter;
using firmware::controller::Spans;
using model::Channel;
using nlohmann::json;

struct Written : testing::Test {
  const firmware::RigDescription rig = support::rig("paper_hil_fdva");
  const std::unique_ptr<Spans> spans = std::make_unique<Spans>();
  hal::SensorSetup sensors{};
  Record record{};
  Written() {
    sensors[model::index(Channel::F)].fitted = true;
    sensors[model::index(Channel::x_act)].fitted = true;
    record.time = hal::Time{1'234'567'890'123};
    record.taken.fill(hal::never);
    record.values.fill(0.0);
  }
  [[nodiscard]] DatagramWriter writer() const { return {rig, sensors, true, 5, *spans, "a.1@here"}; }
  [[nodiscard]] json period(bool with_setup = false) const {
    return json::parse(writer().period(record, {17, 3}, with_setup));
  }
};

// PlotJuggler's form: one object, numbers by name, the time in `timestamp` – to the nanosecond, because a clock that
// has run for a month has seven digits before the point.
TEST_F(Written, IsOneObjectWithItsTimeAndNumbers) {
  record.period = 41;
  record.values[model::index(Channel::F)] = -123.456789;
  const std::string text = writer().period(record, {17, 3}, false);
  EXPECT_EQ(text.rfind("{\"timestamp\":1234.567890123,\"sequence\":17,\"period\":41,\"lost\":3,", 0), 0U) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_DOUBLE_EQ(json::parse(text)["F"].get<double>(), -123.456789);
  EXPECT_FALSE(json::parse(text).contains("setup"));
}

// What is seen live has the names of what is recorded.
TEST_F(Written, HasEveryColumnOfTheRecording) {
  record.taken[model::index(Channel::F)] = record.time - hal::Time{250'000};
  record.taken[model::index(Channel::x_act)] = record.time;
  const json object = period();
  const firmware::RunColumns recorded(rig, sensors);
  for (const auto& column : recorded.columns()) {
    ASSERT_TRUE(object.contains(column.name)) << column.name;
    EXPECT_NEAR(object[column.name].get<double>(), firmware::RunColumns::value(column, record), 1e-12) << column.name;
  }
  EXPECT_DOUBLE_EQ(object["age_F"].get<double>(), 250e-6);
}

// JSON has no NaN: a parser would refuse the whole datagram.
TEST_F(Written, LeavesOutWhatIsNoNumber) {
  record.values[model::index(Channel::F)] = std::numeric_limits<double>::quiet_NaN();
  record.values[model::index(Channel::z_w)] = -std::numeric_limits<double>::infinity();
  const json object = period();
  EXPECT_FALSE(object.contains("F"));
  EXPECT_FALSE(object.contains("z_w"));
  EXPECT_FALSE(object.contains("age_F")) << "no sample was taken";
  EXPECT_TRUE(object.contains("z_b"));
}

TEST_F(Written, SaysStateAndReasonInWordsToo) {
  record.mode = Mode::running;
  EXPECT_EQ(period()["state"], "running");
  EXPECT_EQ(period()["reason_name"], "none");
  EXPECT_FALSE(period().contains("trip"));
  record.mode = Mode::safe;
  record.trip = {.reason = Reason::force, .channel = Channel::F, .value = 26'000.0, .limit = 25'000.0};
  record.second = Reason::stop_button;
  record.energy_fed = 1.5;
  record.energy_taken = 6.0;
  const json object = period();
  EXPECT_EQ(object["trip"], "force of F (2.6e+04 N, limit 2.5e+04)");
  EXPECT_EQ(object["reason"], static_cast<int>(Reason::force));
  EXPECT_EQ(object["second_reason"], "stop_button");
  EXPECT_EQ(object["energy_fed"], 1.5);
  EXPECT_EQ(object["energy_taken"], 6.0);
}

// Point. The page shows everything that is wrong with a rig that was not armed; what a reader of datagrams does not take
// (300 bytes) is left out entry by entry.
TEST_F(Written, ListsWhatArmingFound) {
  firmware::Refusals refusals;
  refusals.add({.reason = Reason::stop_button});
  refusals.add({.reason = Reason::interlock, .interlock = 1});
  refusals.add({.reason = Reason::interlock, .interlock = 1});
  refusals.add({.reason = Reason::arming_position, .channel = Channel::x_act, .value = 0.02, .limit = 0.005});
  DatagramWriter described = writer();
  const auto written = [&] { return json::parse(described.period(record, {17, 3}, false)); };
  described.describe_refusals([&] { return firmware::controller::refusals_text(refusals, rig); });
  EXPECT_FALSE(written().contains("failed_checks")) << "not in safe: an earlier arming's";
  record.mode = Mode::safe;
  EXPECT_EQ(written()["failed_checks"],
            "stop_button (0, limit 0); interlock 2; arming_position of x_act (0.02 m, limit 0.005)");
  for (std::size_t i = 0; i < 12; ++i) {
    refusals.add({.reason = Reason::sample_missing, .channel = model::channel_at(i), .value = 0.0, .limit = 3.0});
  }
  const std::string all = written()["failed_checks"];
  EXPECT_LE(all.size(), 300U);
  EXPECT_TRUE(all.ends_with("limit 3); …")) << all;
  refusals.clear();
  EXPECT_FALSE(written().contains("failed_checks"));
}

// What is recorded, and how long the run takes, once the session knows it.
TEST_F(Written, SaysWhatIsRecorded) {
  DatagramWriter described = writer();
  EXPECT_FALSE(period(true)["setup"].contains("recording"));
  described.describe_run("RUN.csv", 60.0);
  const json setup = json::parse(described.period(record, {17, 3}, true))["setup"];
  EXPECT_EQ(setup["recording"], "RUN.csv");
  EXPECT_EQ(setup["duration"], 60.0);
}

TEST_F(Written, BringsLimitsUnitsAndHistogramsWithItsSetup) {
  for (int i = 0; i < 100; ++i) spans->step.add(i < 99 ? 1500 : 80'000);
  const json setup = period(true)["setup"];
  EXPECT_EQ(setup["rig"], "paper_hil_fdva.toml") << "no path: it is nobody's business";
  EXPECT_EQ(setup["kind"], "hil");
  EXPECT_EQ(setup["simulated"], 1);
  EXPECT_EQ(setup["sample_rate"], 1000.0);
  EXPECT_EQ(setup["every"], 5);
  EXPECT_EQ(setup["limits"]["speed"], 1.5);
  EXPECT_EQ(setup["limits"]["energy_gain"], 1.0);
  EXPECT_NEAR(setup["limits"]["sample_age"].get<double>(), 5e-3, 1e-12);
  EXPECT_EQ(setup["units"]["F"], "N");
  EXPECT_EQ(setup["units"]["zdd_b"], "m/s²");
  const json step = setup["spans_us"]["step"];
  EXPECT_EQ(step["count"], 100);
  EXPECT_EQ(step["max"], 80.0);
  double counted = 0.0, before = 0.0;
  for (const json& spans_of_class : step["classes"]) {
    EXPECT_GT(spans_of_class[0].get<double>(), before) << "in order";
    before = spans_of_class[0].get<double>();
    counted += spans_of_class[1].get<double>();
  }
  EXPECT_EQ(counted, 100.0);
  EXPECT_EQ(setup["spans_us"]["wake_up"]["classes"], json::array());
}

TEST_F(Written, SaysWhyTheSessionEnds) {
  const json object = json::parse(writer().end(hal::Time{-1'500'000'000}, {9, 0}, "a signal to \"stop\""));
  EXPECT_EQ(object, (json{{"timestamp", -1.5},
                          {"sequence", 9},
                          {"lost", 0},
                          {"instance", "a.1@here"},
                          {"ended", "a signal to \"stop\""}}));
}

}  // namespace
