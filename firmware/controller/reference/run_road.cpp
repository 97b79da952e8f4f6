#include "firmware/controller/reference/run_road.hpp"

#include <cmath>

#include "firmware/description/programme.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/reference/reference_player.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "firmware/simulation/run_objection.hpp"

namespace firmware::controller {
namespace {

constexpr std::size_t most_samples = 10'000'000;  // of all roads of a programme, in memory
// Higher levels are looked for in steps of a 32nd, where a look takes 2 s at most (1 µs a sample).
constexpr std::size_t most_looked_at = 2'000'000;
constexpr int level_halvings = 4;

FootPointMotion scaled_about_beginning(const FootPointMotion& motion, double level) {
  FootPointMotion scaled = motion;
  const double begin = motion.front().position;
  for (Motion& m : scaled) {
    m = {begin + level * (m.position - begin), level * m.velocity, level * m.acceleration};
  }
  return scaled;
}

}  // namespace

RunRoad::RunRoad(const Options& options, const RigDescription& rig, const ReplayedRun* replayed, bool operated)
    : highest_level_(ReferencePlayer::highest_level) {
  if (options.programme.empty()) {
    compute_road(options, rig, replayed);
  } else {
    compute_programme(options, rig);
  }
  if (replayed == nullptr) look(options, rig, operated);
}

Reference& RunRoad::reference() {
  if (programme_) return *programme_;
  return *cycles_;
}

void RunRoad::compute_road(const Options& options, const RigDescription& rig, const ReplayedRun* replayed) {
  const bool as_long = replayed != nullptr && replayed->to_its_end && options.cycles == 1;
  const std::size_t samples = as_long ? replayed->samples : samples_of(options.duration, rig.sample_rate);
  const RoadChoice road{options.road, options.speed, options.seed, options.bandwidth, options.cut_off};
  roads_.push_back(run_motion(road, rig, samples, read_csv_recording));
  const FootPointMotion& motion = roads_.front();
  const bool lacks_the_way = replayed != nullptr && !replayed->with_the_way && rig.rig.kind != model::RigKind::hil;
  if (lacks_the_way && !motion.empty() && motion.front().position != 0.0) {
    throw UsageError("--replay of a road that begins elsewhere than at 0: its recording lacks the way there");
  }
  cycles_ = std::make_unique<CycleReference>(motion, options.cycles, rig.period());
  if (options.cycles != 1) cycle_samples_ = cycles_->cycle_samples();
  text_ = options.road + ", seed " + std::to_string(options.seed);
}

void RunRoad::compute_programme(const Options& options, const RigDescription& rig) {
  const Programme programme = read_programme(options.programme);
  std::size_t total = 0;
  for (const ProgrammeBlock& block : programme.blocks) {
    const std::size_t samples = samples_of(block.duration, rig.sample_rate);
    const RoadChoice road{block.road, block.speed, block.seed, {}, {}};
    roads_.push_back(run_motion(road, rig, samples, read_csv_recording));
    total += roads_.back().size();
    if (roads_.back().empty() || total > most_samples) {
      throw InputError(programme.source, block.line,
                       "the roads of all blocks have " + std::to_string(total) + " samples",
                       "1 to 10000000; repetitions of a block do not count");
    }
  }
  for (std::size_t i = 0; i < roads_.size(); ++i) {
    const ProgrammeBlock& block = programme.blocks[i];
    blocks_.push_back({roads_[i], block.level, static_cast<std::uint64_t>(block.repetitions),
                       static_cast<std::uint64_t>(std::llround(block.pause * rig.sample_rate))});
  }
  programme_ = std::make_unique<ProgrammeReference>(blocks_, rig.period());
  text_ = "programme " + one_line(options.programme);
}

void RunRoad::look(const Options& options, const RigDescription& rig, bool operated) {
  FootPointMotion whole;
  const auto collect = [&whole](Reference& reference) {
    for (std::uint64_t k = 0; const auto there = reference.at(k); ++k) whole.push_back(*there);
  };
  if (programme_) {
    ProgrammeReference twice(blocks_, rig.period(), 2);
    collect(twice);
  } else {
    CycleReference twice(roads_.front(), options.cycles == 1 ? 1 : 2, rig.period());
    collect(twice);
  }
  if (const MotionObjection objection = run_objection(rig, whole); !objection.empty()) {
    throw InputError(programme_ ? options.programme : options.road, 0, objection.text,
                     "a run within the limits of " + place(rig, objection));
  }
  if (!operated) return;
  const auto fits = [&](double level) { return run_objection(rig, scaled_about_beginning(whole, level)).empty(); };
  if (fits(highest_level_)) return;
  double low = 1.0, high = highest_level_;
  for (int i = 0; i < level_halvings && whole.size() <= most_looked_at; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  highest_level_ = low;
}

}  // namespace firmware::controller
