#include "host_sim/watch/datagram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "firmware/controller/publishing/datagram.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using host_sim::watch::Datagram;
using host_sim::watch::parse_datagram;

// Law. What the controller writes, the page's server reads.
TEST(WatchDatagram, IsReadAsTheControllerWritesIt) {
  const firmware::RigDescription rig = support::rig("paper_hil_fdva");
  const auto spans = std::make_unique<firmware::controller::Spans>();
  firmware::controller::DatagramWriter writer(rig, {}, false, 1, *spans, "a.1@here");
  writer.describe_refusals([] { return std::string("stop_button; interlock door"); });
  firmware::Record record;
  record.time = hal::milliseconds(2500);
  record.mode = firmware::Mode::safe;
  record.trip = {.reason = firmware::Reason::energy, .value = 0.31, .limit = 0.3};
  record.values[model::index(model::Channel::z_w)] = 0.0125;
  const auto read = parse_datagram(writer.period(record, {8, 2}, true));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->timestamp, 2.5);
  EXPECT_EQ(read->sequence, 8U);
  EXPECT_EQ(read->lost, 2U);
  EXPECT_EQ(read->state, "safe");
  EXPECT_EQ(read->reason, "energy");
  EXPECT_EQ(read->second_reason, "none");
  EXPECT_EQ(read->failed_checks, "stop_button; interlock door");
  EXPECT_EQ(read->trip, "energy (0.31, limit 0.3)");
  EXPECT_EQ(read->value("z_w"), 0.0125);
  EXPECT_TRUE(std::isnan(read->value("F_w_c")));
  EXPECT_EQ(read->setup["kind"], "hil");
  EXPECT_FALSE(read->ended.has_value());
  const auto end = parse_datagram(writer.end(record.time, {9, 2}, "a signal to stop"));
  ASSERT_TRUE(end.has_value());
  EXPECT_EQ(end->ended, "a signal to stop");
}

// Anybody on the machine can send a datagram.
TEST(WatchDatagram, OfAnotherFormIsNotUsed) {
  const std::string whole = R"({"timestamp":1.5,"sequence":3,"state":"idle")";
  ASSERT_TRUE(parse_datagram(whole + "}").has_value());
  for (const std::string& text : {std::string(),
                                  std::string("{"),
                                  std::string("[]"),
                                  std::string("1"),
                                  std::string("{}"),
                                  whole,
                                  std::string(R"({"timestamp":1.5,"state":"idle"})"),
                                  std::string(R"({"sequence":3,"state":"idle"})"),
                                  std::string(R"({"timestamp":1.5,"sequence":3})"),
                                  std::string(R"({"timestamp":"x","sequence":3,"state":"idle"})"),
                                  std::string(R"({"timestamp":1e999,"sequence":3,"state":"idle"})"),
                                  std::string(R"({"timestamp":1.5,"sequence":-3,"state":"idle"})"),
                                  std::string(R"({"timestamp":1.5,"sequence":3.5,"state":"idle"})"),
                                  whole + R"(,"F":null})",
                                  whole + R"(,"F":[1]})",
                                  whole + R"(,"F":true})",
                                  whole + R"(,"F":1e999})",
                                  whole + R"(,"setup":1})",
                                  whole + R"(,"trip":")" + std::string(301, 'x') + "\"}",
                                  whole + R"(,")" + std::string(41, 'k') + "\":1}",
                                  whole + R"(,"setup":{"a":)" + std::string(9, '[') + std::string(9, ']') + "}}",
                                  std::string(60'000, '[')}) {
    EXPECT_FALSE(parse_datagram(text).has_value()) << text.substr(0, 80);
  }
  std::string many = whole;
  for (int i = 0; i < 97; ++i) many += ",\"v" + std::to_string(i) + "\":1";
  EXPECT_FALSE(parse_datagram(many + "}").has_value());
}

}  // namespace
