// The Kalman filter reaches the bounds of theory, on cars simulated without it, and fuses what comes late or not at
// all.
#include "firmware/loop/kalman/kalman_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <string>

#include "firmware/loop/kalman/steady_gains.hpp"
#include "model/components/road_filter.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/firmware/loop/kalman/linear_car.hpp"
#include "tests/support/without_heap.hpp"

namespace {

using firmware::EstimatorEquations;
using firmware::EstimatorVector;
using firmware::KalmanFilter;
using firmware::KalmanSettings;
using firmware::SteadyGains;
using model::Channel;
using model::CoreIndex;
using support::DrivenCar;
using support::LinearCar;

constexpr double period = 1e-3;
using Channels = std::vector<Channel>;

const Channels every{Channel::z_r, Channel::dz_w, Channel::dz_b, Channel::zdd_b, Channel::zdd_w, Channel::F_w};
const Channels without_force{Channel::z_r, Channel::dz_w, Channel::dz_b, Channel::zdd_b, Channel::zdd_w};
const Channels accelerations{Channel::zdd_b, Channel::zdd_w};

struct Made {
  Made(const KalmanSettings& settings, const model::RigParameters<double>& rig)
      : equations(settings, rig),
        gains(std::make_unique<SteadyGains>(equations, period)),
        filter(std::make_unique<KalmanFilter>(equations, *gains, period)) {}
  EstimatorEquations equations;
  std::unique_ptr<SteadyGains> gains;
  std::unique_ptr<KalmanFilter> filter;
};

hal::Reading good(double value, hal::Time taken) { return {value, taken, hal::Quality::good}; }

double of_velocity(const EstimatorEquations& equations, const firmware::EstimatorMatrix& p) {
  EstimatorVector v = EstimatorVector::Zero();
  v(equations.core(CoreIndex::wheel_velocity)) = 1.0;
  v(equations.core(CoreIndex::body_velocity)) = -1.0;
  return std::sqrt(v.dot(p * v));
}
double of_wheel_load(const EstimatorEquations& equations, const firmware::EstimatorMatrix& p) {
  const EstimatorVector f = equations.row(Channel::F_w, 0, false);
  return std::sqrt(f.dot(p * f));
}

struct Bound {
  Channels channels;
  double wheel_load, velocity;
};
const std::vector<Bound> table{{every, 2.06, 0.0013},
                               {without_force, 2.11, 0.0013},
                               {{Channel::dz_b, Channel::zdd_b, Channel::zdd_w}, 3.77, 0.0024},
                               {accelerations, 4.72, 0.0030},
                               {{Channel::dz_b, Channel::zdd_b}, 164.0, 0.0083},
                               {{Channel::dz_b}, 237.0, 0.0176}};

// Point. The posterior standard deviations are those of a calculation that shares nothing with this one; its numbers
// are printed with two digits or more, hence 1 % and half of the last digit.
TEST(KalmanFilter, ExpectsTheErrorsThatTheoryAllows) {
  for (const Bound& bound : table) {
    Made made(LinearCar::settings(bound.channels), LinearCar::rig());
    made.gains->compute(0);
    const auto& p = made.gains->posterior();
    EXPECT_NEAR(of_wheel_load(made.equations, p) / bound.wheel_load, 1.0, 0.01) << bound.channels.size();
    EXPECT_NEAR(of_velocity(made.equations, p), bound.velocity, 0.5e-4 + 0.01 * bound.velocity);
  }
}

struct Errors {
  double wheel_load = 0.0, velocity = 0.0, nis = 0.0, nees = 0.0;
  std::size_t innovations = 0, judged = 0;
};

/// `late`: dz_b is so many periods old; `told`: and has the stamp that says so.
Errors drive(KalmanFilter& filter, const EstimatorEquations& equations, const firmware::EstimatorMatrix& posterior,
             const Channels& channels, std::uint64_t seed, int periods, int late = 0, bool told = true,
             double lost = 0.0) {
  DrivenCar car(seed);
  support::Normal chance(seed + 1000);
  Errors errors;
  std::deque<double> past(32, 0.0);
  const Eigen::MatrixXd covariance = posterior.topLeftCorner(equations.states(), equations.states());
  const Eigen::LDLT<Eigen::MatrixXd> inverse(covariance);
  int counted = 0;
  for (int k = 1; k <= periods; ++k) {
    car.step();
    const hal::Time now = hal::milliseconds(k);
    hal::Frame frame;
    past.push_front(car.reading(Channel::dz_b));
    past.pop_back();
    for (const Channel channel : channels) {
      const bool old = channel == Channel::dz_b && late > 0;
      const double value = old ? past[static_cast<std::size_t>(late)] : car.reading(channel);
      if (lost > 0.0 && std::abs(chance()) < lost) continue;
      frame.channels[model::index(channel)] = good(value, old && told ? now - hal::milliseconds(late) : now);
    }
    filter.step(frame, 0, now);
    if (k < 3000) continue;  // half a minute of body oscillations would be too long to wait for; 3 s are 30 of them
    ++counted;
    const auto& x = car.x();
    const double load = filter.wheel_load() - car.truth(Channel::F_w);
    const double velocity =
        filter.core(CoreIndex::wheel_velocity) - filter.core(CoreIndex::body_velocity) - (x(3) - x(1));
    errors.wheel_load += load * load;
    errors.velocity += velocity * velocity;
    errors.nis += filter.nis();
    errors.innovations += static_cast<std::size_t>(filter.innovations());
    if (k % 500 != 0) continue;
    Eigen::VectorXd error(5);
    error << filter.state()(0) - x(2), filter.state()(1) - x(3), filter.state()(2) - x(0), filter.state()(3) - x(1),
        filter.state()(4) - x(4);
    errors.nees += error.dot(inverse.solve(error));
    ++errors.judged;
  }
  errors.wheel_load = std::sqrt(errors.wheel_load / counted);
  errors.velocity = std::sqrt(errors.velocity / counted);
  return errors;
}

// Law. On a car that is what the filter thinks, its errors are the bounds of the table within 5 %, its innovations are
// white and as large as it expects (χ² with m degrees of freedom a period: the mean of n of them scatters by √(2/(m
// n))), and its errors as large as P says (every half second; the road's are forgotten after 3 s, so that of eight
// samples one is independent; 4 σ).
TEST(KalmanFilter, ReachesTheBoundsInSimulation) {
  for (const Bound& bound : table) {
    Made made(LinearCar::settings(bound.channels), LinearCar::rig());
    made.gains->compute(0);
    const Errors e = drive(*made.filter, made.equations, made.gains->posterior(), bound.channels, 5, 120'000);
    const std::string who = std::to_string(bound.channels.size()) + " channels, seed 5";
    EXPECT_NEAR(e.wheel_load / of_wheel_load(made.equations, made.gains->posterior()), 1.0, 0.05) << who;
    EXPECT_NEAR(e.velocity / of_velocity(made.equations, made.gains->posterior()), 1.0, 0.05) << who;
    const auto n = static_cast<double>(e.innovations);
    EXPECT_NEAR(e.nis / n, 1.0, 4.0 * std::sqrt(2.0 / n)) << who;
    const double degrees = 5.0 * static_cast<double>(e.judged);  // of which one in eight is independent
    EXPECT_NEAR(e.nees / degrees, 1.0, 4.0 * std::sqrt(2.0 * 8.0 / degrees)) << who;
    EXPECT_FALSE(made.filter->monitor().model_wrong()) << who;
    EXPECT_GE(made.filter->monitor().blocks(), 25U * bound.channels.size()) << who;
  }
}

// Law. A sample 5 ms old counts for when it was taken: the errors are those that the filter expects of such a rig.
// Taken as new it costs many times that, and the innovations say that something is wrong.
TEST(KalmanFilter, FusesLateSamplesForWhenTheyWereTaken) {
  const Channels channels{Channel::dz_b, Channel::zdd_b, Channel::zdd_w};
  KalmanSettings settings = LinearCar::settings(channels);
  settings.age[model::index(Channel::dz_b)] = 5e-3;
  Made late(settings, LinearCar::rig());
  late.gains->compute(0);
  const auto& posterior = late.gains->posterior();
  const Errors right = drive(*late.filter, late.equations, posterior, channels, 6, 60'000, 5, true);
  EXPECT_NEAR(right.wheel_load / of_wheel_load(late.equations, posterior), 1.0, 0.05);
  EXPECT_NEAR(right.velocity / of_velocity(late.equations, posterior), 1.0, 0.05);
  const auto n = static_cast<double>(right.innovations);
  EXPECT_NEAR(right.nis / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_EQ(late.filter->too_old(), 0U);
  Made fresh(LinearCar::settings(channels), LinearCar::rig());
  fresh.gains->compute(0);
  const Errors wrong = drive(*fresh.filter, fresh.equations, fresh.gains->posterior(), channels, 6, 60'000, 5, false);
  EXPECT_GT(wrong.wheel_load, 10.0 * right.wheel_load);
  EXPECT_TRUE(fresh.filter->monitor().model_wrong());
}

// Law. Between two periods, too. A known force drives the car, so that the filter knows its motion and a sample tells
// it nothing new – if it is compared with the instant of its stamp, 2.4 periods ago. Off by 0.4 periods it would pull
// the estimate; that is more than ten times as much.
TEST(KalmanFilter, FusesSamplesBetweenTwoPeriods) {
  const Channels channels{Channel::dz_b, Channel::dz_w};
  KalmanSettings settings = LinearCar::settings(channels);
  for (const Channel c : channels) settings.age[model::index(c)] = 2e-3;
  const LinearCar car;
  double worst[2] = {0.0, 0.0};
  for (const bool right : {true, false}) {
    Made made(settings, LinearCar::rig());
    // In steps of a tenth: exact for a force that goes straight from period to period.
    constexpr double h = period / 10.0;
    LinearCar::Vector x = LinearCar::Vector::Zero(), push;
    push << 0, 1.0 / LinearCar::m_b, 0, -1.0 / LinearCar::m_w, 0;
    std::deque<LinearCar::Vector> past(40, x);
    double before = 0.0;
    for (int k = 1; k < 600; ++k) {
      const double force = 300.0 * std::sin(0.06 * k);
      for (int i = 0; i < 10; ++i) {
        const auto rate = [&](const LinearCar::Vector& at, double s) {
          return (car.a * at + push * (before + (force - before) * s)).eval();
        };
        const double s = 0.1 * i;
        const LinearCar::Vector k1 = rate(x, s), k2 = rate(x + 0.5 * h * k1, s + 0.05);
        const LinearCar::Vector k3 = rate(x + 0.5 * h * k2, s + 0.05), k4 = rate(x + h * k3, s + 0.1);
        x += (h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)).eval();
        past.push_front(x);
        past.pop_back();
      }
      before = force;
      const hal::Time now = hal::milliseconds(k);
      const hal::Time taken = now - hal::microseconds(right ? 2400 : 2000);
      hal::Frame frame;
      for (const Channel c : channels) frame.channels[model::index(c)] = good(car.row(c).dot(past[24]), taken);
      frame.channels[model::index(Channel::F_act)] = good(force, now);
      made.filter->step(frame, 0, now);
      if (k > 20) {
        worst[right ? 0 : 1] =
            std::max(worst[right ? 0 : 1], std::abs(made.filter->core(CoreIndex::wheel_velocity) - x(3)));
      }
    }
    EXPECT_EQ(made.filter->too_old(), 0U);
  }
  EXPECT_LT(10.0 * worst[0], worst[1]);
}

// Fault. A third of the samples lost: the rest is used. In one of 81 periods none of the four that show the wheel load
// – z_r, dz_w, zdd_w, F_w – is there; the road then moves on unseen by its gain · √(h/2) = 0.59 mm, 118 N: 13 N rms
// over all periods, and less than a third more for what is lost after that. The filter knows what it has not seen: the
// innovations are as large as it expects, and no model is called wrong for them.
TEST(KalmanFilter, SkipsMissingSamples) {
  Made made(LinearCar::settings(every), LinearCar::rig());
  made.gains->compute(0);
  const auto& posterior = made.gains->posterior();
  const Errors e = drive(*made.filter, made.equations, posterior, every, 7, 60'000, 0, true, 0.43);
  EXPECT_LT(e.wheel_load, 17.0);
  const auto n = static_cast<double>(e.innovations);
  EXPECT_NEAR(e.nis / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_FALSE(made.filter->monitor().model_wrong());
  EXPECT_GE(made.filter->monitor().blocks(), 30U);
  EXPECT_LT(e.innovations, 57'001U * 6 * 3 / 4);
}

/// A linear car on a road of this bandwidth, with potholes of 30 mm and 20 ms, a limit of the command's speed or neither;
/// its filter thinks of 30 Hz. The errors of F_w [N] from 5 s on, and what the monitor says.
struct OtherRoad {
  double bandwidth = 30.0;
  bool potholes = false;
  double limit = 1e9;  ///< [m/s]
};
struct Followed {
  double wheel_load = 0.0, wide = 0.0;
  bool model_wrong = false;
};
Followed follow(const OtherRoad& shape, int periods = 30'000) {
  Channels channels = every;
  channels.insert(channels.begin() + 1, Channel::zdd_r);
  KalmanSettings settings = LinearCar::settings(channels);
  settings.bandwidth = 30.0;
  settings.noise[model::index(Channel::zdd_r)] = 0.05;
  Made made(settings, LinearCar::rig());
  const model::RigModel<> model(LinearCar::rig(), period);
  auto x = model.start(0.0);
  const model::RoadFilter<double> road({64e-6, 27.78, 0.05, shape.bandwidth}, period);
  auto on_road = model::RoadFilter<double>::State::Zero().eval();
  support::Normal normal(11);
  model::Motion<double> foot{};
  Followed result;
  for (int k = 1; k <= periods; ++k) {
    on_road = road.step(on_road, normal() * std::sqrt(0.5 / period));
    model::Motion<double> wanted = road.motion(on_road);
    const double t = period * (k % 4000 - 2000), w = 2.0 * std::numbers::pi / 0.02;
    if (shape.potholes && t > 0.0 && t < 0.02) {
      wanted.position -= 0.015 * (1.0 - std::cos(w * t));
      wanted.velocity -= 0.015 * w * std::sin(w * t);
      wanted.acceleration -= 0.015 * w * w * std::cos(w * t);
    }
    const double speed = std::clamp((wanted.position - foot.position) / period, -shape.limit, shape.limit);
    const bool limited = std::abs(speed) >= shape.limit;
    foot = limited ? model::Motion<double>{foot.position + speed * period, speed, 0.0} : wanted;
    model.step(x, {.foot_point = foot});
    const auto truth = model.signals(x);
    hal::Frame frame;
    for (const Channel c : channels) {
      const double noise = c == Channel::zdd_r ? 0.05 : LinearCar::noise(c);
      frame.channels[model::index(c)] = good(truth[model::index(c)] + noise * normal(), hal::milliseconds(k));
    }
    made.filter->step(frame, 0, hal::milliseconds(k));
    if (k <= 5000) continue;
    result.wheel_load += std::pow(made.filter->wheel_load() - truth[model::index(Channel::F_w)], 2) / (periods - 5000);
  }
  result.wheel_load = std::sqrt(result.wheel_load);
  result.wide = static_cast<double>(made.filter->wide_periods()) / periods;
  result.model_wrong = made.filter->monitor().model_wrong();
  return result;
}

// Law. A road that is not the described one costs the foot point's sensors nothing but what the described road would have
// told beyond them: 2 N, which the car on white velocity has (the first row of the table); half as much again, because
// the gate lets 5 standard deviations pass as noise. Without (5) these are 68, 217, 98 and 36 N. Events are not judged,
// and a road that is another all the time is said.
TEST(KalmanFilter, FollowsARoadThatIsNotTheDescribedOne) {
  const Followed right = follow({});
  EXPECT_LT(right.wheel_load, 0.6);
  EXPECT_LT(right.wide, 1e-3);
  const Followed wide = follow({.bandwidth = 100.0});
  EXPECT_LT(wide.wheel_load, 3.0);
  EXPECT_TRUE(wide.model_wrong);
  const Followed potholes = follow({.potholes = true});
  EXPECT_LT(potholes.wheel_load, 3.0);
  EXPECT_FALSE(potholes.model_wrong);
  const Followed limited = follow({.limit = 0.35});  // as class C at 0.7 m/s
  EXPECT_LT(limited.wheel_load, 3.0);
  EXPECT_GT(limited.wide, 0.05);
  EXPECT_FALSE(limited.model_wrong);
}

// Fault. A bad sample and one that was shown before (same stamp) are no samples.
TEST(KalmanFilter, UsesNoSampleTwiceAndNoBadOne) {
  Made made(LinearCar::settings(accelerations), LinearCar::rig());
  hal::Frame frame;
  frame.channels[model::index(Channel::zdd_b)] = good(1.0, hal::milliseconds(1));
  frame.channels[model::index(Channel::zdd_w)] = {1.0, hal::milliseconds(1), hal::Quality::clipped};
  const std::uint32_t wheel_bad = 1U << model::index(Channel::zdd_w);
  int innovations = 0;
  for (int k = 1; k < 10; ++k) {
    made.filter->step(frame, k == 1 ? 0U : wheel_bad, hal::milliseconds(k));
    innovations += made.filter->innovations();
  }
  EXPECT_EQ(innovations, 1);
  frame.channels[model::index(Channel::zdd_b)] = good(1.0, hal::milliseconds(-5));
  made.filter->step(frame, wheel_bad, hal::milliseconds(10));
  EXPECT_EQ(made.filter->too_old(), 1U);
}

model::RigParameters<double> with_absorber() {
  auto rig = LinearCar::rig();
  rig.has_fdva = true;
  rig.fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2};
  return rig;
}

/// A nonlinear rig of the model on the road of the simulated rigs; another number of ducts every 50 ms.
struct Switched {
  double wheel_load, expected;
  bool model_wrong;
};
Switched drive_with_ducts(const Channels& channels, double body_mass, double offset, double* bias) {
  KalmanSettings settings;
  for (const Channel c : channels) settings.noise[model::index(c)] = LinearCar::noise(c);
  if (bias != nullptr) settings.bias[model::index(Channel::zdd_b)] = true;
  Made made(settings, with_absorber());
  auto rig = with_absorber();
  rig.body.mass = body_mass;
  const model::RigModel<> model(rig, period);
  auto x = model.start(0.0);
  const model::RoadFilter<double> road({64e-6, 27.78, 0.05, 30.0}, period);
  auto on_road = model::RoadFilter<double>::State::Zero().eval();
  support::Normal normal(9);
  made.filter->switch_to(hal::Openings::first(2));
  double errors = 0.0;
  constexpr int periods = 60'000, settled = 5000;
  for (int k = 1; k <= periods; ++k) {
    on_road = road.step(on_road, normal() * std::sqrt(0.5 / period));
    model.step(x, {.foot_point = road.motion(on_road)});
    const auto truth = model.signals(x);
    hal::Frame frame;
    for (const Channel c : channels) {
      const double shift = c == Channel::zdd_b ? offset : 0.0;
      frame.channels[model::index(c)] =
          good(truth[model::index(c)] + shift + LinearCar::noise(c) * normal(), hal::milliseconds(k));
    }
    support::without_heap([&] { made.filter->step(frame, 0, hal::milliseconds(k)); });
    if (k > settled) {
      const double error = made.filter->wheel_load() - truth[model::index(Channel::F_w)];
      errors += error * error;
    }
    if (k % 50 == 0) {
      const int open = k / 50 % 7;
      model.open_ducts(x, model::first_ducts(open));
      made.filter->switch_to(hal::Openings::first(static_cast<std::size_t>(open)));
    }
  }
  if (bias != nullptr) *bias = made.filter->state()(made.equations.states() - 1);
  made.gains->compute(2);
  return {std::sqrt(errors / (periods - settled)), of_wheel_load(made.equations, made.gains->posterior()),
          made.filter->monitor().model_wrong()};
}

// Law. With an absorber whose ducts open and close, quadratic losses and the road of a simulated rig the filter still
// reaches its bound, and without heap. With the two accelerometers alone the flows of single ducts are hardly seen: 10
// %.
TEST(KalmanFilter, KnowsTheDuctsThatOpenAndClose) {
  const Switched all = drive_with_ducts(every, LinearCar::m_b, 0.0, nullptr);
  EXPECT_NEAR(all.wheel_load / all.expected, 1.0, 0.05);
  EXPECT_FALSE(all.model_wrong);
  const Switched two = drive_with_ducts(accelerations, LinearCar::m_b, 0.0, nullptr);
  EXPECT_NEAR(two.wheel_load / two.expected, 1.0, 0.10);
  EXPECT_FALSE(two.model_wrong);
}

// Law. A body that is 3 % heavier than described is a wrong model, and the innovations say so.
TEST(KalmanFilter, SaysThatTheModelIsWrong) {
  EXPECT_TRUE(drive_with_ducts(every, 1.03 * LinearCar::m_b, 0.0, nullptr).model_wrong);
}

// Law. The offset of an accelerometer is found where it is a state: to 3 σ of a drift of 0.1 · 0.05 m/s² in a second,
// averaged over the filter's own time constant of seconds.
TEST(KalmanFilter, FindsTheOffsetOfAnAccelerometer) {
  double bias = 0.0;
  const Switched found = drive_with_ducts(every, LinearCar::m_b, 0.2, &bias);
  EXPECT_NEAR(bias, 0.2, 0.02);
  EXPECT_NEAR(found.wheel_load / found.expected, 1.0, 0.05);
  EXPECT_TRUE(drive_with_ducts(every, LinearCar::m_b, 0.2, nullptr).model_wrong);
}

// Law. A known force between wheel and body is an input: without it the filter is off, with it at its bound.
TEST(KalmanFilter, KnowsTheActuatorsForce) {
  for (const bool told : {true, false}) {
    KalmanSettings settings;
    for (const Channel c : without_force) settings.noise[model::index(c)] = LinearCar::noise(c);
    Made made(settings, LinearCar::rig());
    const model::RigModel<> model(LinearCar::rig(), period);
    auto x = model.start(0.0);
    double worst = 0.0;
    for (int k = 1; k < 3000; ++k) {
      const double force = 300.0 * std::sin(0.01 * k);
      model.step(x, {.actuator_force = force});
      const auto truth = model.signals(x);
      hal::Frame frame;
      for (const Channel c : without_force) {
        frame.channels[model::index(c)] = good(truth[model::index(c)], hal::milliseconds(k));
      }
      if (told) frame.channels[model::index(Channel::F_act)] = good(force, hal::milliseconds(k));
      made.filter->step(frame, 0, hal::milliseconds(k));
      if (k > 1000) worst = std::max(worst, std::abs(made.filter->wheel_load() - truth[model::index(Channel::F_w)]));
    }
    if (told) {
      EXPECT_LT(worst, 0.01);  // [N] of 300: numbers, not noise
    } else {
      EXPECT_GT(worst, 0.5);
    }
  }
}

// Law. The mass at the wheel-load sensor is in the row of F_w: the filter's wheel load is the tyre's.
TEST(KalmanFilter, TakesTheMassAtTheForceSensorOff) {
  auto rig = LinearCar::rig();
  rig.effects.add(model::ForceSensorInertia<double>{5.0});
  KalmanSettings settings;
  settings.noise[model::index(Channel::F_w)] = 10.0;
  const EstimatorEquations equations(settings, rig);
  EstimatorVector x = EstimatorVector::Zero();
  x(equations.foot_point()) = 0.001;
  const double acceleration = equations.output(Channel::zdd_r, x, 0, true);
  EXPECT_NEAR(equations.output(Channel::F_w, x, 0, true) - equations.output(Channel::F_w, x, 0, false),
              5.0 * acceleration, 1e-9);
  EXPECT_NE(acceleration, 0.0);
}

// Fault. On a road without end – no cut-off – accelerometers never say where the car is: the state is named.
TEST(KalmanFilter, NamesAStateThatNoSensorShows) {
  KalmanSettings settings = LinearCar::settings(accelerations);
  settings.cut_off = 0.0;
  Made made(settings, LinearCar::rig());
  const auto [state, open] = made.filter->unobservable();
  ASSERT_GE(state, 0);
  EXPECT_EQ(made.equations.state(state).name(), "z_w");
  EXPECT_EQ(open, 0);
  settings.noise[model::index(Channel::z_r)] = 2e-5;
  EXPECT_EQ(Made(settings, LinearCar::rig()).filter->unobservable().state, -1);
}

// Fault. Settings that cannot be a filter are refused with their key.
TEST(KalmanFilter, RefusesSettingsThatDoNotFit) {
  const auto wrong = [](const auto& change) {
    KalmanSettings settings = LinearCar::settings(every);
    auto rig = LinearCar::rig();
    change(settings, rig);
    return std::string(EstimatorEquations::check(settings, rig));
  };
  EXPECT_EQ(wrong([](auto&, auto&) {}), "");
  EXPECT_NE(wrong([](auto&, auto& r) { r.kind = model::RigKind::hil; }).find("estimator.kind"), std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.noise = {}; }).find("at least one"), std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.noise[model::index(Channel::zdd_r)] = 0.05; }).find("zdd_r"),
            std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.noise[model::index(Channel::x_act)] = 1.0; }).find("sensors"),
            std::string::npos);
  EXPECT_NE(wrong([](auto&, auto& r) { r.effects.add(model::ForceSensorInertia<double>{5.0}); }).find("F_w"),
            std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.bias[model::index(Channel::z_w)] = true; }).find("bias"), std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.speed = std::nan(""); }).find("speed"), std::string::npos);
  EXPECT_NE(wrong([](auto& s, auto&) { s.history = 9; }).find("history"), std::string::npos);
}

}  // namespace
