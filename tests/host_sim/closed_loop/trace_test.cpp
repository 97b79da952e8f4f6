// One number for a run: every bit of every value counts.
#include "host_sim/closed_loop/trace.hpp"

#include <gtest/gtest.h>

#include <set>

#include "firmware/recording/recording.hpp"

namespace {

using firmware::Recording;
using host_sim::trace_hash;
using model::Channel;

Recording small() {
  Recording recording;
  recording.sample_period = 1.0;
  recording.time = {0.0, 1.0};
  recording[Channel::F] = {1.0, 2.0};
  recording.ducts[2] = {1.0, 0.0};
  recording.extra = {{"v", "m/s", {3.0, 4.0}}};
  return recording;
}

// Point. FNV-1a, 64 bit, of eight zero bytes – one row with t = 0 – from its published constants: eight times h ← h ·
// p.
TEST(Trace, IsTheHashOfFowlerNollVo) {
  Recording recording;
  EXPECT_EQ(host_sim::hexadecimal(trace_hash(recording)), "cbf29ce484222325") << "of nothing";
  recording.time = {0.0};
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (int byte = 0; byte < 8; ++byte) hash *= 0x100000001b3U;
  EXPECT_EQ(trace_hash(recording), hash);
}

// Whatever is changed – a bit, a sign of zero, the order, the column – is another trace.
TEST(Trace, ChangesWithEveryValue) {
  const auto changed = [](auto&& change) {
    Recording recording = small();
    change(recording);
    return trace_hash(recording);
  };
  std::set<std::uint64_t> hashes{trace_hash(small())};
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r.time[1] = 1.0000000000000002; })).second);
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r.time[0] = -0.0; })).second);
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r[Channel::F] = {2.0, 1.0}; })).second);
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r.ducts[2][1] = 1.0; })).second);
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r.extra[0].values[1] = 5.0; })).second);
  EXPECT_TRUE(hashes.insert(changed([](Recording& r) { r.extra.clear(); })).second);
  EXPECT_EQ(trace_hash(small()), changed([](Recording& r) { r.comments = {"not a value"}; }));
}

TEST(Trace, IsWrittenInSixteenDigits) {
  EXPECT_EQ(host_sim::hexadecimal(0), "0000000000000000");
  EXPECT_EQ(host_sim::hexadecimal(0x0123456789abcdefU), "0123456789abcdef");
}

}  // namespace
