// What a minute at 1 kHz costs on the PC, in processor time.
//
//   simulate/minute        the paper's hil rig over 60 s of class B through the firmware, CSV text included; at most
//   0.4 s recording/read_minute  ten columns of full-length decimals recording/write_minute the same, written
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/simulation/road.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "tests/support/rig_descriptions.hpp"

namespace {

constexpr std::size_t minute = 60000;

firmware::RigDescription hil_rig() {
  return firmware::parse_rig(std::string(support::hil_text) + R"([noise]
F = 10.0
x_act = 2e-5
[limits]
speed = 1.5
)",
                             "hil.toml");
}

void simulate_minute(benchmark::State& state) {
  const firmware::RigDescription rig = hil_rig();
  for (auto _ : state) {
    const auto road = firmware::drive_over(firmware::IsoRoad{}, rig.sample_rate, minute);
    const host_sim::Run run = host_sim::run_closed_loop(rig, road, {});
    if (run.recording.size() != minute) state.SkipWithError("the run ended early");
    benchmark::DoNotOptimize(firmware::format_recording_csv(run.recording).size());
  }
}
BENCHMARK(simulate_minute)->Name("simulate/minute")->Unit(benchmark::kMillisecond);

firmware::Recording ten_columns() {
  firmware::Recording recording;
  recording.sample_period = 1e-3;
  recording.time = firmware::sample_times(minute, 1000.0);
  for (std::size_t i = 0; i < 9; ++i) {
    recording.channels[i].resize(minute);
    for (std::size_t k = 0; k < minute; ++k) {
      recording.channels[i][k] = std::sin(1e-3 * static_cast<double>(k * (i + 1)));  // all 17 digits
    }
  }
  return recording;
}

void read_minute(benchmark::State& state) {
  const std::string text = firmware::format_recording_csv(ten_columns());
  for (auto _ : state) benchmark::DoNotOptimize(firmware::parse_recording_csv(text, "minute.csv", {}, 1000.0).size());
}
BENCHMARK(read_minute)->Name("recording/read_minute")->Unit(benchmark::kMillisecond);

void write_minute(benchmark::State& state) {
  const firmware::Recording recording = ten_columns();
  for (auto _ : state) benchmark::DoNotOptimize(firmware::format_recording_csv(recording).size());
}
BENCHMARK(write_minute)->Name("recording/write_minute")->Unit(benchmark::kMillisecond);

}  // namespace
