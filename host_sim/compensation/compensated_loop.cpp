#include "host_sim/compensation/compensated_loop.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/simulation/compensated_period.hpp"
#include "host_sim/compensation/arrived_series.hpp"
#include "host_sim/stability/roots/eigenvalues.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/step_state.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim::compensation {
namespace {

using firmware::compensation::Compensator;
using firmware::compensation::Kind;
using firmware::compensation::Settings;
using model::Channel;
using Car = model::VirtualCar<double>;
using Hardware = model::RigModel<>;

/// Of the unit vectors: so small that rate and limits of a compensator do not act [m, m/s, N].
constexpr double unit_size = 1e-6;

/// The method as a linear one, with the coefficients or the damping that it arrives at.
Settings arrived(Settings settings, const model::RigParameters<double>& rig) {
  settings.start_ramp = 0.0;
  settings.rate = 100.0;
  if (settings.kind == Kind::adaptive_virtual_damping) settings.kind = Kind::virtual_damping;
  if (settings.kind == Kind::adaptive_time_series) {
    settings.kind = Kind::inverse;
    settings.gain = 1.0;
    settings.given = arrived_series(settings, rig);
  }
  return settings;
}

/// Everything that changes in a period.
struct State {
  Car::State car;
  Hardware::State hardware;
  std::optional<Compensator> compensator;
};

class Loop {
 public:
  Loop(const model::RigParameters<double>& rig, double period, const Settings* settings, double force_factor)
      : car_(rig, period, model::ModelledPart::virtual_car),
        hardware_(std::make_unique<Hardware>(rig, period, model::ModelledPart::test_machine)),
        origin_(std::make_unique<State>(State{car_.start(), hardware_->start(), std::nullopt})),
        area_(rig),
        open_ducts_(rig.has_fdva ? rig.fdva.open_ducts : 0),
        force_factor_(force_factor) {
    model::MachinePath<double> path;
    rig.effects.act_on(path);
    line_ = static_cast<std::size_t>(path.delay / period + 1e-9) + 2;
    if (settings == nullptr) return;
    origin_->compensator.emplace(arrived(*settings, rig), period);
    static_cast<firmware::Compensation&>(*origin_->compensator).start(0.0);
    origin_->compensator->state().begun = true;
  }

  [[nodiscard]] const State& origin() const { return *origin_; }

  /// visit(value) for every value of a state that a period reads.
  template <class Visit>
  void for_each(State& x, const Visit& visit) const {
    for (int i = 0; i < model::car_states; ++i) visit(x.car.core(i));
    for (Eigen::Index i = model::car_states; i < x.hardware.core.size(); ++i) visit(x.hardware.core(i));
    stability::for_each_behind_the_car(*hardware_, x.hardware, [&](double& value, bool) { visit(value); });
    visit_stroke(x.hardware.command, visit);
    for (std::size_t i = 0; i < line_; ++i) visit_stroke(x.hardware.line.ago(i), visit);
    if (!x.compensator) return;
    auto& c = x.compensator->state();
    for (std::size_t i = 0; i < x.compensator->reach(); ++i) {
      visit_stroke(c.past.ago(i), visit);
      visit_stroke(c.specimen.line.ago(i), visit);
    }
    visit_all(c.feedback, visit);
    visit_all(c.specimen.machine, visit);
    visit_all(c.specimen.piston, visit);
    for (auto* stroke : {&c.specimen.delayed, &c.specimen.reached, &c.specimen.difference})
      visit_stroke(*stroke, visit);
    for (double* value :
         {&c.wanted.position, &c.wanted.velocity, &c.wanted.acceleration, &c.last_force, &c.last_feedback, &c.added}) {
      visit(*value);
    }
  }

  void step(State& x, const model::Motion<double>& road) const {
    firmware::Compensation* compensation = x.compensator ? &*x.compensator : nullptr;
    firmware::step_compensated({car_, x.car, *hardware_, x.hardware, area_, compensation}, road, open_ducts_,
                               force_factor_);
  }

  [[nodiscard]] Eigen::Vector3d outputs(const State& x) const {
    return {car_.signals(x.car)[model::index(Channel::F_w)], car_.component_stroke(car_.deflection(x.car)).position,
            x.hardware.reached.position};
  }

 private:
  template <class Vector, class Visit>
  static void visit_all(Vector& values, const Visit& visit) {
    for (Eigen::Index i = 0; i < values.size(); ++i) visit(values(i));
  }
  template <class Visit>
  static void visit_stroke(model::Stroke<double>& stroke, const Visit& visit) {
    visit(stroke.position);
    visit(stroke.velocity);
  }

  Car car_;
  std::unique_ptr<Hardware> hardware_;
  std::unique_ptr<State> origin_;
  firmware::AreaControl<true> area_;
  int open_ducts_;
  double force_factor_;
  std::size_t line_ = 0;  ///< samples of the machine's line that are read
};

std::vector<Eigen::Index> kept_states(const CompensatedLoop& loop) {
  const auto size = static_cast<std::size_t>(loop.a.rows());
  std::vector<bool> driven(size), seen(size);
  for (std::size_t i = 0; i < size; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    driven[i] = !loop.b_before.row(at).isZero(0.0) || !loop.b_now.row(at).isZero(0.0);
    seen[i] = !loop.c.col(at).isZero(0.0);
  }
  driven = stability::reached(loop.a, driven);
  seen = stability::reached(loop.a.transpose(), seen);
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < size; ++i) {
    if (driven[i] && seen[i]) kept.push_back(static_cast<Eigen::Index>(i));
  }
  return kept;
}

}  // namespace

CompensatedLoop compensated_loop(const model::RigParameters<double>& rig, double period, const Settings* settings,
                                 double force_factor) {
  const Loop loop(rig, period, settings, force_factor);
  const auto work = std::make_unique<State>(loop.origin());
  Eigen::Index size = 0;
  loop.for_each(*work, [&](double&) { ++size; });
  const auto read = [&](State& x) {
    Eigen::VectorXd values(size);
    Eigen::Index i = 0;
    loop.for_each(x, [&](double& value) { values(i++) = value; });
    return values;
  };
  const auto column = [&](const auto& response) { return stability::slope(rig, response, unit_size); };
  CompensatedLoop all;
  all.period = period;
  all.a.resize(size, size);
  all.b_before.resize(size, 2);
  all.b_now.resize(size, 2);
  all.c.resize(3, size);
  all.d.resize(3, 2);
  for (Eigen::Index j = 0; j < size; ++j) {
    const auto moved = [&](double unit) {
      *work = loop.origin();
      Eigen::Index i = 0;
      loop.for_each(*work, [&](double& value) { value += i++ == j ? unit : 0.0; });
    };
    all.c.col(j) = column([&](double unit) {
      moved(unit);
      return Eigen::VectorXd(loop.outputs(*work));
    });
    all.a.col(j) = column([&](double unit) {
      moved(unit);
      loop.step(*work, {});
      return read(*work);
    });
  }
  for (int j = 0; j < 2; ++j) {
    const auto road = [j](double unit) { return model::Motion<double>{j == 0 ? unit : 0.0, j == 0 ? 0.0 : unit, 0.0}; };
    all.d.col(j) = column([&](double unit) {
      *work = loop.origin();
      work->car.foot_point = road(unit);
      return Eigen::VectorXd(loop.outputs(*work));
    });
    all.b_before.col(j) = column([&](double unit) {
      *work = loop.origin();
      work->car.foot_point = road(unit);
      loop.step(*work, {});
      return read(*work);
    });
    all.b_now.col(j) = column([&](double unit) {
      *work = loop.origin();
      loop.step(*work, road(unit));
      return read(*work);
    });
  }
  const auto kept = kept_states(all);
  CompensatedLoop result = all;
  result.a = all.a(kept, kept);
  result.b_before = all.b_before(kept, Eigen::all);
  result.b_now = all.b_now(kept, Eigen::all);
  result.c = all.c(Eigen::all, kept);
  return result;
}

double CompensatedLoop::spectral_radius() const {
  double radius = 0.0;
  for (const auto& value : stability::eigenvalues(a)) radius = std::max(radius, std::abs(value));
  return radius;
}

Eigen::Vector3cd CompensatedLoop::response(double omega) const {
  const Complex z = std::polar(1.0, omega * period);
  const Eigen::Vector2cd road(1.0, Complex(0.0, omega));
  Eigen::MatrixXcd m = -a.cast<Complex>();
  m.diagonal().array() += z;
  const Eigen::VectorXcd x =
      m.partialPivLu().solve(b_before.cast<Complex>() * road + z * (b_now.cast<Complex>() * road));
  return c.cast<Complex>() * x + d.cast<Complex>() * road;
}

}  // namespace host_sim::compensation
