#include "firmware/controller/replay_devices.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/description/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/replay/rig.hpp"

namespace firmware::controller {
namespace {

class ReplayDevices final : public Devices {
 public:
  ReplayDevices(const RigDescription& rig, const Options& options)
      : file_(options.replay),
        recorded_(read_csv_as_recorded(options.replay, rig.channels)),
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
    hal::replay::Recording played;
    played.time = times_;
    played.stop_pressed = find_the_run();
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
      if (is(Reason::stop_requested)) run_.stop_requested = k;
      if (reason != 0.0) run_.to_its_end = is(Reason::reference_ended);
    }
    return pressed;
  }

  std::string file_;
  AsRecorded recorded_;
  ReplayedRun run_;
  std::vector<hal::Time> times_;
  std::array<std::vector<hal::Time>, model::channel_count> taken_;
  hal::replay::Rig rig_;
};

}  // namespace

std::unique_ptr<Devices> replay_devices(const RigDescription& rig, const Options& options) {
  return std::make_unique<ReplayDevices>(rig, options);
}

}  // namespace firmware::controller
