#include "firmware/loop/common/mode.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "firmware/loop/common/trip.hpp"

namespace {

using firmware::Event;
using firmware::Mode;
using firmware::Reason;

constexpr std::array modes{Mode::idle,    Mode::arming,  Mode::armed, Mode::ready,
                           Mode::running, Mode::holding, Mode::safe};
std::vector<Event> events() {
  std::vector<Event> all;
  for (int e = 0; e <= static_cast<int>(firmware::last_event); ++e) all.push_back(static_cast<Event>(e));
  return all;
}

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
    for (const Event event : events()) {
      const bool trips = event == Event::halt || (event == Event::trip && leads_drive(mode));
      Mode expected = trips ? Mode::safe : mode;
      for (const Change& change : changes) {
        if (change.from == mode && change.event == event) expected = change.to;
      }
      EXPECT_EQ(next(mode, event), expected) << name(mode) << ", event " << name(event);
    }
  }
}

// Law. From safe or idle there is no way to running but through arming, armed and ready: nobody is surprised by a rig
// that moves again.
TEST(Mode, LeavesSafeOnlyByAFreshStart) {
  for (const Event first : events()) {
    for (const Event second : events()) {
      for (const Event third : events()) {
        for (const Event fourth : events()) {
          EXPECT_FALSE(in_run(next(next(next(next(Mode::safe, first), second), third), fourth)));
        }
      }
    }
  }
}

// Law. Two lines of the table give power: an arming that has compared, and a person's `rest`. No reason does, and no
// request but `rest` leads to a line that does without an arming.
TEST(Mode, GivesPowerInTwoPlaces) {
  for (const firmware::Transition& line : firmware::transitions) {
    const bool gives = line.power == firmware::Power::give;
    EXPECT_EQ(gives, line.event == Event::compared || line.event == Event::rest) << name(line.event);
    EXPECT_FALSE(line.from == Mode::safe && line.to != Mode::safe && line.event != Event::acknowledge);
  }
  for (const firmware::RequestRule& rule : firmware::request_rules) {
    if (firmware::transition(rule.mode, rule.event).power != firmware::Power::give) continue;
    EXPECT_EQ(rule.request, firmware::Request::rest);
    EXPECT_EQ(rule.needs, firmware::need::standing | firmware::need::no_hazard | firmware::need::proven);
  }
}

// Law. Whatever the reason and the state, a drive without power stays where it is.
TEST(Reason, GivesNoPowerToADriveWithoutIt) {
  for (int r = 0; r <= static_cast<int>(firmware::last_reason); ++r) {
    for (const Mode mode : modes) {
      const auto reason = static_cast<Reason>(r);
      EXPECT_EQ(event_of(reason, mode, false), Event::halt) << name(reason) << ", " << name(mode);
      EXPECT_EQ(event_of(reason, mode, true) == Event::halt, takes_power(reason) || mode == Mode::idle ||
                                                                 mode == Mode::safe ||
                                                                 (reason == Reason::force && !in_run(mode)));
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
  for (int r = 0; r <= static_cast<int>(firmware::last_reason); ++r) {
    const auto reason = static_cast<Reason>(r);
    EXPECT_FALSE(name(reason).empty()) << r;
    names.insert(name(reason));
    EXPECT_EQ(is_fault(reason),
              reason != Reason::none && reason != Reason::reference_ended && reason != Reason::stop_requested);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(firmware::last_reason) + 1);
  EXPECT_EQ(name(Reason::late), "late");
  EXPECT_EQ(name(Reason::force), "force");
}

}  // namespace
