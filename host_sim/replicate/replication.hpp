// A replication: target, model, drives and runs of one folder.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/comparison/comparison.hpp"
#include "host_sim/replicate/correction.hpp"
#include "host_sim/replicate/damage.hpp"
#include "host_sim/replicate/run_record.hpp"
#include "host_sim/replicate/solve.hpp"

namespace host_sim::replicate {

inline constexpr std::array<int, 3> damage_exponents{3, 5, 8};

/// What a run came to.
struct RunResult {
  std::vector<double>
      error;  ///< rms(target − reached) / rms(target) in the band, by channel; NaN: lost, or not run yet
  std::vector<double> predicted;              ///< by the model, before the run
  std::vector<std::array<double, 3>> damage;  ///< reached ÷ target, for damage_exponents
  LimitsUsed used;
  std::vector<double> unlimited;     ///< predicted without limits; empty: no limit was in the way
  std::vector<std::string> remarks;  ///< what was refined, named, lost, taken back
  double noise_of_run = 0.0;
};

/// Why no further run is worth it.
enum class Stop : unsigned char { none, goal, noise, limits, unreachable, model };
[[nodiscard]] std::string_view name(Stop stop);

/// What is left at the end, by channel.
struct Floor {
  std::vector<double> total, noise, predicted;
};

/// Where the error is largest.
struct WorstBand {
  model::Channel channel{};
  FrequencyBand band{};
};

/// The state of a folder, made of its files alone:
///
///   rig.toml       the rig as described        target_1.csv …   events
///   drive_N.csv    drives                      run_N.csv        what the rig answered
///   rig_N.toml     the model after run N       replicate.json   settings, results
class Replication {
 public:
  using Progress = std::function<void(double share, const std::string& what)>;

  /// A new one. `recordings`: the events.
  Replication(firmware::RigDescription description, const TargetRequest& request,
              std::vector<firmware::Recording> recordings, double goal);

  /// Makes the next drive.
  void solve(const Progress& progress = {});
  void sign_newest(std::string sha256) { drives_.back().sha256 = std::move(sha256); }
  /// Takes a run of the newest drive and judges it.
  void take(const firmware::Recording& recording);
  /// Fits the tolerated parameters to the newest run, where that explains more of it.
  void refine();
  /// The same on an earlier run of the rig, of any command and perhaps begun in mid-motion, before the first drive.
  void refine_on(firmware::Recording run) { refine_on(std::move(run), StartChoice::automatic); }
  /// Takes a model that somebody else refined, with words on what was found.
  void refine(firmware::RigDescription refined, const std::string& found);

  [[nodiscard]] const firmware::RigDescription& description() const { return description_; }  ///< as given
  [[nodiscard]] const firmware::RigDescription& refined() const { return refined_; }          ///< the present model
  [[nodiscard]] const Target& target() const { return target_; }
  [[nodiscard]] const std::vector<firmware::Recording>& recordings() const { return recordings_; }
  [[nodiscard]] const std::vector<Drive>& drives() const { return drives_; }
  [[nodiscard]] const std::vector<RunResult>& results() const { return results_; }
  [[nodiscard]] const std::vector<RunRecord>& runs() const { return runs_; }
  [[nodiscard]] const std::vector<firmware::Recording>& run_recordings() const { return run_recordings_; }
  [[nodiscard]] const BandInverse& inverse() const { return *inverse_; }
  [[nodiscard]] const DriveModel::Answer& predicted() const { return predicted_; }  ///< for the newest drive
  [[nodiscard]] double goal() const { return goal_; }
  [[nodiscard]] std::size_t best() const;  ///< of the runs, by error; size() without one
  [[nodiscard]] Stop stop() const;
  [[nodiscard]] Floor floor() const;
  [[nodiscard]] WorstBand worst_band() const;
  /// Weighted mean of a run's errors.
  [[nodiscard]] double error_of(const RunResult& result) const;

  /// A channel of a recording of drive `run`, in its band, over the events.
  [[nodiscard]] std::vector<double> in_band(std::size_t channel, const std::vector<double>& signal) const;

  /// For a folder that is read again.
  void restore(std::vector<Drive> drives, std::vector<RunResult> results, std::vector<firmware::Recording> runs,
               std::optional<firmware::RigDescription> refined);

 private:
  void prepare_model();
  void refine_on(firmware::Recording run, StartChoice choice);
  void judge(const RunRecord& run, RunResult& result) const;

  firmware::RigDescription description_, refined_;
  Target target_;
  std::vector<firmware::Recording> recordings_;
  double goal_;
  std::optional<DriveModel> model_;
  std::optional<BandInverse> inverse_;
  DriveLimits limits_{};
  std::vector<Drive> drives_;
  std::vector<RunResult> results_;
  std::vector<RunRecord> runs_;
  std::vector<firmware::Recording> run_recordings_;
  DriveModel::Answer predicted_;
  std::vector<double> noise_;
  std::vector<std::string> remarks_;  ///< for the next result
};

/// A drive as a recording with the one column that the rig is commanded.
[[nodiscard]] firmware::Recording drive_recording(const Replication& replication, std::size_t drive);

/// replicate.json; contract.
[[nodiscard]] nlohmann::ordered_json to_json(const Replication& replication);

}  // namespace host_sim::replicate
