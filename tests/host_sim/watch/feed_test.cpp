#include "host_sim/watch/feed.hpp"

#include <gtest/gtest.h>

#include <string>

namespace {

using host_sim::watch::Feed;
using host_sim::watch::Link;
using nlohmann::json;

std::string datagram(int k, const std::string& state = "running", const std::string& more = "") {
  return R"({"timestamp":)" + std::to_string(100.0 + 0.001 * k) + R"(,"sequence":)" + std::to_string(k) +
         R"(,"lost":0,"F":)" + std::to_string(k) + R"(,"state":")" + state +
         R"(","reason_name":"none","second_reason":"none")" + more + "}";
}

const std::string with_setup = R"(,"setup":{"rig":"r.toml","sample_rate":1000,"every":1,"units":{"F":"N","age":"s"}})";

struct Fed : testing::Test {
  Feed feed;
  double now = 0.0;
  void take(const std::string& text, const std::string& source = "127.0.0.1:5") { feed.take(text, source, now, 0); }
};

TEST_F(Fed, SaysHowItStandsToThePublisher) {
  EXPECT_EQ(feed.link(now), Link::waiting);
  take(datagram(0));
  EXPECT_EQ(feed.link(now), Link::live);
  EXPECT_EQ(feed.link(now + 0.9), Link::live);
  EXPECT_EQ(feed.link(now + 1.1), Link::gone);
  now = 5.0;
  take(datagram(1));
  EXPECT_EQ(feed.link(now), Link::live) << "it is back";
  take(R"({"timestamp":100.1,"sequence":2,"lost":0,"ended":"reference_ended"})");
  EXPECT_EQ(feed.link(now + 100.0), Link::ended) << "that is no loss";
  Feed::Cursor cursor;
  const json frame = feed.frame(cursor, now);
  EXPECT_EQ(frame["ended"], "reference_ended");
  EXPECT_EQ(frame["values"]["F"], 1.0) << "the last values stay";
}

// Two programs publish to one port: one is shown, the other is named, with its rig as soon as it says it. Without that
// a page showed one rig above the buttons of another.
TEST_F(Fed, NamesASecondPublisher) {
  take(datagram(0, "running", R"(,"instance":"aa.1@here")"));
  EXPECT_EQ(feed.instance(), "aa.1@here");
  take(datagram(0, "running", R"(,"instance":"bb.2@here")" + with_setup), "127.0.0.1:6");
  Feed::Cursor cursor;
  json frame = feed.frame(cursor, now);
  EXPECT_EQ(frame["instance"], "aa.1@here");
  EXPECT_EQ(frame["foreign"]["instance"], "bb.2@here");
  EXPECT_EQ(frame["foreign"]["rig"], "r.toml");
  EXPECT_EQ(frame["foreign"]["source"], "127.0.0.1:6");
  EXPECT_TRUE(frame["setup"].is_null()) << "the setup of the one that is not shown";
  now = 0.9;
  take(datagram(1, "running", R"(,"instance":"aa.1@here")"));
  now = 3.1;
  EXPECT_FALSE(feed.frame(cursor, now).contains("foreign")) << "it has gone";
  take(datagram(2, "running", R"(,"instance":"a b")"));
  EXPECT_EQ(feed.instance(), "aa.1@here") << "an instance is one word: it goes into requests";
}

// One period of a thousand at 100 Hz comes each 10 s: silence between two is no loss.
TEST_F(Fed, IsAsPatientAsTheDecimationIsWide) {
  take(datagram(0, "idle", R"(,"setup":{"sample_rate":100,"every":1000})"));
  EXPECT_EQ(feed.link(49.0), Link::live);
  EXPECT_EQ(feed.link(51.0), Link::gone);
}

TEST_F(Fed, GivesHistoryOnceAndThenWhatIsNew) {
  take(datagram(0, "running", with_setup));
  for (int k = 1; k < 50; ++k) take(datagram(k));
  Feed::Cursor cursor;
  const json first = feed.frame(cursor, now);
  EXPECT_TRUE(first["traces"]["reset"].get<bool>());
  EXPECT_EQ(first["traces"]["i"].size(), 9U);
  EXPECT_EQ(first["traces"]["high"].size(), 1U) << "ages are no traces";
  EXPECT_EQ(first["setup"]["rig"], "r.toml");
  EXPECT_EQ(first["events"].size(), 1U);
  EXPECT_FALSE(feed.has_news(cursor));
  for (int k = 50; k < 61; ++k) take(datagram(k));
  EXPECT_TRUE(feed.has_news(cursor));
  const json second = feed.frame(cursor, now);
  EXPECT_FALSE(second["traces"]["reset"].get<bool>());
  EXPECT_EQ(second["traces"]["i"].size() + first["traces"]["i"].size(), 12U) << "no interval twice, none left out";
  EXPECT_EQ(second["traces"]["i"][0].get<int>(), first["traces"]["i"].back().get<int>() + 1);
  EXPECT_FALSE(second.contains("setup"));
  EXPECT_FALSE(second.contains("events"));
  EXPECT_EQ(second["values"]["F"], 60.0);
}

TEST_F(Fed, CountsWhatIsLostAndWhatIsNotUnderstood) {
  take(datagram(0));
  take(datagram(1));
  take(datagram(7));
  take("nonsense");
  Feed::Cursor cursor;
  const json counts = feed.frame(cursor, now)["counts"];
  EXPECT_EQ(counts["received"], 3);
  EXPECT_EQ(counts["lost_on_the_way"], 5);
  EXPECT_EQ(counts["malformed"], 1);
}

// Two controllers on one port must not be shown as one rig.
TEST_F(Fed, FollowsOnePublisherAtATime) {
  take(datagram(5, "running", with_setup));
  take(datagram(900, "safe"), "127.0.0.1:6");
  Feed::Cursor cursor;
  json frame = feed.frame(cursor, now);
  EXPECT_EQ(frame["state"], "running");
  EXPECT_EQ(frame["counts"]["foreign"], 1);
  now = 3.0;  // the first one is gone
  take(datagram(901, "safe"), "127.0.0.1:6");
  frame = feed.frame(cursor, now);
  EXPECT_EQ(frame["state"], "safe");
  EXPECT_TRUE(frame["traces"]["reset"].get<bool>());
  EXPECT_EQ(frame["traces"]["i"].size(), 0U) << "nothing of the other rig is left";
  EXPECT_EQ(frame["counts"]["lost_on_the_way"], 0);
}

TEST_F(Fed, ListsChangesOfStateWithTheirReason) {
  take(datagram(0, "running"));
  take(datagram(1, "running", R"(,"trip":"energy 0.31, limit 0.3")"));  // the period that trips belongs to the run
  take(datagram(2, "safe", R"(,"trip":"energy 0.31, limit 0.3")"));
  take(datagram(3, "idle", R"(,"trip":"energy 0.31, limit 0.3")"));
  Feed::Cursor cursor;
  const json events = feed.frame(cursor, now)["events"];
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1]["state"], "safe");
  EXPECT_EQ(events[1]["text"], "energy 0.31, limit 0.3");
  EXPECT_EQ(events[2]["text"], "");
  for (int k = 4; k < 400; ++k) take(datagram(k, k % 2 == 0 ? "running" : "holding"));
  EXPECT_EQ(feed.frame(cursor, now)["events"].size(), Feed::most_events);
}

}  // namespace
