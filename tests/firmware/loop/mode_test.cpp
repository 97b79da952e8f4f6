#include "firmware/loop/mode.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "firmware/loop/trip.hpp"

namespace {

using firmware::Event;
using firmware::Mode;
using firmware::Reason;

constexpr std::array modes{Mode::idle,    Mode::arming,  Mode::armed, Mode::ready,
                           Mode::running, Mode::holding, Mode::safe};
constexpr std::array events{Event::arm,  Event::checked, Event::disarm, Event::start,      Event::in_position,
                            Event::hold, Event::resume,  Event::trip,   Event::acknowledge};

// The whole table, so that a transition that slips in is noticed.
TEST(Mode, ChangesOnlyAsWritten) {
  struct Change {
    Mode from;
    Event event;
    Mode to;
  };
  constexpr std::array changes{
      Change{Mode::idle, Event::arm, Mode::arming},           Change{Mode::arming, Event::checked, Mode::armed},
      Change{Mode::armed, Event::disarm, Mode::idle},         Change{Mode::armed, Event::start, Mode::ready},
      Change{Mode::ready, Event::in_position, Mode::running}, Change{Mode::running, Event::hold, Mode::holding},
      Change{Mode::holding, Event::resume, Mode::running},    Change{Mode::safe, Event::acknowledge, Mode::idle}};
  for (const Mode mode : modes) {
    for (const Event event : events) {
      Mode expected = event == Event::trip ? Mode::safe : mode;
      for (const Change& change : changes) {
        if (change.from == mode && change.event == event) expected = change.to;
      }
      EXPECT_EQ(next(mode, event), expected) << name(mode) << ", event " << static_cast<int>(event);
    }
  }
}

// Law. From safe or idle there is no way to running but through arming, armed and ready: nobody is surprised by a rig
// that moves again.
TEST(Mode, LeavesSafeOnlyByAFreshStart) {
  for (const Event first : events) {
    for (const Event second : events) {
      for (const Event third : events) {
        for (const Event fourth : events) {
          EXPECT_FALSE(in_run(next(next(next(next(Mode::safe, first), second), third), fourth)));
        }
      }
    }
  }
}

// A stop, open interlocks, and whatever leaves the drive's place or direction unknown take the power at once.
TEST(Reason, TakesThePowerWhereTheDriveIsNotToBeTrusted) {
  EXPECT_TRUE(takes_power(Reason::stop_button));
  EXPECT_TRUE(takes_power(Reason::stop_channels));
  EXPECT_TRUE(takes_power(Reason::interlock));
  EXPECT_TRUE(takes_power(Reason::command_failed));
  EXPECT_TRUE(takes_power(Reason::arming_polarity_F));
  EXPECT_FALSE(takes_power(Reason::stop_requested));
  EXPECT_FALSE(takes_power(Reason::reference_ended));
  EXPECT_FALSE(takes_power(Reason::force));
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
