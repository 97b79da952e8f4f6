// What the control program did, for whoever reads along.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/loop/common/mode.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/estimator/state_estimator.hpp"
#include "hal/command_output.hpp"
#include "hal/time.hpp"
#include "hal/valve_bank.hpp"
#include "model/components/channel.hpp"
#include "model/numerics/require.hpp"

namespace firmware {

/// What has not gone as it should, counted since construction.
struct Counters {
  std::uint64_t late_periods = 0;
  std::uint64_t missed_frames = 0;     ///< periods without any sample
  std::uint64_t bridged_samples = 0;   ///< bad samples, over all channels
  std::uint64_t limited_commands = 0;  ///< commands slowed down to the speed limit
  std::uint64_t failed_commands = 0;   ///< commands that the drive did not take
  std::uint64_t failed_valves = 0;     ///< openings that the valves did not take
  std::uint64_t failed_beats = 0;      ///< beats that did not reach the watchdog
  std::uint64_t failed_enables = 0;    ///< times that the drive's enable could not be written

  friend bool operator==(const Counters&, const Counters&) = default;
};

/// What a compensation of the machine's delay added to this instant. A program without room for one records none.
struct AddedRecord {
#ifdef RIGTWIN_ALONE
  static constexpr void set(double /*command*/, double /*force*/) {}
#else
  double command = 0.0;  ///< x_cmd less the deflection of the car [m]
  double force = 0.0;    ///< force that enters the car less the measured one, both as far as they are faded in [N]
  void set(double added_command, double added_force) {
    command = added_command;
    force = added_force;
  }
#endif
};

/// One period.
struct Record {
  std::uint64_t period = 0;      ///< since construction; a gap in this count is what the journal lost
  std::uint64_t sample = 0;      ///< k since running began, in modes running and holding
  hal::Time time{};              ///< of this instant, t_k
  hal::Time due{};               ///< when it should have begun; a late period is due when it begins
  hal::Time late{};              ///< how long after its instant it began, of a late period too
  Mode mode = Mode::idle;        ///< that this instant belongs to; the period that trips still belongs to the run
  Trip trip{};                   ///< why the rig is or was in safe; nothing before, and again from the next arming on
  Reason second = Reason::none;  ///< what happened after that, on the way to rest or at rest, first
  bool enabled = false;          ///< the drive had power from this period on
  std::uint16_t bridged = 0;     ///< bit i: channel i was bad and bridged

  /// Every channel at t_k [SI]. Measured channels as they were read (NaN: none read). In `hil` the others are the
  /// virtual car's; x_cmd is the command for t_k. NaN: neither measured nor computed.
  std::array<double, model::channel_count> values{};
  std::array<hal::Time, model::channel_count> taken{};  ///< stamps of the measured channels, else `never`

  double level = 1.0;         ///< factor on the reference
  double tare = 0.0;          ///< taken from F as it was read, for the car and the limits [N]
  double wheel_load = 0.0;    ///< soft sensor F_w,c [N]
  double energy_fed = 0.0;    ///< hil: W of the energy guard [J]
  double energy_taken = 0.0;  ///< hil: D of the energy guard [J]
  Velocities velocities{};    ///< estimated; in `hil` the virtual car's
  hal::Command command{};     ///< put out in this period, for t_{k+1}
  hal::Openings openings{};   ///< put out in this period, in force from t_k to t_{k+1}
  Counters counters{};
  [[no_unique_address]] AddedRecord added{};
};

/// A ring of records between the loop and one reader in another thread: neither ever waits for the other.
///
/// Single producer, single consumer, lock-free. A record that finds the ring full is lost and counted. Storage is the
/// caller's; it holds as many records as it has places.
class Journal {
 public:
  explicit Journal(std::span<Record> storage) : storage_(storage) {
    model::require(!storage.empty(), "a journal has room for a record");
    static_assert(std::atomic<std::size_t>::is_always_lock_free, "the loop must never wait for the reader");
  }

  /// From the loop only. False: lost.
  bool push(const Record& record) {
    const std::size_t written = written_.load(std::memory_order_relaxed);
    if (written - read_.load(std::memory_order_acquire) == storage_.size()) {
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return false;
    }
    storage_[write_place_] = record;
    write_place_ = write_place_ + 1 == storage_.size() ? 0 : write_place_ + 1;
    written_.store(written + 1, std::memory_order_release);
    return true;
  }

  /// From the loop only: where the next record will lie.
  [[nodiscard]] const Record& next() const { return storage_[write_place_]; }

  /// From the reader only: the oldest record not yet read.
  [[nodiscard]] std::optional<Record> pop() {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    if (written_.load(std::memory_order_acquire) == read) return std::nullopt;
    const Record record = storage_[read_place_];
    read_place_ = read_place_ + 1 == storage_.size() ? 0 : read_place_ + 1;
    read_.store(read + 1, std::memory_order_release);
    return record;
  }

  [[nodiscard]] std::size_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::span<Record> storage_;
  std::size_t write_place_ = 0;  ///< of the producer
  std::size_t read_place_ = 0;   ///< of the consumer
  std::atomic<std::size_t> written_{0};
  std::atomic<std::size_t> read_{0};
  std::atomic<std::size_t> lost_{0};
};

/// The storage of a journal as an object of its own, for main or a static.
template <std::size_t Capacity>
using JournalStorage = std::array<Record, Capacity>;

}  // namespace firmware
