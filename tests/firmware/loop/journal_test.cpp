#include "firmware/loop/journal.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

namespace {

using firmware::Journal;
using firmware::JournalStorage;
using firmware::Record;

Record numbered(std::uint64_t period) {
  Record record;
  record.period = period;
  record.values.fill(static_cast<double>(period));
  return record;
}

TEST(Journal, GivesBackInOrder) {
  JournalStorage<3> storage;
  Journal journal(storage);
  EXPECT_FALSE(journal.pop());
  for (std::uint64_t round = 0; round < 5; ++round) {
    EXPECT_TRUE(journal.push(numbered(2 * round)));
    EXPECT_TRUE(journal.push(numbered(2 * round + 1)));
    EXPECT_EQ(journal.pop()->period, 2 * round);
    EXPECT_EQ(journal.pop()->values[12], static_cast<double>(2 * round + 1));
    EXPECT_FALSE(journal.pop());
  }
  EXPECT_EQ(journal.lost(), 0U);
}

// A reader that sleeps costs records, never time; which ones is known from the gap, how many from the count.
TEST(Journal, LosesTheNewestWhenFullAndCountsThem) {
  JournalStorage<3> storage;
  Journal journal(storage);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_TRUE(journal.push(numbered(i)));
  EXPECT_FALSE(journal.push(numbered(3)));
  EXPECT_FALSE(journal.push(numbered(4)));
  EXPECT_EQ(journal.lost(), 2U);
  EXPECT_EQ(journal.pop()->period, 0U);
  EXPECT_TRUE(journal.push(numbered(5)));
  EXPECT_EQ(journal.pop()->period, 1U);
  EXPECT_EQ(journal.pop()->period, 2U);
  EXPECT_EQ(journal.pop()->period, 5U) << "after the gap";
}

// Two threads at full speed: every record arrives whole and in order, or is counted as lost.
TEST(Journal, ServesTwoThreadsWithoutLocks) {
  constexpr std::uint64_t total = 200'000;
  const auto storage = std::make_unique<JournalStorage<64>>();
  Journal journal(*storage);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < total; ++i) journal.push(numbered(i));
    done = true;
  });
  std::uint64_t received = 0, expected_least = 0;
  bool whole = true, ordered = true;
  for (bool last_look = false; !last_look;) {
    last_look = done;
    while (const auto record = journal.pop()) {
      ordered = ordered && record->period >= expected_least;
      expected_least = record->period + 1;
      for (const double value : record->values) whole = whole && value == static_cast<double>(record->period);
      ++received;
    }
  }
  writer.join();
  EXPECT_TRUE(ordered);
  EXPECT_TRUE(whole);
  EXPECT_EQ(received + journal.lost(), total);
}

TEST(JournalDeathTest, NeedsRoom) { EXPECT_DEATH(Journal(std::span<Record>{}), ""); }

}  // namespace
