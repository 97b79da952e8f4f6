#include "firmware/controller/devices/replay_devices.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/reference/reference_player.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/replay/rig.hpp"

namespace firmware::controller {
namespace {

/// The interlock that ended a recording, as its last line names it. Nothing else on record says it.
std::size_t interlock_of(const std::string& file, const RigDescription& rig) {
  constexpr std::string_view words = "# ended by interlock ";
  std::ifstream stream(file);
  std::string line, last;
  while (std::getline(stream, line)) {
    if (line.starts_with(words)) last = line.substr(words.size());
  }
  const std::string name = last.substr(0, last.rfind(", "));
  if (!rig.hardware.gpio) return 0;
  const auto& interlocks = rig.hardware.gpio->interlocks;
  const auto found = std::find_if(interlocks.begin(), interlocks.end(),
                                  [&](const auto& interlock) { return one_line(interlock.name) == name; });
  return found == interlocks.end() ? 0 : static_cast<std::size_t>(found - interlocks.begin());
}

/// A first row that began late belongs to a session that had been idle before: with an idle period before it the loop
/// has the grid of that session. A late period moved it: its time is when it began.
AsRecorded with_the_period_before(AsRecorded recorded, const RigDescription& rig) {
  if (recorded.late.empty() || recorded.mode.empty() || recorded.late.front() == 0.0) return recorded;
  const auto prepend = [](std::vector<double>& column, double value) {
    if (!column.empty()) column.insert(column.begin(), value);
  };
  const auto repeat = [&](std::vector<double>& column) {
    if (!column.empty()) prepend(column, column.front());
  };
  const double period = rig.period(), late = recorded.late.front();
  const bool moved = late > control_settings(rig).limits.late_after * period;
  prepend(recorded.recording.time, recorded.recording.time.front() - period - (moved ? late : 0.0));
  prepend(recorded.late, 0.0);
  prepend(recorded.mode, static_cast<double>(Mode::idle));
  prepend(recorded.reason, 0.0);
  repeat(recorded.level);
  for (auto& age : recorded.age) repeat(age);
  for (auto& channel : recorded.recording.channels) repeat(channel);
  return recorded;
}

class ReplayDevices final : public Devices {
 public:
  ReplayDevices(const RigDescription& rig, const Options& options)
      : file_(options.replay),
        recorded_(with_the_period_before(read_csv_as_recorded(options.replay, rig.channels), rig)),
        rig_(played(rig), simulated_sensors(rig), rig.rig.has_fdva ? static_cast<std::size_t>(rig.rig.fdva.ducts) : 0,
             hal::Openings::from_bits(rig.controller.safe_ducts), {}) {}

  [[nodiscard]] hal::Rig roles() override { return rig_.roles(); }
  [[nodiscard]] std::string text() const override { return "REPLAY of " + file_ + ", no devices\n"; }
  [[nodiscard]] const ReplayedRun* replayed() const override { return &run_; }

 private:
  hal::replay::Recording played(const RigDescription& rig) {
    const Recording& recorded = recorded_.recording;
    // A late period is due when it begins; any other one began `late` after its instant.
    hal::Time before = hal::never;
    const hal::Time period = hal::seconds(rig.period());
    for (std::size_t k = 0; k < recorded.size(); ++k) {
      const hal::Time due = hal::seconds(recorded.time[k]);
      const bool moved = before != hal::never && due != before + period;
      times_.push_back(moved || recorded_.late.empty() ? due : due + hal::seconds(recorded_.late[k]));
      before = due;
    }
    gap_ = control_settings(rig).supervision.gap;
    hal::replay::Recording played;
    played.time = times_;
    played.stop_pressed = find_the_run();
    played.refusal = refusal_;
    played.suspended = suspended_;
    played.drive_enable = rig.hardware.gpio && !rig.hardware.gpio->enable.empty();
    if (interlock_.time != hal::never) {
      interlock_.interlock = interlock_of(file_, rig);
      played.interlocks_opened = {&interlock_, 1};
    }
    run_.levels = level_changes(recorded_.level, rig.period());
    const hal::SensorSetup setup = simulated_sensors(rig);
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      const std::vector<double>& values = recorded.channels[i];
      if (values.empty() || !setup[i].fitted) continue;
      const std::vector<double>& age = recorded_.age[i];
      for (std::size_t k = 0; k < values.size(); ++k) {
        const double old = !age.empty() ? age[k] : std::isnan(values[k]) ? values[k] : 0.0;
        taken_[i].push_back(std::isnan(old) ? hal::never : times_[k] - hal::seconds(old));
      }
      played.columns[i] = {values, taken_[i]};
    }
    if (const auto wrong = played.check(); !wrong.empty()) {
      throw InputError(file_, 0, "cannot be replayed", wrong);
    }
    return played;
  }

  /// What led the run, and when the stop button was pressed.
  hal::Time find_the_run() {
    run_.rows = run_.samples = times_.size();
    run_.with_the_way = !recorded_.mode.empty();
    if (!run_.with_the_way) return hal::never;
    run_.samples = 0;
    hal::Time pressed = hal::never;
    for (std::size_t k = 0; k < times_.size(); ++k) {
      const auto mode = static_cast<Mode>(std::clamp(recorded_.mode[k], 0.0, static_cast<double>(Mode::safe)));
      run_.modes.push_back(mode);
      run_.samples += in_run(mode) ? 1 : 0;
      const double reason = recorded_.reason.empty() ? 0.0 : recorded_.reason[k];
      const bool first = k == 0 || recorded_.reason.empty() || recorded_.reason[k - 1] != reason;
      if (!first) continue;
      const auto is = [reason](Reason wanted) { return reason == static_cast<double>(wanted); };
      if (is(Reason::stop_button) && pressed == hal::never) pressed = times_[k];
      if (is(Reason::interlock) && interlock_.time == hal::never) interlock_.time = times_[k];
      const bool in_time = recorded_.late.empty() || recorded_.late[k] <= gap_;
      if (is(Reason::gap) && in_time && suspended_ == hal::never) suspended_ = times_[k];
      if (is(Reason::stop_requested)) run_.stop_requested = k;
      using Output = hal::replay::Refusal::Output;
      for (const auto& [failed, output] :
           {std::pair(Reason::command_failed, Output::command), std::pair(Reason::valves_failed, Output::valves),
            std::pair(Reason::heartbeat_failed, Output::heartbeat), std::pair(Reason::enable_failed, Output::enable)}) {
        if (is(failed) && refusal_.from == hal::never) refusal_ = {times_[k], output};
      }
      if (reason != 0.0) run_.to_its_end = is(Reason::reference_ended);
    }
    return pressed;
  }

  std::string file_;
  AsRecorded recorded_;
  ReplayedRun run_;
  hal::replay::Opened interlock_{};
  hal::replay::Refusal refusal_{};
  hal::Time suspended_ = hal::never;
  double gap_ = 0.0;  ///< of the description [s]
  std::vector<hal::Time> times_;
  std::array<std::vector<hal::Time>, model::channel_count> taken_;
  hal::replay::Rig rig_;
};

}  // namespace

std::vector<LevelChange> level_changes(const std::vector<double>& level, double period) {
  constexpr double time = ReferencePlayer::change_time, widest = ReferencePlayer::highest_level;
  const auto periods_of = [period](double change) {
    return static_cast<std::size_t>(std::ceil(time * std::max(1.0, change) / period));
  };
  std::vector<LevelChange> changes;
  double before = 1.0;
  for (std::size_t k = 0; k < level.size(); ++k) {
    if (level[k] == before) continue;
    // Over n periods, s = j/n: L = L₀ + Δ(3s² − 2s³), n = T/h · max(1, |Δ|) rounded up (ReferencePlayer). The first row
    // gives Δ for each n, the second one tells which n it is; what was asked for is a whole number of millionths. Later
    // rows may be those of a reference that is held, where the change pauses.
    const auto share = [](double row, std::size_t n) {
      const double s = row / static_cast<double>(n);
      return s * s * (3.0 - 2.0 * s);
    };
    LevelChange change{k, std::round(1e6 * level[k]) / 1e6};  // before a run: at once
    bool smooth = false;
    for (std::size_t n = periods_of(1.0); n <= periods_of(widest) && !smooth; ++n) {
      const double wanted = std::round(1e6 * (before + (level[k] - before) / share(1.0, n))) / 1e6,
                   way = wanted - before;
      smooth = n == periods_of(std::abs(way)) && std::abs(before + way * share(1.0, n) - level[k]) <= 1e-12 &&
               (k + 1 == level.size() || std::abs(before + way * share(2.0, n) - level[k + 1]) <= 1e-10);
      if (smooth) change.level = wanted;
    }
    changes.push_back(change);
    // To the row that ends it; a run that ends leaves it unfinished.
    while (k + 1 < level.size() && level[k] != change.level) ++k;
    before = level[k];
  }
  return changes;
}

std::unique_ptr<Devices> replay_devices(const RigDescription& rig, const Options& options) {
  return std::make_unique<ReplayDevices>(rig, options);
}

}  // namespace firmware::controller
