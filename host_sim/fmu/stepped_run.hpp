// A simulated run that somebody else leads from period to period.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/journal.hpp"
#include "firmware/loop/reference/reference.hpp"
#include "firmware/simulation/road.hpp"
#include "firmware/simulation/simulated_rig.hpp"

namespace host_sim::fmu {

/// The closed loop of run_closed_loop(), row after row: the rows are those of `rigtwin simulate`, bit for bit.
///
/// The excitation is an ISO 8608 road, generated sample by sample without end, or comes from outside.
///
/// Row k of a run needs the excitation at t_k and before; the period that follows it needs the excitation at t_{k+1}. A
/// road is known, so the period is carried out at once. From outside the excitation at t_{k+1} comes later, so the
/// period is carried out on trial to see the row, and taken back.
class SteppedRun {
 public:
  struct Options {
    std::optional<firmware::IsoRoad> road{};  ///< nullopt: the excitation comes from outside
    std::uint64_t seed = 1;                   ///< of the sensor noise
    firmware::SimulatedRig::Noise noise = firmware::SimulatedRig::Noise::as_described;
  };

  /// Goes to the first row of the run, as `rigtwin simulate` does: arming, start, the move to where the excitation
  /// begins. InputError for a rig that cannot be simulated.
  SteppedRun(const firmware::RigDescription& description, const Options& options, const firmware::Motion& begin);
  ~SteppedRun();
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;

  /// To the next row. `excitation`: at its instant, used if it comes from outside. False: the firmware has ended the
  /// run with the row before, or has not even begun it.
  [[nodiscard]] bool advance(const firmware::Motion& excitation);

  [[nodiscard]] bool begun() const { return begun_; }                 ///< there is a row
  [[nodiscard]] std::uint64_t rows() const { return rows_; }          ///< k + 1 of row()
  [[nodiscard]] const firmware::Record& row() const { return row_; }  ///< the newest
  [[nodiscard]] firmware::Trip trip() const;                          ///< why it ended; Reason::none: it runs

  /// Everything that changes. It can be restored in the run that it was saved from only.
  struct Saved {
    std::vector<std::byte> parts{};
    std::uint64_t rows = 0;
    firmware::Record row{};
  };
  [[nodiscard]] Saved save() const;
  void save(Saved& saved) const;  ///< into the memory that it has
  void restore(const Saved& saved);

 private:
  class Excitation;
  struct Parts;

  /// The bytes of parts_, and back.
  void keep(std::vector<std::byte>& bytes) const;
  void put_back(const std::vector<std::byte>& bytes);
  void carry_out_period();  ///< row_ is the row that it began with

  bool outside_;
  std::unique_ptr<Parts> parts_;
  std::vector<std::byte> before_{};  ///< a period on trial
  bool begun_ = false;
  std::uint64_t rows_ = 0;
  firmware::Record row_{};
};

}  // namespace host_sim::fmu
