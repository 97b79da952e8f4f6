#include "firmware/controller/publishing/publisher.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "tests/support/datagrams.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using firmware::Record;
using namespace firmware::controller;
using nlohmann::json;

struct Published : testing::Test {
  const firmware::RigDescription rig = support::rig("paper_bench_fdva");
  const std::unique_ptr<Spans> spans = std::make_unique<Spans>();
  const hal::SensorSetup sensors{};
  const DatagramWriter writer{rig, sensors, true, 1, *spans, "a.1@here"};
  const support::DatagramInbox inbox;

  static Record of(std::uint64_t period) {
    Record record;
    record.period = period;
    record.time = hal::milliseconds(static_cast<std::int64_t>(period));
    return record;
  }
};

TEST_F(Published, SendsEachRecordOnceInOrderAndThenWhyItEnds) {
  LiveTap tap(1);
  std::string trouble;
  const DatagramSocket socket(firmware::parse_host_port("--publish", inbox.address()), trouble);
  ASSERT_EQ(trouble, "");
  Publisher publisher(cpus_without(-1), tap, writer, socket, 10.0);
  for (std::uint64_t k = 0; k < 25; ++k) tap.offer(of(k));
  publisher.finish();
  publisher.say_end("reference_ended");
  for (std::uint64_t k = 0; k < 25; ++k) {
    const json object = json::parse(inbox.next());
    EXPECT_EQ(object["sequence"], k);
    EXPECT_EQ(object["period"], k);
    EXPECT_EQ(object["lost"], 0);
    EXPECT_EQ(object.contains("setup"), k % 10 == 0) << "once a second";
  }
  const json end = json::parse(inbox.next());
  EXPECT_EQ(end["ended"], "reference_ended");
  EXPECT_EQ(end["sequence"], 25);
  EXPECT_EQ(publisher.sent(), 26U);
  EXPECT_EQ(publisher.lost(), 0U);
}

// Nobody need listen: that is no loss and no error, and who comes later is served.
TEST_F(Published, GoesOnWhileNobodyListens) {
  std::string address;
  {
    const support::DatagramInbox gone;
    address = gone.address();
  }
  LiveTap tap(1);
  std::string trouble;
  const DatagramSocket socket(firmware::parse_host_port("--publish", address), trouble);
  Publisher publisher(cpus_without(-1), tap, writer, socket, 10.0);
  for (std::uint64_t k = 0; k < 100; ++k) tap.offer(of(k));
  publisher.finish();
  EXPECT_EQ(publisher.sent(), 100U);
  EXPECT_EQ(publisher.lost(), 0U);
}

// What the kernel does not take is counted, and the next datagram says so: here, one to a broadcast address, which a
// socket may not send to without a right that this one does not ask for.
TEST_F(Published, CountsWhatIsNotSent) {
  LiveTap tap(1);
  std::string trouble;
  const DatagramSocket socket(firmware::parse_host_port("--publish", "255.255.255.255:9870"), trouble);
  Publisher publisher(cpus_without(-1), tap, writer, socket, 10.0);
  for (std::uint64_t k = 0; k < 7; ++k) tap.offer(of(k));
  publisher.finish();
  EXPECT_EQ(publisher.sent(), 0U);
  EXPECT_EQ(publisher.lost(), 7U);
}

// Loss before the publisher's thread: the ring was full.
TEST_F(Published, SaysWhatTheTapHasLost) {
  LiveTap tap(1, 4);
  for (std::uint64_t k = 0; k < 9; ++k) tap.offer(of(k));
  std::string trouble;
  const DatagramSocket socket(firmware::parse_host_port("--publish", inbox.address()), trouble);
  Publisher publisher(cpus_without(-1), tap, writer, socket, 10.0);
  publisher.finish();
  EXPECT_EQ(json::parse(inbox.next())["lost"], 5);
  EXPECT_EQ(publisher.lost(), 5U);
}

}  // namespace
