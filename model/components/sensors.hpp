// Turns true values into sensor readings.
#pragma once

#include <array>
#include <cstddef>

#include "model/components/channel.hpp"
#include "model/components/subsystems.hpp"
#include "model/numerics/delay_line.hpp"
#include "model/numerics/exact_discretisation.hpp"

namespace model {

/// Value of every channel at one instant [SI]; 0 for channels that the rig does not have.
template <class S>
using Signals = std::array<S, channel_count>;

/// Number of channels that may have a delay of their own, and its longest [samples].
inline constexpr std::size_t delayed_sensors = 2;
inline constexpr std::size_t sensor_delay_capacity = 256;

/// One channel's sensor:
///
///   (1)  u = g · true + o + noise                     gain, offset
///   (2)  T ẏ₁ + y₁ = u                                lag, exact for u on the cubic through its newest samples
///   (3)  y₂(t) = y₁(t − τ)                            delay
///   (4)  y₃ = clamp(y₂, ± l)                          limit
///   (5)  y(t) = y₃(t_r)                               hold: renewed at the first sample and then every period
///
/// A channel without effect costs nothing. (2), (3) and (5) keep state and are stepped once a sample.
template <class S>
class Sensors {
 public:
  using Line = DelayLine<S, sensor_delay_capacity, S>;

  struct ChannelState {
    std::array<S, 3> input{};  ///< u of the last three samples, the newest first
    S lagged{};                ///< y₁
    S held{};                  ///< y
    S age{};                   ///< since the renewal [s]
  };
  struct State {
    std::array<ChannelState, channel_count> channels{};
    std::array<Line, delayed_sensors> lines{};
  };

  Sensors() = default;
  Sensors(const std::array<SensorPath<S>, channel_count>& paths, S period) : paths_(paths), period_(period) {
    for (std::size_t c = 0; c < channel_count; ++c) {
      const SensorPath<S>& p = paths[c];
      if (p.gain != S(1) || p.offset != S(0) || p.limit > S(0) || p.lag > S(0) || p.delay > S(0) || p.hold > S(0)) {
        list_[count_++] = c;
        listed_[c] = true;
      }
      if (p.lag > S(0)) {
        const ExactDiscretisation<S, 1> exact(Block<S, 1, 1>(S(-1) / p.lag), period);
        const Block<S, 1, 4> input = exact.through_newest(Column<S, 1>(S(1) / p.lag));
        lag_[c] = {exact.transition()(0), input(0), input(1), input(2), input(3)};
      }
      if (p.delay > S(0)) line_[c] = lines_++;
    }
  }

  [[nodiscard]] bool any() const { return count_ > 0; }

  /// As if the signals had always been as they are.
  void start(State& x, const Signals<S>& truth, const Signals<S>* noise) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t c = list_[i];
      ChannelState& s = x.channels[c];
      s.lagged = input(c, truth[c], noise);
      s.input.fill(s.lagged);
      if (paths_[c].delay > S(0)) x.lines[line_[c]].start(s.lagged, paths_[c].delay / period_);
      s.held = limited(c, s.lagged);
      s.age = S(0);
    }
  }

  /// One sample on.
  void step(State& x, const Signals<S>& truth, const Signals<S>* noise) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t c = list_[i];
      const SensorPath<S>& p = paths_[c];
      ChannelState& s = x.channels[c];
      const S u = input(c, truth[c], noise);
      s.lagged = p.lag > S(0) ? follow(lag_[c], s, u) : u;
      s.input = {u, s.input[0], s.input[1]};
      S value = s.lagged;
      if (p.delay > S(0)) {
        Line& line = x.lines[line_[c]];
        line.push(value);
        value = line.read(period_);
      }
      value = limited(c, value);
      s.age += period_;
      if (s.age >= p.hold * (S(1) - S(1e-9))) {
        s.held = value;
        s.age = p.hold > S(0) ? s.age - p.hold : S(0);
      }
    }
  }

  /// The reading of one channel at the instant that was stepped to; `otherwise` when its sensor has no effect.
  [[nodiscard]] S reading(const State& x, Channel channel, S otherwise) const {
    return listed_[index(channel)] ? x.channels[index(channel)].held : otherwise;
  }

  /// Sets everything below `least` to zero.
  void flush(State& x, S least) const {
    for (std::size_t i = 0; i < count_; ++i) {
      ChannelState& s = x.channels[list_[i]];
      for (S* value : {&s.input[0], &s.input[1], &s.input[2], &s.lagged, &s.held}) {
        if (*value<least&& * value> - least) *value = S(0);
      }
    }
  }

  /// The readings at the instant that was stepped to.
  void read(const State& x, Signals<S>& readings) const {
    for (std::size_t i = 0; i < count_; ++i) readings[list_[i]] = x.channels[list_[i]].held;
  }

 private:
  using Lag = std::array<S, 5>;  ///< of y₁, u and the three u before
  [[nodiscard]] static S follow(const Lag& lag, const ChannelState& s, S u) {
    return lag[0] * s.lagged + lag[1] * u + lag[2] * s.input[0] + lag[3] * s.input[1] + lag[4] * s.input[2];
  }
  [[nodiscard]] S input(std::size_t c, S truth, const Signals<S>* noise) const {
    const S u = paths_[c].gain * truth + paths_[c].offset;
    return noise != nullptr ? u + (*noise)[c] : u;
  }
  [[nodiscard]] S limited(std::size_t c, S value) const {
    const S limit = paths_[c].limit;
    if (!(limit > S(0))) return value;
    return value > limit ? limit : (value < -limit ? -limit : value);
  }

  std::array<SensorPath<S>, channel_count> paths_{};
  S period_{1};
  std::array<Lag, channel_count> lag_{};
  std::array<std::size_t, channel_count> line_{};
  std::array<std::size_t, channel_count> list_{};
  std::array<bool, channel_count> listed_{};
  std::size_t count_ = 0;
  std::size_t lines_ = 0;
};

}  // namespace model
