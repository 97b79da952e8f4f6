// The way from datagrams to a diagnosis: samples, controllers of other rigs, what a feed is told, and a stop.
#include "host_sim/live/live_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/description/model_watch.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/live/changing_rig.hpp"

namespace {

using namespace host_sim;
using model::Channel;
using nlohmann::json;

watch::Datagram datagram(double late) {
  watch::Datagram d;
  d.timestamp = 12.5;
  d.values = {{"F", 3.0}, {"duct_2", 1.0}, {"late", late}, {"nonsense", 4.0}};
  return d;
}

TEST(LiveSample, HoldsChannelsAndDucts) {
  const live::LiveSample sample = live::sample_of(datagram(1e-5), 1e-3);
  EXPECT_EQ(sample.time, 12.5);
  EXPECT_EQ(sample.values[index(Channel::F)], 3.0);
  EXPECT_TRUE(std::isnan(sample.values[index(Channel::x_act)]));
  EXPECT_EQ(sample.ducts[1], 1.0);
  EXPECT_TRUE(std::isnan(sample.ducts[0]));
}

// A period that was late read its samples at another instant than it says.
TEST(LiveSample, IsNoneOfALatePeriod) {
  EXPECT_TRUE(std::isnan(live::sample_of(datagram(3e-4), 1e-3).values[index(Channel::F)]));
}

TEST(SetupObjection, FindsTheControllerOfAnotherRig) {
  const firmware::RigDescription rig = sample::hil();
  EXPECT_FALSE(live::setup_objection(json{{"kind", "hil"}, {"sample_rate", 1000}, {"every", 1}}, rig));
  EXPECT_FALSE(live::setup_objection(json(), rig)) << "most datagrams have none";
  for (const json& other : {json{{"kind", "quarter_car"}}, json{{"kind", "hil"}, {"sample_rate", 2000}},
                            json{{"kind", "hil"}, {"every", 10}}}) {
    EXPECT_TRUE(live::setup_objection(other, rig)) << other;
  }
}

std::string text_of(const live::LiveSample& sample, int k) {
  json d{{"timestamp", 100.0 + sample.time}, {"sequence", k},      {"lost", 0},
         {"instance", "aa.1@here"},          {"state", "running"}, {"reason_name", "none"},
         {"second_reason", "none"}};
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (std::isfinite(sample.values[c])) d[std::string(model::name(model::channel_at(c)))] = sample.values[c];
  }
  return d.dump();
}

/// A bench whose load cell gains 10 % after 30 s, as datagrams into a feed.
live::LiveWatch::State watched(const firmware::RigDescription& rig, watch::Feed& feed, const std::string& setup = "") {
  live::LiveWatch diagnosis(rig, "/nonexistent/control.sock", feed, [](const std::string&) {});
  sample::Run run;
  run.duration = 36.0;
  run.changes_at = 30.0;
  run.change = [](model::RigParameters<double>& r) { r.effects.add<model::SensorGain>(Channel::F, {1.1}); };
  int k = 0;
  sample::drive(rig, run, [&](const live::LiveSample& s) {
    std::string text = text_of(s, k++);
    if (!setup.empty()) text.insert(text.size() - 1, setup);
    feed.take(text, "127.0.0.1:5", s.time, 0);
  });
  diagnosis.finish();
  return diagnosis.state();
}

// Journey. What is named is in the frames of the feed, in seconds of the run; without model_watch nobody is asked for a stop.
TEST(LiveWatch, TellsTheFeed) {
  watch::Feed feed;
  const auto state = watched(sample::component_bench(), feed);
  ASSERT_EQ(state.findings.size(), 1U) << state.error;
  EXPECT_EQ(state.findings.front().cause.name, "sensor_gain");
  EXPECT_NEAR(state.findings.front().since, 30.0, 0.5);
  EXPECT_EQ(state.stop, "");
  watch::Feed::Cursor cursor;
  const json frame = feed.frame(cursor, 40.0);
  ASSERT_TRUE(frame.contains("model"));
  EXPECT_EQ(frame["model"]["findings"][0]["cause"]["channel"], "F");
  EXPECT_FALSE(feed.frame(cursor, 40.0).contains("model")) << "it was told";
}

// Fault. A stop that nobody hears is said.
TEST(LiveWatch, SaysThatAStopWasNotHeard) {
  firmware::RigDescription rig = sample::component_bench();
  rig = firmware::parse_rig(rig.text + "[controller]\nmodel_watch = \"stop\"\n", "stop.toml");
  watch::Feed feed;
  const auto state = watched(rig, feed);
  EXPECT_TRUE(state.stop.starts_with("no stop: /nonexistent/control.sock")) << state.stop;
  EXPECT_FALSE(state.stopped);
}

TEST(LiveWatch, EndsWithAnotherRig) {
  watch::Feed feed;
  const auto state = watched(sample::component_bench(), feed, R"(,"setup":{"kind":"hil","rig":"x.toml"})");
  EXPECT_NE(state.error.find("expected the description of the rig that runs"), std::string::npos) << state.error;
  EXPECT_TRUE(state.failure);
}

// The key is read, refused where it is another word, and written again.
TEST(ModelWatch, StandsInTheDescription) {
  const std::string text = sample::component_bench().text;
  EXPECT_FALSE(firmware::model_watch_stops(sample::component_bench()));
  EXPECT_FALSE(firmware::model_watch_stops(firmware::parse_rig(text + "[controller]\nmodel_watch = 'show'\n", "r")));
  const auto stops = firmware::parse_rig(text + "[controller]\npriority = 60\nmodel_watch = \"stop\" # so\n", "r");
  EXPECT_TRUE(firmware::model_watch_stops(stops));
  EXPECT_TRUE(firmware::model_watch_stops(firmware::parse_rig(firmware::format_rig(stops), "written")));
  EXPECT_THROW(static_cast<void>(firmware::parse_rig(text + "[controller]\nmodel_watch = \"trip\"\n", "r")),
               firmware::InputError);
}

}  // namespace
