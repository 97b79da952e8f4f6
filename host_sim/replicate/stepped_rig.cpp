#include "host_sim/replicate/stepped_rig.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "model/components/subsystems.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim::replicate {
namespace {

using model::Channel;
using model::CoreIndex;
using model::RigKind;
using SteppedParameters = model::RigParameters<double>;

constexpr std::size_t no_delay = 8;  ///< [samples] capacity of a line that delays nothing

/// Half widths of the differences. They are small against what moves a corner and large against rounding.
constexpr double of_position = 1e-7;      // [m]
constexpr double of_velocity = 1e-5;      // [m/s]
constexpr double of_acceleration = 1e-2;  // [m/s²]
constexpr double of_force = 1e-2;         // [N]
constexpr double of_losses = 1e-9;        // [m⁶/s²]

SteppedParameters without_delay_and_sensors(SteppedParameters rig) {
  rig.delay_variation = {};
  rig.effects.for_each([](auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if constexpr (requires { &Effect::delay; }) {
      if (Effect::card.subsystem == model::Subsystem::machine) slot.active = false;
    }
  });
  rig.effects.for_each_sensor([](auto& slot, Channel) { slot.active = false; });
  return rig;
}

template <class Model>
class SteppedModel final : public SteppedRig {
 public:
  using State = typename Model::State;

  SteppedModel(typename Model::Rig rig, double period, std::vector<Channel> channels)
      : model_(rig, period), period_(period), channels_(std::move(channels)) {
    rig.effects.act_on(machine_);
    list_entries();
    start();
  }

  void start() override {
    x_ = model_.start();
    drive_ = {};
  }
  void step(double acceleration) override {
    const DrivePoint next = moved(drive_, acceleration, period_);
    advance(x_, next, acceleration);
    drive_ = next;
  }
  void read(double* channels) const override { read(x_, channels); }
  void state(double* x) const override { gather(x_, drive_, x); }
  [[nodiscard]] DrivePoint drive() const override { return drive_; }

  void keep(std::size_t slot) override {
    if (kept_.size() <= slot) kept_.resize(slot + 1);
    kept_[slot] = {x_, drive_};
  }
  void return_to(std::size_t slot) override {
    x_ = kept_[slot].first;
    drive_ = kept_[slot].second;
  }

  void derive(double acceleration, LinearStep& out) override {
    const std::size_t n = states(), m = channels_.size();
    out.a.resize(n * n);
    out.b.resize(n);
    out.c.resize(m * n);
    out.d.resize(m);
    std::vector<double>& side = work_;
    side.resize(2 * (n + m));
    double* const up = side.data();
    double* const down = up + n + m;
    for (std::size_t j = 0; j <= n; ++j) {
      const double half = half_width(j);
      for (const bool upwards : {true, false}) {
        const double by = upwards ? half : -half;
        State x = x_;
        DrivePoint drive = drive_;
        double w = acceleration;
        if (j + 2 < n) {
          for (const auto& [place, factor] : entries_[j].places) *place(x) += factor * by;
        } else if (j + 2 == n) {
          drive.position += by;
          for (const auto& [place, factor] : position_.places) *place(x) += factor * by;
        } else if (j + 1 == n) {
          drive.velocity += by;
          for (const auto& [place, factor] : velocity_.places) *place(x) += factor * by;
        } else {
          w += by;
        }
        const DrivePoint next = moved(drive, w, period_);
        advance(x, next, w);
        double* const to = upwards ? up : down;
        gather(x, next, to);
        read(x, to + n);
      }
      for (std::size_t i = 0; i < n + m; ++i) {
        const double slope = (up[i] - down[i]) / (2.0 * half);
        if (j == n) {
          (i < n ? out.b[i] : out.d[i - n]) = slope;
        } else {
          (i < n ? out.a[i * n + j] : out.c[(i - n) * n + j]) = slope;
        }
      }
    }
  }

  void drop(const std::vector<bool>& unused) override {
    std::vector<Entry> used;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (!unused[i]) used.push_back(std::move(entries_[i]));
    }
    entries_ = std::move(used);
  }

  [[nodiscard]] std::size_t states() const override { return entries_.size() + 2; }
  [[nodiscard]] std::size_t channels() const override { return channels_.size(); }

 private:
  using Place = double* (*)(State&);
  /// One entry of x: what moves together, and by how much.
  struct Entry {
    double half;
    std::vector<std::pair<Place, double>> places;
  };

  [[nodiscard]] double half_width(std::size_t j) const {
    const std::size_t n = states();
    if (j == n) return of_acceleration;
    if (j + 2 < n) return entries_[j].half;
    return j + 2 == n ? of_position : of_velocity;
  }

  void advance(State& x, const DrivePoint& next, double acceleration) const {
    typename Model::Input input;
    input.foot_point = {next.position, next.velocity, acceleration};
    input.command = {next.position, next.velocity};
    model_.step(x, input);
  }

  void read(const State& x, double* channels) const {
    const auto signals = model_.signals(x);
    for (std::size_t c = 0; c < channels_.size(); ++c) channels[c] = signals[index(channels_[c])];
  }

  void gather(const State& x, const DrivePoint& drive, double* to) const {
    auto& source = const_cast<State&>(x);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    for (std::size_t i = 0; i < entries_.size(); ++i) to[i] = *entries_[i].places.front().first(source);
    to[entries_.size()] = drive.position;
    to[entries_.size() + 1] = drive.velocity;
  }

  template <int i>
  static double* core(State& x) {
    return &x.core(i);
  }
  template <int i>
  static double* machine(State& x) {
    return &x.machine(i);
  }

  static model::Recent<double>& losses(State& x) {
    return const_cast<model::Recent<double>&>(x.ducts.losses());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  }

  void list_entries() {
    constexpr Place foot_p = [](State& x) { return &x.foot_point.position; };
    constexpr Place foot_v = [](State& x) { return &x.foot_point.velocity; };
    constexpr Place reached_p = [](State& x) { return &x.reached.position; };
    constexpr Place reached_v = [](State& x) { return &x.reached.velocity; };
    const std::vector<std::pair<Place, double>> motion{{foot_p, 1.0}, {reached_p, 1.0}},
        rate{{foot_v, 1.0}, {reached_v, 1.0}};
    using Machine = model::Machine<double>;
    entries_ = {{of_position, {{&core<CoreIndex::wheel_position>, 1.0}}},
                {of_velocity, {{&core<CoreIndex::wheel_velocity>, 1.0}}},
                {of_position, {{&core<CoreIndex::body_position>, 1.0}}},
                {of_velocity, {{&core<CoreIndex::body_velocity>, 1.0}}},
                {of_position, {{&core<CoreIndex::piston_travel>, 1.0}}},
                {of_velocity, {{&core<CoreIndex::piston_velocity>, 1.0}}},
                {of_position, {{&core<CoreIndex::relaxed_deflection>, 1.0}}},
                {of_position, {{&core<CoreIndex::inner_deflection>, 1.0}}}};
    position_ = {of_position, {{[](State& x) { return &x.delayed.position; }, 1.0}}};
    velocity_ = {of_velocity, {{[](State& x) { return &x.delayed.velocity; }, 1.0}}};
    const bool lag = machine_.lag > 0.0, resonance = machine_.resonance_frequency > 0.0,
               limited = machine_.rate_limit > 0.0;
    // What is reached follows from the machine's own states, but for a limit of speed.
    Entry lagged{of_position, {{&machine<Machine::lagged>, 1.0}}},
        position{of_position, {{&machine<Machine::position>, 1.0}}},
        velocity{of_velocity, {{&machine<Machine::velocity>, 1.0}}};
    const auto moves = [](Entry& entry, const auto& places, double factor) {
      for (const auto& [place, share] : places) entry.places.emplace_back(place, factor * share);
    };
    if (limited) {
      entries_.push_back({of_position, motion});
      entries_.push_back({of_velocity, rate});
    } else if (resonance) {
      moves(position, motion, 1.0);
      moves(velocity, rate, 1.0);
    } else if (lag) {
      moves(lagged, motion, 1.0);
      moves(lagged, rate, -1.0 / machine_.lag);
      moves(position_, rate, 1.0 / machine_.lag);
    } else {
      moves(position_, motion, 1.0);
      moves(velocity_, rate, 1.0);
    }
    if (lag) entries_.push_back(std::move(lagged));
    if (resonance) {
      entries_.push_back(std::move(position));
      entries_.push_back(std::move(velocity));
    }
    // A load of the last steps, moved as a whole: the step extrapolates it.
    entries_.push_back({of_force,
                        {{[](State& x) { return &x.suspension_load.now; }, 1.0},
                         {[](State& x) { return &x.suspension_load.before; }, 1.0},
                         {[](State& x) { return &x.suspension_load.earlier; }, 1.0}}});
    entries_.push_back({of_force,
                        {{[](State& x) { return &x.tyre_load.now; }, 1.0},
                         {[](State& x) { return &x.tyre_load.before; }, 1.0},
                         {[](State& x) { return &x.tyre_load.earlier; }, 1.0}}});
    entries_.push_back({of_position,
                        {{[](State& x) { return &x.free_play.now; }, 1.0},
                         {[](State& x) { return &x.free_play.before; }, 1.0},
                         {[](State& x) { return &x.free_play.earlier; }, 1.0}}});
    entries_.push_back({of_velocity,
                        {{[](State& x) { return &x.free_play_rate.now; }, 1.0},
                         {[](State& x) { return &x.free_play_rate.before; }, 1.0},
                         {[](State& x) { return &x.free_play_rate.earlier; }, 1.0}}});
    entries_.push_back({of_losses,
                        {{[](State& x) { return &losses(x).now; }, 1.0},
                         {[](State& x) { return &losses(x).before; }, 1.0},
                         {[](State& x) { return &losses(x).earlier; }, 1.0},
                         {[](State& x) { return &losses(x).earliest; }, 1.0}}});
  }

  Model model_;
  double period_;
  std::vector<Channel> channels_;
  model::MachinePath<double> machine_{};
  std::vector<Entry> entries_;
  Entry position_{}, velocity_{};
  State x_{};
  DrivePoint drive_{};
  std::vector<std::pair<State, DrivePoint>> kept_;
  std::vector<double> work_;
};

}  // namespace

DrivePoint moved(const DrivePoint& from, double acceleration, double period) {
  return {from.position + period * (from.velocity + 0.5 * period * acceleration),
          from.velocity + period * acceleration};
}

std::unique_ptr<SteppedRig> stepped_rig(const SteppedParameters& rig, double period,
                                        const std::vector<Channel>& channels) {
  const SteppedParameters bare = without_delay_and_sensors(rig);
  if (rig.laws.any() || rig.has_extensions()) {
    return std::make_unique<SteppedModel<model::RigModel<>>>(bare, period, channels);
  }
  using Plain = model::RigModel<double, no_delay, model::ModelVariant::every_part, model::no_laws>;
  return std::make_unique<SteppedModel<Plain>>(model::without_laws(bare), period, channels);
}

double machine_delay(const SteppedParameters& rig) {
  model::MachinePath<double> path{};
  rig.effects.act_on(path);
  return path.delay;
}

}  // namespace host_sim::replicate
