#include "host_sim/replicate/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/report/formatted.hpp"

namespace host_sim::replicate {
namespace {

/// How many samples after the first of the recording the drive begins, where the command is that of the drive; nullopt:
/// it is not.
std::optional<std::ptrdiff_t> place_of(const std::vector<double>& drive, const std::vector<double>& command) {
  constexpr std::ptrdiff_t farthest =
      200;                       // samples: a run begins with its first row, or has a few rows of rest before it
  constexpr double same = 1e-6;  // [m] a file's rounding, far below what any drive differs by
  double largest = 0.0;
  for (const double u : drive) largest = std::max(largest, std::abs(u));
  std::optional<std::ptrdiff_t> best;
  double least = std::max(same, 1e-4 * largest);
  for (std::ptrdiff_t lag = 0; lag <= farthest; lag = lag <= 0 ? 1 - lag : -lag) {
    double squares = 0.0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < drive.size(); ++k) {
      const auto at = static_cast<std::ptrdiff_t>(k) + lag;
      if (at < 0 || at >= static_cast<std::ptrdiff_t>(command.size())) continue;
      const double off = command[static_cast<std::size_t>(at)] - drive[k];
      squares += off * off;
      ++count;
    }
    const double rms = count > drive.size() / 20 ? std::sqrt(squares / static_cast<double>(count)) : INFINITY;
    if (rms < least) {
      least = rms;
      best = lag;
      if (rms < 1e-9) break;
    }
  }
  return best;
}

}  // namespace

RunRecord read_run(const firmware::RigDescription& description, const Target& target, const std::vector<Drive>& drives,
                   const firmware::Recording& recording) {
  const model::Channel channel = drive_channel(driven_part(description).rig.kind);
  const std::string name(model::name(channel));
  if (!recording.has(channel)) {
    throw firmware::InputError(recording.source, 0, "the run has no " + name + ", so its drive is not known",
                               "a recording of rig_controller, or one with the column " + name);
  }
  if (std::abs(recording.sample_period / target.period - 1.0) > 1e-4) {
    throw firmware::InputError(recording.source, 0,
                               formatted("the run has %.6g samples a second", 1.0 / recording.sample_period),
                               formatted("%.6g, the rate of the rig", 1.0 / target.period));
  }
  const Drive& newest = drives.back();
  const auto place = place_of(newest.values, recording[channel]);
  if (!place) {
    for (const Drive& other : drives) {
      if (&other == &newest || !place_of(other.values, recording[channel])) continue;
      throw firmware::InputError(recording.source, 0,
                                 "the run belongs to " + other.file + " (sha256 " + other.sha256.substr(0, 12) + "…)",
                                 "one of " + newest.file + " (sha256 " + newest.sha256.substr(0, 12) + "…)");
    }
    throw firmware::InputError(recording.source, 0,
                               "the run belongs to another drive: its " + name + " is none of this folder",
                               "one of " + newest.file + " (sha256 " + newest.sha256.substr(0, 12) + "…)");
  }
  RunRecord run;
  const std::size_t size = newest.values.size();
  const auto last = static_cast<std::ptrdiff_t>(recording.size()) - *place;
  run.samples = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(last, 0, static_cast<std::ptrdiff_t>(size)));
  const Part first = target.events.front();
  const std::size_t half = first.from + (first.to - first.from) / 2;
  if (run.samples < half) {
    throw firmware::InputError(
        recording.source, 0,
        formatted("the run was cut short after %.3g s", static_cast<double>(run.samples) * target.period),
        formatted("half of the first event of the target at least, %.3g s", static_cast<double>(half) * target.period));
  }
  if (run.samples < target.events.back().to) {
    run.remarks.push_back(formatted("the run was cut short after %.4g of %.4g s: only that is judged and corrected",
                                    static_cast<double>(run.samples) * target.period,
                                    static_cast<double>(size) * target.period));
  }
  bool any = false;
  for (const TargetChannel& wanted : target.channels) {
    const auto& column = recording[wanted.channel];
    const std::string lost(model::name(wanted.channel));
    const bool dead =
        !column.empty() && std::all_of(column.begin(), column.end(), [&](double v) { return v == column.front(); });
    const bool finite = std::all_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
    std::vector<double> values;
    if (column.empty() || dead || !finite) {
      run.remarks.push_back(lost +
                            (column.empty() ? " is not in the run"
                             : dead         ? " never moves in the run"
                                            : " has samples that are no numbers") +
                            ": it is neither judged nor corrected");
    } else {
      any = true;
      values.assign(size, 0.0);
      for (std::size_t k = 0; k < run.samples; ++k) {
        const auto at = static_cast<std::ptrdiff_t>(k) + *place;
        if (at >= 0) values[k] = column[static_cast<std::size_t>(at)];
      }
    }
    run.measured.push_back(std::move(values));
  }
  if (!any) {
    throw firmware::InputError(recording.source, 0, "the run holds no channel of the target that moves",
                               std::string(model::name(target.channels.front().channel)));
  }
  return run;
}

}  // namespace host_sim::replicate
