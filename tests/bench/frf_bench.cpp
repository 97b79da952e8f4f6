// What frequency responses cost.
//
//   frf/ten_minutes       ten minutes at 1 kHz: eight channels over one, blocks chosen, delays looked for, bounds; at
//   most 1 s frf/ten_minutes_json  the same as the text of the JSON file
#include <benchmark/benchmark.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "host_sim/frf/response_estimate.hpp"
#include "host_sim/frf/result_json.hpp"

namespace {

using model::Channel;

host_sim::frf::Request request() {
  host_sim::frf::Request request;
  request.outputs = {Channel::z_w,  Channel::z_b,  Channel::zdd_w, Channel::zdd_b,
                     Channel::dz_w, Channel::dz_b, Channel::F_w,   Channel::F};
  return request;
}

/// Noise, and each output a lag behind it with noise of its own.
std::vector<firmware::Recording> ten_minutes() {
  constexpr std::size_t samples = 600000;
  firmware::Recording recording;
  recording.sample_period = 1e-3;
  recording.time.resize(samples);
  auto& input = recording[Channel::z_r];
  firmware::Gaussian gaussian(1, 0);
  input.resize(samples);
  for (double& x : input) x = gaussian();
  for (const Channel output : request().outputs) {
    auto& y = recording[output];
    y.resize(samples);
    double state = 0.0;
    for (std::size_t n = 0; n < samples; ++n) {
      state += 0.1 * (input[n] - state);
      y[n] = state + 0.1 * gaussian();
    }
  }
  return {recording};
}

void estimate(benchmark::State& state) {
  const auto recordings = ten_minutes();
  for (auto _ : state) {
    benchmark::DoNotOptimize(host_sim::frf::estimate_responses(recordings, request()).averages);
  }
}
BENCHMARK(estimate)->Name("frf/ten_minutes")->Unit(benchmark::kMillisecond);

void write(benchmark::State& state) {
  const auto responses = host_sim::frf::estimate_responses(ten_minutes(), request());
  for (auto _ : state) benchmark::DoNotOptimize(host_sim::frf::to_json(responses).dump().size());
}
BENCHMARK(write)->Name("frf/ten_minutes_json")->Unit(benchmark::kMillisecond);

}  // namespace
