#include "host_sim/compensation/machine_record.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numeric>
#include <span>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::compensation {
namespace {

using Phase = std::complex<double>;
using Lead = std::function<Phase(double omega)>;

/// Of the command, at each end of the band: what is left of a command there is the noise of its converter, which an
/// inverse amplifies. The record of a chirp from 0.4 to 20 Hz: 0.10 … 20.1 Hz; at half 0.06 … 46 Hz and an error of
/// 4.5 in place of 2.7 %, at twice 0.3 … 18 Hz and 2.4 %.
constexpr double left_out_power = 0.01;
constexpr double led_beyond = 1.5;        ///< up to so many times the end of the band a command is led, as it is beyond
constexpr double shortest_padding = 2.0;  ///< zeros behind the signals [s]: what a lead moves must not come round
constexpr double delay_grid = 1e-4;       ///< of the best pure delay, then refined [s]
constexpr double longest_pure_delay = 0.2;

std::vector<double> without_mean(std::vector<double> values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  return values;
}

/// Both columns as spectra, and the band of the command.
class Spectra {
 public:
  Spectra(const std::vector<double>& command, const std::vector<double>& reached, double period)
      : transform_(good_fft_size(command.size() + static_cast<std::size_t>(shortest_padding / period))),
        step_(full_turn / (period * static_cast<double>(transform_.length()))) {
    const auto take = [&](const std::vector<double>& signal) {
      const auto bins = transform_(signal);
      return std::vector<Phase>(bins.begin(), bins.end());
    };
    command_ = take(command);
    reached_ = take(reached);
    double whole = 0.0;
    for (std::size_t k = 1; k < command_.size(); ++k) whole += std::norm(command_[k]);
    double sum = 0.0;
    first_ = last_ = 0;
    for (std::size_t k = 1; k < command_.size(); ++k) {
      sum += std::norm(command_[k]);
      if (first_ == 0 && sum > left_out_power * whole) first_ = k;
      if (last_ == 0 && sum >= (1.0 - left_out_power) * whole) last_ = k;
    }
  }

  [[nodiscard]] double lowest_hz() const { return step_ * static_cast<double>(first_) / full_turn; }
  [[nodiscard]] double highest_hz() const { return step_ * static_cast<double>(last_) / full_turn; }

  /// (3)
  [[nodiscard]] double error(const Lead& lead) const {
    double off = 0.0, all = 0.0;
    for (std::size_t k = first_; k <= last_; ++k) {
      off += std::norm(lead(step_ * static_cast<double>(k)) * reached_[k] - command_[k]);
      all += std::norm(command_[k]);
    }
    return std::sqrt(off / all);
  }

  [[nodiscard]] std::vector<double> command(const Lead& lead, std::size_t count) { return back(command_, lead, count); }
  [[nodiscard]] std::vector<double> reached(const Lead& lead, std::size_t count) { return back(reached_, lead, count); }

 private:
  std::vector<double> back(const std::vector<Phase>& spectrum, const Lead& lead, std::size_t count) {
    std::vector<Phase> bins = spectrum;
    const auto led = static_cast<std::size_t>(led_beyond * static_cast<double>(last_));
    for (std::size_t k = 1; k < transform_.length() / 2; ++k) {
      if (k <= led) bins[k] *= lead(step_ * static_cast<double>(k));
    }
    bins.back() = 0.0;
    std::vector<double> values = transform_.inverse(bins);
    values.resize(count);
    return values;
  }

  RealTransform transform_;
  double step_;  ///< [rad/s]
  std::vector<Phase> command_, reached_;
  std::size_t first_ = 0, last_ = 0;
};

Lead inverse_of(const model::MachinePath<double>& machine, double gain) {
  return [machine, gain](double omega) {
    const Phase s(0.0, omega);
    Phase inverse = std::exp(s * machine.delay) * (1.0 + machine.lag * s) / gain;
    if (machine.resonance_frequency > 0.0) {
      const Phase x = s / (full_turn * machine.resonance_frequency);
      inverse *= 1.0 + 2.0 * machine.resonance_damping * x + x * x;
    }
    return inverse;
  };
}

Lead series_of(const model::MachinePath<double>& machine, double gain, std::size_t order) {
  const auto a = firmware::compensation::inverse_series(machine, gain);
  return [a, order](double omega) {
    Phase sum = 0.0, power = 1.0;
    for (std::size_t i = 0; i <= order; ++i, power *= Phase(0.0, omega)) sum += a[i] * power;
    return sum;
  };
}

Lead pure_delay_of(double delay) {
  return [delay](double omega) { return std::polar(1.0, omega * delay); };
}

double best_delay(const Spectra& spectra) {
  const auto error = [&](double delay) { return spectra.error(pure_delay_of(delay)); };
  double best = 0.0, least = error(0.0);
  for (double step = 10.0 * delay_grid; step >= delay_grid; step /= 10.0) {
    const bool coarse = step > 5.0 * delay_grid;
    const double from = coarse ? 0.0 : best - 10.0 * step, to = coarse ? longest_pure_delay : best + 10.0 * step;
    for (double delay = std::max(0.0, from); delay <= to; delay += step) {
      if (const double e = error(delay); e < least) {
        least = e;
        best = delay;
      }
    }
  }
  return best;
}

}  // namespace

double MachineRecord::error_of(const std::string& name) const {
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; });
  return found == methods.end() ? 1.0 : found->error;
}

MachineRecord machine_record(const firmware::RigDescription& description, const firmware::Recording& recording) {
  const std::string purpose = "to compare the machine with its description";
  const auto command = without_mean(recording.required(model::Channel::x_cmd, purpose));
  const auto reached = without_mean(recording.required(model::Channel::x_act, purpose));
  const auto settings = firmware::compensation_settings(description, firmware::compensation::Kind::inverse);
  MachineRecord result;
  result.machine = settings.machine;
  if (!(firmware::compensation::inverse_series(settings.machine, 1.0)[1] > 0.0)) {
    throw firmware::InputError(description.source, 0, "the machine of this rig is not late",
                               "[effects.actuator_delay], actuator_lag or actuator_resonance, as diagnose names them");
  }
  if (std::all_of(command.begin(), command.end(), [](double x) { return std::abs(x) < 1e-12; })) {
    throw firmware::InputError(recording.source, 0, "x_cmd does not move", "a run of the machine");
  }
  Spectra spectra(command, reached, recording.sample_period);
  result.lowest_hz = spectra.lowest_hz();
  result.highest_hz = spectra.highest_hz();
  result.uncompensated = spectra.error(pure_delay_of(0.0));
  result.pure_delay = best_delay(spectra);
  const Lead exact = inverse_of(settings.machine, settings.gain);
  result.methods.push_back({best_pure_delay, spectra.error(pure_delay_of(result.pure_delay))});
  result.methods.push_back({exact_inverse, spectra.error(exact)});
  for (std::size_t order = 1; order < firmware::compensation::coefficients; ++order) {
    result.methods.push_back(
        {"series of order " + std::to_string(order), spectra.error(series_of(settings.machine, settings.gain, order))});
  }
  result.command = spectra.command(exact, recording.size());
  result.reached = spectra.reached(exact, recording.size());
  return result;
}

nlohmann::ordered_json to_json(const MachineRecord& record) {
  nlohmann::ordered_json json{{"schema", "rigtwin/compensation_record/1"},
                              {"machine",
                               {{"delay", record.machine.delay},
                                {"lag", record.machine.lag},
                                {"frequency", record.machine.resonance_frequency},
                                {"damping_ratio", record.machine.resonance_damping}}},
                              {"band_hz", {record.lowest_hz, record.highest_hz}},
                              {"uncompensated", record.uncompensated},
                              {"best_pure_delay", record.pure_delay}};
  for (const auto& method : record.methods) json["tracking_nrmse"][method.name] = method.error;
  return json;
}

firmware::Recording compensated_command(const MachineRecord& record, const firmware::Recording& recording) {
  firmware::Recording result = recording.without_samples();
  result.sample_period = recording.sample_period;
  result.time = recording.time;
  result[model::Channel::x_cmd] = record.command;
  result[model::Channel::x_act] = record.reached;
  result.extra.push_back({"x_wanted", "m", recording[model::Channel::x_cmd]});
  return result;
}

}  // namespace host_sim::compensation
