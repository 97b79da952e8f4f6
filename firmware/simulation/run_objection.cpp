#include "firmware/simulation/run_objection.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/control_settings.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/loop/guards/command_guard.hpp"
#include "firmware/simulation/compensated_period.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {
namespace {

constexpr double millimetres_from = 20.0;  // times the stroke: 1 : 1000 between metres and millimetres lies far above
constexpr double tallest_road = 5.0;       // [m] within one run; class H rises by 2 m below 0.05 Hz
constexpr double step_from = 2.0;          // times a limit; below, the loop catches up within a few periods

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Holds the commands of a run against the limits, one after the other.
class LimitCheck {
 public:
  LimitCheck(const Settings& settings, double start)
      : settings_(settings),
        period_(settings.period.seconds()),
        wanted_(start),
        guard_(settings.limits, period_, start) {}

  /// The command of sample k; an objection, or none.
  MotionObjection judge(std::size_t k, const hal::Command& command) {
    const Limits& limits = settings_.limits;
    const std::string at = " at " + rounded(static_cast<double>(k) * period_) + " s";
    const double half_stroke = 0.5 * limits.stroke;
    const double speed = (command.position - wanted_) / period_;
    const double acceleration = (speed - wanted_speed_) / period_;
    wanted_ = command.position;
    wanted_speed_ = speed;
    if (!std::isfinite(command.position)) return {"the command is no number" + at, ""};
    if (std::abs(command.position) > half_stroke) {
      return {"the command reaches " + rounded(command.position) + " m" + at + ", limits.stroke leaves ± " +
                  rounded(half_stroke) + " m",
              "limits.stroke"};
    }
    if (std::abs(speed) > step_from * limits.speed) {
      return {"the command steps with " + rounded(speed) + " m/s" + at + ", limits.speed is " + rounded(limits.speed) +
                  " m/s",
              "limits.speed"};
    }
    if (std::abs(acceleration) > step_from * limits.highest_acceleration()) {
      return {"the command steps with " + rounded(acceleration) + " m/s²" + at + ", limits.acceleration is " +
                  rounded(limits.highest_acceleration()) + " m/s²" + (k <= 1 ? "; fade the run in from rest" : ""),
              "limits.acceleration"};
    }
    const CommandGuard::Verdict verdict = guard_.judge(command);
    if (verdict.hazard) {
      const std::string reason(name(verdict.hazard->reason));
      return {"the run would end by " + reason + at + " (" + rounded(verdict.hazard->value) + ", limit " +
                  rounded(verdict.hazard->limit) + ")",
              "limits." + reason};
    }
    guard_.passed(verdict.command);
    return {};
  }

 private:
  const Settings& settings_;
  double period_;
  double wanted_;              ///< by the last command, before the guard limits it [m]
  double wanted_speed_ = 0.0;  ///< [m/s]
  CommandGuard guard_;
};

/// In words where a position is a thousand times too large.
std::string millimetres(const FootPointMotion& motion, double most) {
  double reach = 0.0;
  for (const auto& m : motion) reach = std::max(reach, std::abs(m.position - motion.front().position));
  if (reach < most) return {};
  return "positions reach " + rounded(reach) + " m: a road in millimetres? Expected metres; ";
}

MotionObjection objection_to_commands(const Settings& settings, const FootPointMotion& motion) {
  const double start = std::clamp(motion.front().position, -0.5 * settings.limits.stroke, 0.5 * settings.limits.stroke);
  LimitCheck check(settings, start);  // ready has moved the command there, and stands still
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const auto& m = motion[k];
    if (const MotionObjection wrong = check.judge(k, {m.position, m.velocity, m.acceleration}); !wrong.empty()) {
      return {millimetres(motion, millimetres_from * settings.limits.stroke) + wrong.text, wrong.key};
    }
  }
  return {};
}

/// What a period of the loop gives: the command for its end, the component's force there.
struct LoopPeriod {
  model::Motion<double> command{};
  double force = 0.0;        ///< [N]
  MotionObjection excess{};  ///< more than a compensation may add
};

/// The loop of a hil rig: the whole rig stepped at once has the bits of car and machine joined by the loop.
class WholeRig {
 public:
  WholeRig(const RigDescription& description, double start)
      : model_(std::make_unique<Model>(description.rig, description.period())),
        state_(std::make_unique<Model::State>(model_->start(start))) {}

  LoopPeriod step(const model::Motion<double>& foot_point, model::OpenDucts open) {
    if (model_->parameters().has_fdva && open != state_->ducts.open()) model_->open_ducts(*state_, open);
    model_->step(*state_, {.foot_point = foot_point});
    const auto deflection = model_->deflection(*state_);
    const auto stroke = model_->component_stroke(deflection);
    const auto signals = model_->signals(*state_);
    const double acceleration =
        signals[model::index(model::Channel::zdd_w)] - signals[model::index(model::Channel::zdd_b)];
    return {{stroke.position, stroke.velocity, model_->component_acceleration(deflection, acceleration)},
            model_->suspension_force(*state_)};
  }

 private:
  using Model = model::RigModel<>;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Model::State> state_;
};

/// The same with a compensation between car and machine.
class CompensatedRig {
 public:
  CompensatedRig(const RigDescription& description, double start)
      : car_(description.rig, description.period(), model::ModelledPart::virtual_car),
        hardware_(std::make_unique<Model>(description.rig, description.period(), model::ModelledPart::test_machine)),
        state_(std::make_unique<Model::State>(hardware_->start(0.0))),
        area_(description.rig),
        compensation_(compensation_of(description)) {
    model::Column<double, 6> core;
    core << start, 0.0, start, 0.0, 0.0, 0.0;
    car_state_ = car_.start(core, {start, 0.0, 0.0}, {});
    compensation_->start(0.0);
  }

  LoopPeriod step(const model::Motion<double>& foot_point, model::OpenDucts open) {
    if (hardware_->parameters().has_fdva && open != state_->ducts.open()) hardware_->open_ducts(*state_, open);
    const auto [measured, answer] =
        step_compensated({car_, car_state_, *hardware_, *state_, area_, compensation_.get()}, foot_point,
                         std::popcount(static_cast<unsigned>(open)));
    LoopPeriod period{{answer.command.position, answer.command.velocity, answer.command.acceleration}, measured};
    if (answer.excess) {
      const bool of_force = answer.excess->of_force;
      period.excess = {"the compensation adds " + rounded(answer.excess->value) + (of_force ? " N" : " m"),
                       of_force ? "compensation.force_limit" : "compensation.limit"};
    }
    return period;
  }

 private:
  using Model = model::RigModel<>;
  model::VirtualCar<double> car_;
  model::VirtualCar<double>::State car_state_{};
  std::unique_ptr<Model> hardware_;
  std::unique_ptr<Model::State> state_;
  AreaControl<true> area_;
  std::unique_ptr<Compensation> compensation_;
};

template <class Rig>
MotionObjection objection_to_loop(const RigDescription& description, const Settings& settings,
                                  const FootPointMotion& motion) {
  Rig rig(description, motion.front().position);
  const ValvePlan valves = valve_plan(description);
  LimitCheck check(settings, 0.0);
  for (std::size_t k = 1; k < motion.size(); ++k) {
    const auto open = valves.at(settings.period * static_cast<std::int64_t>(k - 1)).bits();
    const LoopPeriod period = rig.step(motion[k], static_cast<model::OpenDucts>(open));
    const std::string at = " at " + rounded(static_cast<double>(k) * description.period()) + " s";
    MotionObjection wrong =
        check.judge(k, {period.command.position, period.command.velocity, period.command.acceleration});
    if (wrong.empty() && !period.excess.empty()) {
      wrong = {period.excess.text + at + ", more than [compensation] lets it", period.excess.key};
    }
    if (wrong.empty() && std::abs(period.force) > settings.limits.force) {
      wrong = {"the described component has " + rounded(period.force) + " N" + at + ", limits.force is " +
                   rounded(settings.limits.force) + " N",
               "limits.force"};
    }
    if (!wrong.empty()) {
      return {millimetres(motion, tallest_road) + "simulated over this road, " + wrong.text, wrong.key};
    }
  }
  return {};
}

}  // namespace

MotionObjection run_objection(const RigDescription& description, const FootPointMotion& excitation) {
  const Settings settings = control_settings(description);
  if (excitation.empty()) return {"the run has no sample", ""};
  for (std::size_t k = 0; k < excitation.size(); ++k) {
    const auto& m = excitation[k];
    if (!std::isfinite(m.position) || !std::isfinite(m.velocity) || !std::isfinite(m.acceleration)) {
      return {"the reference is no number at " + rounded(static_cast<double>(k) * description.period()) + " s", ""};
    }
  }
  if (description.rig.kind != model::RigKind::hil) return objection_to_commands(settings, excitation);
  return description.compensation ? objection_to_loop<CompensatedRig>(description, settings, excitation)
                                  : objection_to_loop<WholeRig>(description, settings, excitation);
}

MotionObjection limits_objection(const RigDescription& description) {
  const Settings settings = control_settings(description);
  const double shown = highest_measured_force(description);
  if (settings.limits.force >= shown) {
    return {"limits.force = " + rounded(settings.limits.force) +
                " N can never trip: [range] of the force sensor ends at " + rounded(shown) + " N; expected at most " +
                rounded(0.95 * shown) + " N, or a sensor that shows more",
            "limits.force"};
  }
  const auto position = trusted_range(
      description,
      model::index(description.rig.kind == model::RigKind::quarter_car ? model::Channel::z_r : model::Channel::x_act));
  const double half_measured = 0.5 * settings.limits.measured_stroke;
  if (half_measured > 0.0 && position && (half_measured >= position->upper || -half_measured <= position->lower)) {
    return {"limits.measured_stroke = " + rounded(settings.limits.measured_stroke) +
                " m can never trip: [range] of the position sensor is " + rounded(position->lower) + " … " +
                rounded(position->upper) + " m",
            "limits.measured_stroke"};
  }
  const auto& converters = description.hardware.converters;
  if (converters && converters->command) {
    const auto [low, high] = converters->command->ends();
    const double half_stroke = 0.5 * settings.limits.stroke;
    if (low > -half_stroke || high < half_stroke) {
      return {"[converters.command] puts out " + rounded(low) + " … " + rounded(high) +
                  " m, limits.stroke = " + rounded(settings.limits.stroke) + " m is wider; expected at most " +
                  rounded(2.0 * std::min(-low, high)) + " m",
              "limits.stroke"};
    }
  }
  if (converters && converters->area) {
    const auto [low, high] = converters->area->ends();
    const double stroke = description.rig.air_spring.actuator_stroke;
    if (low > -stroke || high < stroke) {
      return {"[converters.area] puts out " + rounded(low) + " … " + rounded(high) + ", air_spring.actuator_stroke = " +
                  rounded(stroke) + " is more; expected at most " + rounded(std::min(-low, high)),
              "air_spring.actuator_stroke"};
    }
  }
  return {};
}

MotionObjection following_objection(const RigDescription& description) {
  if (description.waivers.contains("no_following_error")) return {};
  const model::Channel channel =
      description.rig.kind == model::RigKind::quarter_car ? model::Channel::z_r : model::Channel::x_act;
  const std::size_t wanted = model::index(channel);
  const auto measures = [wanted](const auto& device) { return device.channel == wanted; };
  const HardwareDescription& hardware = description.hardware;
  if (hardware.converters &&
      std::any_of(hardware.converters->inputs.begin(), hardware.converters->inputs.end(), measures)) {
    return {};
  }
  if (std::any_of(hardware.lasers.begin(), hardware.lasers.end(), measures)) return {};
  return {"nothing measures " + std::string(model::name(channel)) +
              ": a drive that does not follow its command would not be noticed; fit a sensor, or say why not in "
              "[waivers] no_following_error",
          "converters"};
}

}  // namespace firmware
