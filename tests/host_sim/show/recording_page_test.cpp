// Recordings as pages: no peak is lost, gaps are gaps, several recordings lie over each other.
#include "host_sim/show/recording_page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/report_page.hpp"

namespace recording_page_test {
namespace {

using namespace host_sim;
using model::Channel;
using show::Shown;

firmware::Recording recorded(std::size_t samples) {
  firmware::Recording recording;
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(samples, 1000.0);
  recording[Channel::z_r] = sample::sine(0.01, 3.0, samples);
  recording[Channel::F_w] = sample::sine(900.0, 3.0, samples);
  return recording;
}

// Law. A knock of one sample among 100 000 is in the trace, at its time, and so are lowest and highest of each stretch.
TEST(RecordingPage, LosesNoPeak) {
  firmware::Recording recording = recorded(100'000);
  recording[Channel::F_w][54'321] = 5000.0;
  const show::Trace trace = show::thinned(recording, recording[Channel::F_w], 8000);
  EXPECT_LE(trace.time.size(), 8000U);
  const auto peak = std::max_element(trace.values.begin(), trace.values.end());
  EXPECT_EQ(*peak, 5000.0);
  EXPECT_DOUBLE_EQ(trace.time[static_cast<std::size_t>(peak - trace.values.begin())], 54.321);
  EXPECT_TRUE(std::is_sorted(trace.time.begin(), trace.time.end()));
}

// Samples that were not recorded are a gap, and a short trace is drawn as it is.
TEST(RecordingPage, ShowsGaps) {
  firmware::Recording recording = recorded(1000);
  recording.filled.assign(1000, false);
  std::fill(recording.filled.begin() + 400, recording.filled.begin() + 500, true);
  const show::Trace trace = show::thinned(recording, recording[Channel::z_r], 8000);
  EXPECT_EQ(trace.time.size(), 1000U);
  EXPECT_EQ(std::count_if(trace.values.begin(), trace.values.end(), [](double v) { return std::isnan(v); }), 100);
}

// Point. What does the first sentence say? What was read of each. Traces and spectra have a panel a channel; two
// recordings and a model are told apart in each.
TEST(RecordingPage, LaysRecordingsOverEachOther) {
  Shown one{"one.csv", recorded(8000), {}}, other{"other.csv", recorded(4000), {}};
  one.recording.ignored_columns = {"Temperatur"};
  one.models.push_back({"car.toml", {}});
  one.models.front().channels[index(Channel::F_w)] = sample::sine(800.0, 3.0, 8000);
  EXPECT_EQ(show::sentence({one, other}),
            "one.csv: 8 s at 1000 Hz, 2 channels. other.csv: 4 s at 1000 Hz, 2 channels.");
  const std::string page = show::recordings_page({one, other});
  const auto figures = support::figures_of(page);
  ASSERT_EQ(figures.size(), 3U);  // traces, spectra, responses
  EXPECT_EQ(figures[0]["data"].size(), 5U);
  EXPECT_EQ(figures[1]["data"].size(), 5U);
  EXPECT_NE(page.find("Temperatur"), std::string::npos);
  EXPECT_NE(page.find("rigtwin channels"), std::string::npos);
  EXPECT_NE(page.find("dynamic wheel load"), std::string::npos);  // pointed at
}

}  // namespace
}  // namespace recording_page_test
