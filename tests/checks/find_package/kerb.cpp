// A quarter car rolls over a kerb of 20 mm that is 2 m long, at 10 m/s: the peak of the wheel load.
#include <algorithm>
#include <cstdio>
#include <model/rig/rig_model.hpp>

int main() {
  model::RigParameters<double> rig;  // a quarter_car unless it says otherwise
  rig.body.mass = 290.0, rig.wheel.mass = 40.0;
  rig.tyre.stiffness = 200e3, rig.tyre.damping = 100.0;
  rig.suspension.stiffness = 31500.0, rig.suspension.damping = 1140.0;
  rig.effects.add(model::CoulombFriction<double>{40.0});
  const model::RigModel<> car(rig, 1e-3);
  auto state = car.start();
  double peak = 0.0;
  for (int k = 1; k <= 1000; ++k) {
    car.step(state, {.foot_point = {k < 200 ? 0.02 : 0.0, 0.0, 0.0}});
    peak = std::max(peak, car.signals(state)[index(model::Channel::F_w)]);
  }
  std::printf("largest dynamic wheel load %.0f N\n", peak);
}
