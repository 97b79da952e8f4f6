#include "host_sim/estimation/run_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "firmware/description/filtered_rig.hpp"
#include "firmware/description/semi_active_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/recording_file.hpp"

namespace host_sim::estimation {
namespace {

using firmware::EstimatorEquations;
using firmware::EstimatorState;
using firmware::EstimatorVector;
using firmware::KalmanFilter;
using model::Channel;
using model::CoreIndex;

constexpr std::array shown{Channel::z_r,   Channel::z_w,  Channel::z_b,  Channel::zdd_w,
                           Channel::zdd_b, Channel::dz_w, Channel::dz_b, Channel::F_w};

/// The description with the sensors that the filter shall use: those it names, else those that the recording has.
firmware::RigDescription with_sensors(const firmware::RigDescription& description,
                                      const firmware::Recording& recording) {
  firmware::RigDescription used = description;
  auto& sensors = used.controller.estimator_sensors;
  if (sensors.empty()) {
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      const Channel channel = model::channel_at(i);
      if (channel != Channel::F_act && used.noise[i].value_or(0.0) > 0.0 && recording.has(channel)) {
        sensors.push_back(channel);
      }
    }
    if (sensors.empty()) {
      throw firmware::InputError(recording.source, 0, "no channel that the filter can weigh",
                                 "a channel with its rms in [noise] of " + description.source);
    }
  }
  for (const Channel channel : sensors) static_cast<void>(recording.required(channel, "for the filter"));
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (std::find(sensors.begin(), sensors.end(), model::channel_at(i)) == sensors.end()) {
      used.controller.kalman.bias[i] = false;
    }
  }
  return used;
}

/// What is written of each period.
class Columns {
 public:
  Columns(const EstimatorEquations& equations, Estimate& result) : equations_(equations), result_(result) {
    for (const Channel channel : shown) add(std::string(model::name(channel)) + "_est", model::unit(channel));
    for (const char* name : {"v_r_est", "v_w_est", "v_b_est", "v_rel_est"}) add(name, "m/s");
    if (equations.ducts() > 0) {
      add("y_est", "m");
      add("vy_est", "m/s");
      add("F_c_est", "N");
    }
    for (int i = 0; i < equations.states(); ++i) {
      const EstimatorState& state = equations.state(i);
      if (state.kind != EstimatorState::Kind::bias) continue;
      const Channel channel = model::channel_at(static_cast<std::size_t>(state.entry));
      add("bias_" + std::string(model::name(channel)), model::unit(channel));
    }
    for (const char* name : {"nis", "innovations", "model_wrong"}) add(name, "");
  }

  void take(double time, const KalmanFilter& filter, int open, double actuator) {
    result_.time.push_back(time);
    next_ = 0;
    for (const Channel channel : shown) {
      put(equations_.output(channel, filter.state(), open, false) + equations_.feedthrough(channel) * actuator);
    }
    const double wheel = filter.core(CoreIndex::wheel_velocity), body = filter.core(CoreIndex::body_velocity);
    for (const double v : {filter.foot_point_velocity(), wheel, body, wheel - body}) put(v);
    if (equations_.ducts() > 0) {
      const double travel = filter.core(CoreIndex::piston_travel);
      put(travel);
      put(filter.core(CoreIndex::piston_velocity));
      put(model::Fdva<double>::force(equations_.rig().fdva,
                                     filter.core(CoreIndex::wheel_position) - filter.core(CoreIndex::body_position),
                                     travel));
    }
    for (int i = 0; i < equations_.states(); ++i) {
      if (equations_.state(i).kind == EstimatorState::Kind::bias) put(filter.state()(i));
    }
    put(filter.nis());
    put(filter.innovations());
    put(filter.monitor().model_wrong() ? 1.0 : 0.0);
  }

 private:
  void add(std::string name, std::string_view unit) {
    result_.columns.push_back({std::move(name), std::string(unit), {}});
  }
  void put(double value) { result_.columns[next_++].values.push_back(value); }

  const EstimatorEquations& equations_;
  Estimate& result_;
  std::size_t next_ = 0;
};

/// Sums over the innovations of each channel.
struct Sums {
  std::array<std::size_t, firmware::estimator_channels> count{};
  std::array<double, firmware::estimator_channels> squares{}, products{}, last{};

  void take(const KalmanFilter& filter, int channels) {
    for (int i = 0; i < channels; ++i) {
      const auto c = static_cast<std::size_t>(i);
      const double innovation = filter.innovation(i);
      if (innovation == 0.0) continue;  // none this period
      squares[c] += innovation * innovation;
      products[c] += innovation * last[c];
      last[c] = innovation;
      ++count[c];
    }
  }
};

hal::Openings openings_of(const firmware::Recording& recording, std::size_t k, hal::Openings described) {
  hal::Openings open = described;
  for (std::size_t j = 0; j < recording.ducts.size() && j < hal::Openings::capacity; ++j) {
    if (!recording.ducts[j].empty()) open = open.with(j, recording.ducts[j][k] > 0.5);
  }
  return open;
}

std::string words(const firmware::InnovationMonitor& monitor, const EstimatorEquations& equations) {
  const auto& alarm = monitor.last();
  constexpr std::array<const char*, 5> tests{"", "level", "variance", "colour", "road"};
  char text[160];
  if (alarm.test == firmware::InnovationMonitor::Test::road) {
    std::snprintf(text, sizeof text, "the road moves otherwise than described, in %.0f %% of a block's samples of %s",
                  100.0 * alarm.statistic, std::string(model::name(equations.channel(alarm.channel))).c_str());
    return text;
  }
  std::snprintf(text, sizeof text, "%s of the innovations of %s, %.3g standard deviations (limit %.3g)",
                tests[static_cast<std::size_t>(alarm.test)],
                std::string(model::name(equations.channel(alarm.channel))).c_str(), alarm.statistic, monitor.limit());
  return text;
}

}  // namespace

const std::vector<double>& Estimate::column(std::string_view name) const {
  const auto at = std::find_if(columns.begin(), columns.end(), [name](const auto& c) { return c.name == name; });
  if (at == columns.end()) throw std::logic_error("no column " + std::string(name));
  return at->values;
}

Estimate run_filter(const firmware::RigDescription& description, const std::vector<firmware::Recording>& parts,
                    const std::vector<Ages>& ages) {
  firmware::RigDescription used = with_sensors(description, parts.front());
  used.sample_rate = 1.0 / parts.front().sample_period;
  const firmware::KalmanSettings settings = firmware::kalman_settings(used);
  const EstimatorEquations equations(settings, firmware::filtered_rig(used, settings));
  const auto filter = firmware::kalman_filter(used, equations);
  Estimate result;
  Columns columns(equations, result);
  Sums sums;
  double squares = 0.0;
  std::size_t innovations = 0;
  const hal::Openings described =
      hal::Openings::first(used.rig.has_fdva ? static_cast<std::size_t>(used.rig.fdva.open_ducts) : std::size_t{0});
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const firmware::Recording& recording = parts[p];
    filter->restart();
    filter->switch_to(openings_of(recording, 0, described));
    for (std::size_t k = 0; k < recording.size(); ++k) {
      const hal::Time now = hal::seconds(static_cast<double>(k) * recording.sample_period);
      hal::Frame frame;
      const bool filled = !recording.filled.empty() && recording.filled[k];
      for (std::size_t i = 0; i < model::channel_count && !filled; ++i) {
        if (recording.channels[i].empty() || !std::isfinite(recording.channels[i][k])) continue;
        const double value = recording.channels[i][k];
        if (used.range[i] && !used.range[i]->holds(value)) continue;
        // Without stamps a sample is as old as the description says.
        const bool stamped = !ages[p][i].empty() && std::isfinite(ages[p][i][k]);
        const double age = stamped ? ages[p][i][k] : used.controller.kalman.age[i];
        frame.channels[i] = {value, now - hal::seconds(age), hal::Quality::good};
      }
      filter->step(frame, 0, now);
      const hal::Openings open = openings_of(recording, k, described);
      columns.take(recording.time[k], *filter, model::count(static_cast<model::OpenDucts>(open.bits())),
                   recording.has(Channel::F_act) ? recording[Channel::F_act][k] : 0.0);
      sums.take(*filter, equations.channels());
      squares += filter->nis();
      innovations += static_cast<std::size_t>(filter->innovations());
      filter->switch_to(open);
    }
    result.wide_rows += filter->wide_periods();
    result.alarms += filter->monitor().alarms();
    result.blocks += filter->monitor().blocks();
    if (filter->monitor().alarms() > 0) result.last_alarm = words(filter->monitor(), equations);
  }
  result.nis = innovations > 0 ? squares / static_cast<double>(innovations) : 0.0;
  result.too_old = filter->too_old();
  for (int i = 0; i < equations.channels(); ++i) {
    const auto c = static_cast<std::size_t>(i);
    const double n = sums.count[c] > 0 ? static_cast<double>(sums.count[c]) : 1.0;
    const double variance = sums.squares[c] / n;
    result.channels.push_back({equations.channel(i), sums.count[c], std::sqrt(variance),
                               variance > 0.0 ? sums.products[c] / n / variance : 0.0});
  }
  const auto gains = std::make_unique<firmware::SteadyGains>(equations, used.period());
  const int open = used.rig.has_fdva ? used.rig.fdva.open_ducts : 0;
  gains->compute(open);
  const EstimatorVector load = equations.row(Channel::F_w, open, false);
  EstimatorVector velocity = EstimatorVector::Zero();
  velocity(equations.core(CoreIndex::wheel_velocity)) = 1.0;
  velocity(equations.core(CoreIndex::body_velocity)) = -1.0;
  result.sigma_wheel_load = std::sqrt(load.dot(gains->posterior() * load));
  result.sigma_velocity = std::sqrt(velocity.dot(gains->posterior() * velocity));
  return result;
}

std::vector<Ages> recorded_ages(const std::filesystem::path& file, const firmware::RigDescription& description,
                                const std::vector<firmware::Recording>& parts) {
  std::vector<Ages> ages(parts.size());
  if (firmware::RecordingFile(file).is_matlab()) return ages;
  const firmware::AsRecorded recorded = firmware::read_csv_as_recorded(file, description.channels);
  const std::vector<double>& stamps = recorded.recording.time;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (recorded.age[i].empty()) continue;
    std::size_t row = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      ages[p][i].resize(parts[p].size());
      for (std::size_t k = 0; k < parts[p].size(); ++k) {
        const double earliest = parts[p].time[k] - 0.5 * parts[p].sample_period;
        while (row + 1 < stamps.size() && stamps[row] < earliest) ++row;
        ages[p][i][k] = row < recorded.age[i].size() ? recorded.age[i][row] : 0.0;
      }
    }
  }
  return ages;
}

}  // namespace host_sim::estimation
