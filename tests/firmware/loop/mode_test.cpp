#include "firmware/loop/mode.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "firmware/loop/trip.hpp"

namespace {

using firmware::Event;
using firmware::Mode;
using firmware::Reason;

constexpr std::array modes{Mode::idle, Mode::ready, Mode::running, Mode::safe};
constexpr std::array events{Event::start, Event::in_position, Event::trip, Event::acknowledge};

// The whole table, so that a transition that slips in is noticed.
TEST(Mode, ChangesOnlyAsWritten) {
  constexpr std::array<std::array<Mode, 4>, 4> expected{{
      // start, in_position, trip, acknowledge
      {Mode::ready, Mode::idle, Mode::idle, Mode::idle},          // idle
      {Mode::ready, Mode::running, Mode::safe, Mode::ready},      // ready
      {Mode::running, Mode::running, Mode::safe, Mode::running},  // running
      {Mode::safe, Mode::safe, Mode::safe, Mode::idle},           // safe
  }};
  for (std::size_t m = 0; m < modes.size(); ++m) {
    for (std::size_t e = 0; e < events.size(); ++e) {
      EXPECT_EQ(next(modes[m], events[e]), expected[m][e]) << name(modes[m]) << ", event " << e;
    }
  }
}

// Law. From safe there is no way to running but by idle and ready: nobody is surprised by a rig that moves again.
TEST(Mode, LeavesSafeOnlyByAFreshStart) {
  for (const Event first : events) {
    for (const Event second : events) {
      EXPECT_NE(next(next(Mode::safe, first), second), Mode::running);
    }
  }
}

TEST(Reason, HasItsOwnNameEach) {
  std::set<std::string_view> names;
  for (int r = 0; r <= static_cast<int>(Reason::late); ++r) {
    const auto reason = static_cast<Reason>(r);
    EXPECT_FALSE(name(reason).empty()) << r;
    names.insert(name(reason));
    EXPECT_EQ(is_fault(reason),
              reason != Reason::none && reason != Reason::reference_ended && reason != Reason::stop_requested);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(Reason::late) + 1);
  EXPECT_EQ(name(Reason::late), "late");
  EXPECT_EQ(name(Reason::force), "force");
}

}  // namespace
