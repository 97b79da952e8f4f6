#include "host_sim/fmu/stepped_run.hpp"

#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/control_loop.hpp"
#include "firmware/simulation/road_stream.hpp"
#include "firmware/simulation/simulated_setup.hpp"
#include "hal/simulated/rig.hpp"

namespace host_sim::fmu {

/// A road without end, or the motion that was given last.
class SteppedRun::Excitation final : public firmware::Reference {
 public:
  Excitation(const firmware::RigDescription& description, const std::optional<firmware::IsoRoad>& road,
             const firmware::Motion& begin)
      : outside_(begin) {
    if (!road) return;
    road_.emplace(*road, description.sample_rate);
    if (description.rig.kind == model::RigKind::component_bench) {
      deflection_.emplace(description.rig, description.sample_rate);
    }
  }

  void give(const firmware::Motion& motion) { outside_ = motion; }

 private:
  /// A run asks for sample 0 when it gets ready, then for each next one.
  std::optional<firmware::Motion> do_at(std::uint64_t sample) override {
    if (!road_) return outside_;
    if (sample < asked_) return newest_;
    ++asked_;
    newest_ = road_->next();
    if (deflection_) newest_ = deflection_->next(newest_);
    return newest_;
  }

  std::optional<firmware::RoadStream> road_{};
  std::optional<firmware::DeflectionStream> deflection_{};  ///< component_bench
  firmware::Motion outside_;
  firmware::Motion newest_{};
  std::uint64_t asked_ = 0;
};

/// Everything that changes during a run. All of it is inside, without heap, as the rooms of these parts promise: so its
/// bytes are its state, as long as they are put back to where they were.
struct SteppedRun::Parts {
  Parts(const firmware::RigDescription& description, const Options& options, const firmware::Motion& begin)
      : excitation(description, options.road, begin),
        plant(description, options.seed, options.noise),
        rig(plant, firmware::simulated_construction(description)),
        journal(storage),
        loop(firmware::control_settings(description), description.rig, rig.roles(), excitation,
             firmware::valve_plan(description), journal) {
    if (const auto settings = firmware::compensation_settings(description)) {
      loop.attach(compensator.emplace(*settings, description.period()));
    }
  }

  Excitation excitation;
  firmware::SimulatedRig plant;
  hal::simulated::Rig rig;
  firmware::JournalStorage<2> storage{};
  firmware::Journal journal;
  firmware::ControlLoop loop;
  std::optional<firmware::compensation::Compensator> compensator{};  ///< in place: its state is among the bytes
};

SteppedRun::SteppedRun(const firmware::RigDescription& description, const Options& options,
                       const firmware::Motion& begin)
    : outside_(!options.road) {
  const double period = description.period();
  if (const auto fault = firmware::find_rig_fault(description.rig, period)) {
    const std::string table(fault->table), key(fault->key);
    throw firmware::InputError(description.source, 0, table + (key.empty() ? "" : "." + key) + " does not fit",
                               fault->expected);
  }
  if (const std::string_view wrong = firmware::control_settings(description).check(); !wrong.empty()) {
    throw firmware::InputError(description.source, 0, "its control loop cannot run", wrong);
  }
  parts_ = std::make_unique<Parts>(description, options, begin);
  parts_->loop.arm();
  parts_->loop.start();
  do {
    if (outside_) keep(before_);
    carry_out_period();
  } while (row_.mode != firmware::Mode::running && parts_->loop.mode() != firmware::Mode::safe);
  begun_ = row_.mode == firmware::Mode::running;
  rows_ = begun_ ? 1 : 0;
  if (begun_ && outside_) put_back(before_);
}

SteppedRun::~SteppedRun() = default;

void SteppedRun::carry_out_period() {
  parts_->loop.run([first = true]() mutable { return std::exchange(first, false); });
  if (const auto record = parts_->journal.pop()) row_ = *record;
}

bool SteppedRun::advance(const firmware::Motion& excitation) {
  if (!begun_) return false;
  if (outside_) {
    const firmware::Record shown = row_;
    parts_->excitation.give(excitation);
    carry_out_period();
    row_ = shown;
  }
  if (parts_->loop.mode() == firmware::Mode::safe) return false;
  if (outside_) keep(before_);
  carry_out_period();
  if (outside_) put_back(before_);
  ++rows_;
  return true;
}

firmware::Trip SteppedRun::trip() const { return parts_->loop.trip(); }

void SteppedRun::keep(std::vector<std::byte>& bytes) const {
  bytes.resize(sizeof(Parts));
  std::memcpy(bytes.data(), static_cast<const void*>(parts_.get()), sizeof(Parts));
}

void SteppedRun::put_back(const std::vector<std::byte>& bytes) {
  std::memcpy(static_cast<void*>(parts_.get()), bytes.data(), sizeof(Parts));
}

SteppedRun::Saved SteppedRun::save() const {
  Saved saved;
  save(saved);
  return saved;
}

void SteppedRun::save(Saved& saved) const {
  keep(saved.parts);
  saved.rows = rows_;
  saved.row = row_;
}

void SteppedRun::restore(const Saved& saved) {
  put_back(saved.parts);
  rows_ = saved.rows;
  row_ = saved.row;
}

}  // namespace host_sim::fmu
