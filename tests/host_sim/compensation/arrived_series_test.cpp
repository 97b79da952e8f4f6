// Where the coefficients of a time series settle.
#include "host_sim/compensation/arrived_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/loop/compensation/compensator.hpp"
#include "firmware/simulation/compensated_period.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "model/components/road_filter.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace arrived_series_test {
namespace {

using firmware::compensation::Compensator;
using firmware::compensation::Kind;
using firmware::compensation::Settings;

Settings series_of(const model::RigParameters<double>& rig) {
  Settings settings;
  settings.kind = Kind::adaptive_time_series;
  rig.effects.act_on(settings.machine);
  settings.given = firmware::compensation::inverse_at(settings.machine, 1.0, firmware::wheel_mode(rig));
  settings.memory = 20.0;  // of a minute's road
  return settings;
}

// Law. What the analysis says of a time series is what it arrives at: the firmware's own, in the loop of the paper's
// rig without virtual damping, for two minutes of road. a₁ of the wheel's inverse is 8.725 ms.
TEST(ArrivedSeries, IsWhereTheLoopTakesIt) {
  const auto rig = host_sim::stability::sampled_part(stability_tests::fdva_rig(0.010, 0.0));
  const Settings settings = series_of(rig);
  const model::VirtualCar<double> car(rig, 1e-3, model::ModelledPart::virtual_car);
  const auto hardware = std::make_unique<model::RigModel<>>(rig, 1e-3, model::ModelledPart::test_machine);
  auto car_state = car.start();
  const auto hardware_state = std::make_unique<model::RigModel<>::State>(hardware->start());
  const firmware::AreaControl<true> area(rig);
  Compensator compensator(settings, 1e-3);
  static_cast<firmware::Compensation&>(compensator).start(0.0);
  const model::RoadFilter<double> road({16e-6, 27.78, 0.05, 50.0}, 1e-3);
  auto on_road = model::RoadFilter<double>::State::Zero().eval();
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, std::sqrt(500.0));
  firmware::compensation::Coefficients mean{};
  constexpr int samples = 120'000, counted = 80'000;
  for (int k = 0; k < samples; ++k) {
    on_road = road.step(on_road, noise(random));
    (void)firmware::step_compensated({car, car_state, *hardware, *hardware_state, area, &compensator},
                                     road.motion(on_road), 2);
    if (k < samples - counted) continue;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += compensator.values()[i] / counted;
  }
  const auto arrived = host_sim::compensation::arrived_series(settings, rig);
  EXPECT_NEAR(mean[0], arrived[0], 2e-3);
  EXPECT_NEAR(mean[1], arrived[1], 0.04e-3);
  EXPECT_NEAR(mean[2], arrived[2], 0.02 * arrived[2]);
  EXPECT_LT(std::abs(arrived[1] - settings.given[1]), 0.05e-3);  // near the wheel's: velocities are compared
}

// Law. A machine that a series of this order is at all frequencies is found exactly, from any assumption.
TEST(ArrivedSeries, IsTheInverseWhereThereIsOne) {
  auto rig = stability_tests::linear_rig(0.0, 1140.0);
  rig.effects.add(model::ActuatorLag<double>{0.004});
  Settings settings = series_of(rig);
  settings.given = {1.0, 0.010, 0.0, 0.0};
  const auto arrived = host_sim::compensation::arrived_series(settings, rig);
  EXPECT_NEAR(arrived[0], 1.0, 1e-9);
  EXPECT_NEAR(arrived[1], 0.004, 1e-9);
  EXPECT_NEAR(arrived[2], 0.0, 1e-11);
}

}  // namespace
}  // namespace arrived_series_test
