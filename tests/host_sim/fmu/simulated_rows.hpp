// Rows of `rigtwin simulate`, which an FMU of any version repeats.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace support {

/// Every column of `recording` at row k, from the FMU.
template <class FmuInstance>
void expect_row(FmuInstance& instance, const firmware::Recording& recording, std::size_t k) {
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (recording.channels[i].empty()) continue;
    const std::string name(model::channel_names[i].name);
    ASSERT_EQ(instance.real(name), recording.channels[i][k]) << name << ", row " << k;
  }
  for (const auto& column : recording.extra) {
    ASSERT_EQ(instance.real(column.name), column.values[k]) << column.name << ", row " << k;
  }
  if (k + 1 == recording.size()) return;  // the run of simulate has ended there: its valves are safe already
  for (std::size_t j = 0; j < recording.ducts.size(); ++j) {
    if (recording.ducts[j].empty()) continue;
    ASSERT_EQ(instance.real("duct_" + std::to_string(j + 1)), recording.ducts[j][k]) << "row " << k;
  }
}

inline firmware::Recording simulated(const TemporaryFolder& folder, std::vector<std::string> more) {
  const std::string out = folder / "run.csv";
  more.insert(more.begin(), {"simulate", "--out", out});
  const Ended ended = rigtwin(more);
  EXPECT_EQ(ended.status, 0) << ended.errors;
  return host_sim::read_recording(out, {}, 1000.0);
}

}  // namespace support
