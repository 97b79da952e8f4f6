#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/truth/random.hpp"
#include "tests/truth/recorder.hpp"
#include "tests/truth/rig.hpp"
#include "tests/truth/sensor.hpp"
#include "tests/truth/signal.hpp"
#include "tests/truth/truth.hpp"

namespace truth {
namespace {

double true_value(const std::string& channel, const Rig::Values& v, const Rig::State& s, double sensor_mass) {
  if (channel == "z_r") return v.z_r;
  if (channel == "z_w") return s[Rig::zw];
  if (channel == "z_b") return s[Rig::zb];
  if (channel == "zdd_r") return v.zdd_r;
  if (channel == "zdd_w") return v.zdd_w;
  if (channel == "zdd_b") return v.zdd_b;
  if (channel == "dz_w") return v.z_r - s[Rig::zw];
  if (channel == "dz_b") return s[Rig::zw] - s[Rig::zb];
  if (channel == "F_w") return v.wheel_load + sensor_mass * v.zdd_r;
  if (channel == "x_cmd") return v.x_cmd;
  if (channel == "x_act") return v.x_act;
  return v.force;
}

Record run(const Truth& truth, const Numbers& numbers, const RecordPlan& plan, const Fineness& fineness) {
  const double sample = 1.0 / truth.sample_rate;
  const int fine = static_cast<int>(std::ceil(fineness.steps_per_millisecond * 1e3 * sample));
  const Signal signal(plan, truth.kind == Kind::component_bench);
  const auto warm = static_cast<std::size_t>(std::lround(plan.warm * truth.sample_rate));
  const auto count = static_cast<std::size_t>(std::lround(plan.duration * truth.sample_rate));
  const std::size_t all = warm + count;

  Random random(plan.noise_seed);
  std::map<std::string, Sensor> sensors;
  for (const std::string& channel : channels_of(truth.kind)) {
    const auto found = truth.noise.find(channel);
    const double rms = found == truth.noise.end() || !fineness.noise ? 0.0 : found->second;
    const double phase = random.uniform();
    std::vector<double> noise(all + 1);
    for (double& n : noise) n = rms * random.normal();
    sensors.try_emplace(channel, truth, channel, std::move(noise), phase, fine);
  }
  const std::string leak = truth.unknown_parameters.contains("cross_talk") ? truth.unknown_channel : std::string{};
  const double leaking = leak.empty() ? 0.0 : truth.unknown_parameters.at("cross_talk");

  const bool hil = truth.kind == Kind::hil;
  Rig rig(numbers, signal, sample / fine, plan.warm + plan.duration, hil ? &sensors.at("F") : nullptr);
  struct Column {
    std::string name;
    Sensor* sensor;
    bool fed_by_rig;  ///< F of a hil rig, whose history the rig itself keeps
    std::vector<double>* values;
    Recording recording;
  };
  Record record;
  std::vector<Column> columns;
  bool every_node = false;
  for (const std::string& channel : channels_of(truth.kind)) {
    std::vector<double>& values = record.channels[channel];
    values.reserve(count);
    Sensor& sensor = sensors.at(channel);
    const bool fed = hil && channel == "F";
    const auto recorder = truth.rough.recorder.find(channel);
    columns.push_back({channel, &sensor, fed, &values,
                       Recording(recorder == truth.rough.recorder.end() ? Recorder{} : recorder->second, sample / fine,
                                 sample, Random(plan.noise_seed + 7919 * (columns.size() + 1)))});
    every_node = every_node || (!fed && (sensor.remembers() || sensor.lags())) || columns.back().recording.every_node();
  }

  const std::size_t nodes = all * static_cast<std::size_t>(fine);
  for (std::size_t node = 0; node < nodes; ++node) {
    const bool at_sample = node % static_cast<std::size_t>(fine) == 0;
    const std::size_t row = node / static_cast<std::size_t>(fine);
    if (every_node || (at_sample && row >= warm)) {
      const Rig::Values values = rig.values();
      const double t = static_cast<double>(node) * sample / fine;
      for (Column& column : columns) {
        const bool remembers = column.sensor->remembers() || column.sensor->lags();
        double before = 0.0;
        const bool recording = column.recording.every_node();
        if (!column.fed_by_rig && (remembers || recording || at_sample)) {
          double value = true_value(column.name, values, rig.state(), numbers.sensor_mass);
          if (column.name == leak) value += leaking * true_value("zdd_w", values, rig.state(), 0.0);
          before = column.sensor->before_noise(value, t);
          if (remembers) column.sensor->push(before);
        }
        if (!recording && (!at_sample || row < warm)) continue;
        double shown = 0.0;
        if (remembers)
          shown = column.sensor->newest();
        else if (column.fed_by_rig)
          shown = column.sensor->before_noise(values.force, t) + column.sensor->noise_at(node);
        else
          shown = before + column.sensor->noise_at(node);
        shown = column.sensor->limited(shown);
        if (recording) column.recording.push(shown, at_sample);
        if (at_sample && row >= warm)
          column.values->push_back(column.recording.row(shown, static_cast<double>(row - warm) * sample));
      }
    }
    if (node + 1 < nodes) rig.step();
  }
  for (Column& column : columns) column.recording.strike(*column.values);
  record.time.reserve(count);
  for (std::size_t i = 0; i < count; ++i) record.time.push_back(plan.start + static_cast<double>(i) * sample);
  return record;
}

}  // namespace

std::vector<Record> simulate(const Truth& truth, const Fineness& fineness) {
  const Numbers numbers = numbers_of(truth);
  std::vector<Record> records;
  for (const RecordPlan& plan : truth.records) records.push_back(run(truth, numbers, plan, fineness));
  return records;
}

}  // namespace truth
