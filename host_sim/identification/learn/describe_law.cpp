#include "host_sim/identification/learn/describe_law.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "host_sim/identification/learn/excited_range.hpp"
#include "host_sim/identification/learn/law_beside.hpp"
#include "host_sim/identification/learn/sliding_sides.hpp"
#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/report/formatted.hpp"
#include "model/laws/curve.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

/// Three figures, as a reader writes them: "9800", not "9.8e+03", "−5", not "-5".
std::string figures(double value) {
  if (value < 0.0) return "−" + figures(-value);
  if (!(std::abs(value) >= 1000.0)) return formatted("%.3g", value);
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return formatted("%.0f", unit * std::round(value / unit));
}

/// A law of a fit with what is known about its values.
class LawDescription {
 public:
  LawDescription(const Fit& fit, const Uncertainty& known, std::size_t law)
      : fit_(fit), known_(known), half_widths_(known.half_widths), law_(fit.hypothesis.laws[law]) {
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const FreeParameter& p = fit.parameters[i];
      if (p.role == FreeParameter::Role::law && p.law == law) own_.push_back(i);
    }
    const auto& rig = fit.hypothesis.rig;
    const bool tyre = law_.place == CurvePlace::tyre;
    if (law_.place == CurvePlace::body_guide || law_.place == CurvePlace::wheel_guide) return;
    if (law_.over == CurveOver::velocity) slope_ = tyre ? rig.tyre.damping : rig.suspension.damping;
    if (law_.over == CurveOver::deflection) slope_ = tyre ? rig.tyre.stiffness : rig.suspension.stiffness;
  }

  [[nodiscard]] DescribedLaw described() const {
    DescribedLaw out;
    out.law = law_;
    add_curve(out);
    if (is_surface(law_.family)) add_sections(out);
    switch (law_.family) {
      case LawFamily::points:
        free_curve(out);
        break;
      case LawFamily::power:
        power(out);
        break;
      case LawFamily::two_slopes:
      case LawFamily::two_powers:
        two_sides(out);
        break;
      case LawFamily::soft_sign:
        soft_sign(out);
        break;
      case LawFamily::falling:
        falling(out);
        break;
      case LawFamily::knee:
      case LawFamily::one_sided:
        knee(out);
        break;
      case LawFamily::levelling:
        levelling(out);
        break;
      case LawFamily::sliders:
        sliders(out);
        break;
      case LawFamily::maxwell:
        maxwell(out);
        break;
      case LawFamily::follows_load:
        follows_load(out);
        break;
      case LawFamily::along_stroke:
        along_stroke(out);
        break;
      case LawFamily::free_surface:
        free_surface(out);
        break;
    }
    return out;
  }

 private:
  /// A value with its interval, times a factor.
  [[nodiscard]] LawNumber number(std::string name, std::size_t value, double factor = 1.0, double offset = 0.0) const {
    const std::size_t i = own_[value];
    const FreeParameter& p = fit_.parameters[i];
    const double u = p.get(fit_.hypothesis), half = half_widths_(static_cast<Eigen::Index>(i));
    double low = offset + factor * p.value(std::max(u - half, p.lower));
    double high = offset + factor * p.value(std::min(u + half, p.upper));
    if (low > high) std::swap(low, high);
    return {std::move(name), offset + factor * p.value(u), low, high};
  }
  [[nodiscard]] const char* symbol() const { return law_.over == CurveOver::velocity ? "v" : "x"; }

  void power(DescribedLaw& out) const { power(out, 1); }

  /// Sides that differ by less than a reader cares for: one power, whose exponent is the last value.
  void power(DescribedLaw& out, std::size_t exponent) const {
    out.shape = "power law";
    out.numbers.push_back(number("exponent", exponent));
    const double scale = std::pow(law_.rms, -law_.values[exponent]);
    out.numbers.push_back(number("coefficient", 0, scale));
    const LawNumber& p = out.numbers.front();
    const double half = 0.5 * (p.upper - p.lower);
    const int digits = half < 0.005 ? 3 : 2;
    out.words = formatted("grows with |%s|^%.*f ± %.*f", symbol(), digits, p.value, digits, half);
  }

  /// The force of rig and law together at x, towards rest.
  [[nodiscard]] double total(const PlacedLaw& law, double x) const { return slope_ * x + law.force(x); }

  /// In per cent, how much larger the force is at −2r than at 2r.
  [[nodiscard]] double harder(const PlacedLaw& law) const {
    const double x = std::min(2.0 * law.rms, law.largest), push = total(law, x);
    return push != 0.0 ? 100.0 * (-total(law, -x) / push - 1.0) : 0.0;
  }

  void two_sides(DescribedLaw& out) const {
    const bool powers = law_.family == LawFamily::two_powers;
    out.shape = powers ? "asymmetric power law" : "asymmetric";
    if (powers) out.numbers.push_back(number("exponent", 2));
    const double base = powers ? 0.0 : slope_;
    out.numbers.push_back(number("compression", 0, 1.0 / law_.rms, base));
    out.numbers.push_back(number("rebound", 1, 1.0 / law_.rms, base));
    double half = 0.0;  // as far as either force alone moves it
    for (std::size_t v = 0; v < 2; ++v) {
      PlacedLaw moved = law_;
      moved.values[v] +=
          0.5 * law_.rms * (out.numbers[powers ? v + 1 : v].upper - out.numbers[powers ? v + 1 : v].lower);
      half = std::max(half, std::abs(harder(moved) - harder(law_)));
    }
    const double more = harder(law_);
    if (powers && std::abs(more) < thresholds::same_on_both_sides) {  // [%]
      out.numbers.clear();
      power(out, 2);
      return;
    }
    out.numbers.push_back({"rebound_harder_by_per_cent", more, more - half, more + half});
    out.words = formatted("rebound %.0f %% %s than compression", std::abs(more), more > 0.0 ? "harder" : "softer");
    if (powers) out.words += formatted(", with |%s|^%.2f", symbol(), law_.values[2]);
  }

  void soft_sign(DescribedLaw& out) const {
    out.shape = "smooth friction";
    out.numbers = {number("force", 0), number("velocity", 1)};
    out.words = formatted("friction of %s N that sets in over %.2g mm/s", figures(law_.values[0]).c_str(),
                          1e3 * law_.values[1]);
  }

  void falling(DescribedLaw& out) const {
    out.shape = "stribeck";
    double friction = 0.0;
    for (const firmware::PlacedEffect& effect : firmware::effects_of(fit_.hypothesis.rig)) {
      if (is_friction(effect)) friction = effect.values.front();
    }
    out.numbers = {
        {"break_away", friction, friction, friction}, number("sliding", 0, -1.0, friction), number("velocity", 1)};
    out.words = formatted("breaks away at %s N, falls to %s N by %.2g mm/s (Stribeck)", figures(friction).c_str(),
                          figures(friction - law_.values[0]).c_str(), 2e3 * law_.values[1]);
  }

  void knee(DescribedLaw& out) const {
    const bool one_sided = law_.family == LawFamily::one_sided;
    const double below = one_sided ? slope_ : slope_ + law_.values[0] / law_.rms;
    const double above = slope_ + law_.values[1] / law_.rms;
    const bool stiffer = one_sided ? std::max(law_.values[0], law_.values[1]) > 0.0 : above > below;
    out.shape = stiffer ? "progressive" : "degressive";
    out.numbers = {number("from", 2), number(one_sided ? "compression" : "slope_below", 0, 1.0 / law_.rms, slope_),
                   number(one_sided ? "rebound" : "slope_above", 1, 1.0 / law_.rms, slope_)};
    out.words = formatted("%s from %.3g %s on", stiffer ? "stiffens" : "gives way", 1e3 * law_.values[2],
                          law_.over == CurveOver::velocity ? "mm/s" : "mm");
  }

  void levelling(DescribedLaw& out) const {
    const double at_rest = law_.values[0] / law_.rms;
    const double end = 1.0 + law_.largest / law_.values[1], at_end = slope_ + at_rest / (end * end);
    out.shape = at_rest > 0.0 ? "degressive" : "progressive";
    out.numbers = {number("slope_at_rest", 0, 1.0 / law_.rms, slope_), number("half_at", 1, std::sqrt(2.0) - 1.0)};
    out.words = slope_words(out.shape.c_str(), slope_ + at_rest, at_end);
  }

  [[nodiscard]] std::string slope_words(const char* shape, double at_rest, double at_end) const {
    const bool velocity = law_.over == CurveOver::velocity;
    return formatted("%s all along: %s %s at rest, %s at %.3g %s", shape, figures(at_rest).c_str(),
                     velocity ? "N s/m" : "N/m", figures(at_end).c_str(), 1e3 * law_.largest, velocity ? "mm/s" : "mm");
  }

  /// A slope of rig and law together, between points of the curve, with what is known of it.
  struct Slope {
    double value, half;
  };
  [[nodiscard]] Slope slope_between(const DescribedLaw& out, std::size_t a, std::size_t b) const {
    const double run = out.at[b] - out.at[a];
    const auto half = [&](std::size_t k) { return 0.5 * (out.upper[k] - out.lower[k]); };
    return {slope_ + (out.force[b] - out.force[a]) / run, std::hypot(half(a), half(b)) / std::abs(run)};
  }

  /// A free curve by its slopes at rest and at its ends, and by the difference of its sides.
  void free_curve(DescribedLaw& out) const {
    out.shape = "curve";
    out.words = "no simple shape";
    const auto zero = static_cast<std::size_t>(std::lower_bound(out.at.begin(), out.at.end(), 0.0) - out.at.begin());
    const std::size_t last = out.at.size() - 1;
    if (zero < 4 || last - zero < 4) return;
    int falls = 0, rises = 0;
    double at_rest = 0.0, at_end = 0.0;
    for (const std::size_t end : {std::size_t{0}, last}) {
      const std::size_t inner = end == 0 ? zero - 2 : zero + 2, outer = end == 0 ? 2 : last - 2;
      const Slope first = slope_between(out, zero, inner), second = slope_between(out, outer, end);
      const double certain = std::hypot(first.half, second.half);
      falls += second.value < first.value - certain ? 1 : 0;
      rises += second.value > first.value + certain ? 1 : 0;
      at_rest += 0.5 * first.value;
      at_end += 0.5 * second.value;
    }
    const double more = harder(law_);
    PlacedLaw moved = law_;  // either end, by its half width
    for (std::size_t k = 0; k < moved.values.size(); ++k)
      moved.values[k] += out.at[k] < 0.0 ? 0.5 * (out.upper[k] - out.lower[k]) : 0.0;
    const double half = std::sqrt(2.0) * std::abs(harder(moved) - more);
    const bool lopsided = std::abs(more) > half;
    if (falls == 2 || rises == 2) {
      out.shape = falls == 2 ? "degressive" : "progressive";
      out.words = slope_words(out.shape.c_str(), at_rest, at_end);
    } else if (lopsided) {
      out.shape = "asymmetric";
      out.words.clear();
    }
    if (!lopsided) return;
    out.numbers.push_back({"rebound_harder_by_per_cent", more, more - half, more + half});
    out.words += formatted("%srebound %.0f %% %s than compression", out.words.empty() ? "" : "; ", std::abs(more),
                           more > 0.0 ? "harder" : "softer");
  }

  /// The end of the curve, at which every slider slides.
  [[nodiscard]] static LawNumber end_of(const DescribedLaw& out, std::string name, double factor = 1.0) {
    return {std::move(name), factor * out.force.back(), factor * out.lower.back(), factor * out.upper.back()};
  }

  void sliders(DescribedLaw& out) const {
    out.shape = "hysteresis";
    out.numbers = {end_of(out, "force")};
    const double all = out.numbers[0].value;
    // Travel in which a curve reaches half of it; that of the ends of the band are the ends of its interval.
    const auto half_of = [&](const std::vector<double>& force) {
      double half = out.at.back();
      for (std::size_t k = out.at.size(); k-- > 0 && out.at[k] > 0.0 && force[k] >= 0.5 * all;) half = out.at[k];
      return half;
    };
    out.numbers.push_back({"half_travel", half_of(out.force), half_of(out.upper), half_of(out.lower)});
    out.words = formatted("hysteresis of %s N independent of frequency (elastic sliders), half of it within %.2g mm",
                          figures(all).c_str(), 1e3 * out.numbers.back().value);
    if (!(law_.gap > 0.0)) return;
    out.numbers.push_back(number("lost_motion", law_.values.size()));
    out.words += formatted(", after each reversal %.2g mm of lost motion", 1e3 * law_.gap);
  }

  void maxwell(DescribedLaw& out) const {
    // The effect that is one such branch lends its name.
    out.shape = firmware::find_effect_that([](const auto& e) { return e.force.form == model::Form::relaxing; })->name;
    out.numbers = {end_of(out, "stiffness", 1.0 / out.at.back())};
    double shortest = INFINITY, longest = 0.0;
    for (std::size_t i = 0; i < law_.at.size(); ++i) {
      if (!(law_.values[i] > 0.0)) continue;
      shortest = std::min(shortest, law_.at[i]);
      longest = std::max(longest, law_.at[i]);
    }
    out.numbers.push_back({"time_constant", std::sqrt(shortest * longest), shortest, longest});
    out.words = shortest == longest ? formatted("relaxes within %.2g ms", 1e3 * longest)
                                    : formatted("relaxes within %.2g to %.2g ms", 1e3 * shortest, 1e3 * longest);
  }

  void follows_load(DescribedLaw& out) const {
    out.shape = "follows the load";
    if (!(fit_.hypothesis.rig.suspension.stiffness > 0.0)) {  // without a spring there is no load to have a share of
      out.numbers = {number("force_at_rms_travel", 0), number("velocity", 1)};
      out.words = formatted("friction grows with the travel: %s N at %.3g mm",
                            figures(out.numbers.front().value).c_str(), 1e3 * law_.rms);
      return;
    }
    const double per_load = 1.0 / (law_.rms * fit_.hypothesis.rig.suspension.stiffness);
    out.numbers = {number("share_of_load", 0, per_load), number("velocity", 1)};
    out.words = formatted("friction follows the load: %.2g %% of it", 100.0 * out.numbers.front().value);
  }

  void along_stroke(DescribedLaw& out) const {
    out.shape = "along the stroke";
    const double end = std::pow(law_.largest / law_.rms, law_.values[1]) / law_.rms_velocity;
    out.numbers = {number("exponent", 1), number("damping_at_the_end", 0, end)};
    const double more = out.numbers.back().value;
    out.words =
        formatted("damping %s along the stroke: %s N s/m %s at %.3g mm, with |x|^%.2g", more > 0.0 ? "grows" : "falls",
                  figures(std::abs(more)).c_str(), more > 0.0 ? "more" : "less", 1e3 * law_.largest, law_.values[1]);
  }

  /// Where most of the stroke ends.
  [[nodiscard]] double end_of_stroke() const { return std::min(2.0 * law_.rms, law_.largest); }

  /// By what it adds to damping and spring at both ends of what is mostly excited, and at rest.
  void free_surface(DescribedLaw& out) const {
    out.shape = "surface";
    const double end = end_of_stroke(), q = law_.rms_velocity;
    const auto damping = [q](double x) {
      return [x, q](const PlacedLaw& law) { return (law.force(x, q) - law.force(x, -q)) / (2.0 * q); };
    };
    const auto spring = [](double x) { return [x](const PlacedLaw& law) { return law.force(x, 0.0); }; };
    out.numbers = {known_of("damping_extended", damping(-end)), known_of("damping_at_rest", damping(0.0)),
                   known_of("damping_compressed", damping(end)), known_of("force_extended", spring(-end)),
                   known_of("force_compressed", spring(end))};
    out.words = formatted("adds %s N s/m of damping at −%.3g mm, %s at rest, %s at %.3g mm",
                          figures(out.numbers[0].value).c_str(), 1e3 * end, figures(out.numbers[1].value).c_str(),
                          figures(out.numbers[2].value).c_str(), 1e3 * end);
  }

  /// A number that follows from the law, with its interval.
  template <class NumberOf>
  [[nodiscard]] LawNumber known_of(std::string name, const NumberOf& number_of) const {
    const double value = number_of(law_);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(half_widths_.size());
    for (const std::size_t p : own_) {
      PlacedLaw moved = law_;
      const FreeParameter& parameter = fit_.parameters[p];
      moved.value(parameter.number) = parameter.value(parameter.get(fit_.hypothesis) + parameter.difference);
      change(static_cast<Eigen::Index>(p)) = (number_of(moved) - value) / parameter.difference;
    }
    double half = known_.half_width_of(change);
    if (!std::isfinite(half)) half = thresholds::widest_band * std::max(law_.size, std::abs(value));
    return {std::move(name), value, value - half, value + half};
  }

  void add_curve(DescribedLaw& out) const {
    const LawTable table = table_of(law_);
    out.at = table.at;
    out.force = table.value;
    for (std::size_t k = 0; k < table.at.size(); ++k) {
      const LawNumber force = known_of("", [x = table.at[k]](const PlacedLaw& law) { return law.force(x); });
      out.lower.push_back(force.lower);
      out.upper.push_back(force.upper);
    }
  }

  void add_sections(DescribedLaw& out) const {
    const model::SurfaceTable<double> table = surface_of(law_);
    const double slowest = table.velocity.front(), fastest = table.velocity[table.columns - 1U];
    constexpr int shown = 32;
    for (const double x : {-end_of_stroke(), 0.0, end_of_stroke()}) {
      LawSection section{x};
      for (int i = 0; i <= shown; ++i) {
        const double v = slowest + (fastest - slowest) * i / shown;
        const LawNumber force = known_of("", [x, v](const PlacedLaw& law) { return law.force(x, v); });
        section.at.push_back(v);
        section.force.push_back(force.value);
        section.lower.push_back(force.lower);
        section.upper.push_back(force.upper);
      }
      out.sections.push_back(std::move(section));
    }
  }

  const Fit& fit_;
  const Uncertainty& known_;
  const Eigen::VectorXd& half_widths_;
  const PlacedLaw& law_;
  std::vector<std::size_t> own_;  ///< its parameters
  double slope_ = 0.0;            ///< b
};

/// The force that the residual of a channel stands for at a place: that of the law plus it.
std::vector<double> force_error(const PreparedRecording& recording, const Response& readings, const Hypothesis& with,
                                CurvePlace place) {
  const bool driven = with.rig.kind == model::RigKind::driven_mass;
  const bool bench = with.rig.kind != model::RigKind::quarter_car && !driven;
  const bool wheel = place == CurvePlace::wheel_guide, guide = wheel || place == CurvePlace::body_guide;
  const Channel channel = place == CurvePlace::tyre ? Channel::F_w
                          : wheel                   ? Channel::zdd_w
                          : bench                   ? Channel::F
                                                    : Channel::zdd_b;
  if (!recording.explains(channel)) return {};
  double factor = 1.0;
  if (place != CurvePlace::tyre && !bench) factor = wheel ? with.rig.wheel.mass : with.rig.body.mass;
  if (guide || driven) factor = -factor;  // a force that acts against the motion
  std::vector<double> error = readings[index(channel)];
  const std::vector<double>& measured = recording.recording[channel];
  for (std::size_t k = 0; k < error.size(); ++k) error[k] = factor * (measured[k] - error[k]);
  return error;
}

/// Force over motion, sample after sample, for as long a path as some turns through the whole range take.
void add_loop(const std::vector<double>& x, const std::vector<double>& force, Window window, DescribedLaw& out) {
  const double longest = thresholds::loop_turns * 2.0 * (out.highest - out.lowest);
  double path = 0.0;
  std::size_t end = window.from + 1;
  for (; end < window.to && path < longest; ++end) path += std::abs(x[end] - x[end - 1]);
  const std::size_t step = (end - window.from) / thresholds::points_shown + 1;
  for (std::size_t k = window.from; k < end; k += step) {
    out.loop_at.push_back(x[k]);
    out.loop_force.push_back(force[k]);
  }
}

/// Which way sliders pull harder, from what the law leaves of the force.
void add_sides(const std::vector<double>& law, const std::vector<double>& error, Window window, DescribedLaw& out) {
  std::vector<double> measured = law;
  for (std::size_t k = 0; k < std::min(law.size(), error.size()); ++k) measured[k] += error[k];
  const auto sides = sliding_sides(law, measured, window, out.force.back());
  if (!sides) return;
  out.numbers.push_back(sides->more);
  const double more = sides->more.value;
  out.words += formatted("; rebound %.0f %% %s than compression, or F is off by %s N", std::abs(more),
                         more > 0.0 ? "harder" : "softer", figures(sides->offset).c_str());
}

/// Points behind the curve, of a window that is held out, else fitted: the law's force at the simulated motion plus
/// what the residual says.
void add_points(const IdentificationProblem& problem, const Hypothesis& hypothesis, DescribedLaw& out) {
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    const Window window = r.is_held_out() ? r.held_out : r.fitted;
    if (window.size() == 0) continue;
    const Response readings =
        read_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], window.to, r.resolution());
    const std::vector<double> x = motion_at(*r.samples, readings, out.law.place, out.law.over);
    const std::vector<double> force = out.law.forces_along(x, r.samples->input.period);
    const std::vector<double> error = force_error(*r.samples, readings, hypothesis, out.law.place);
    if (error.empty()) return;
    const std::size_t step = std::max<std::size_t>(window.size() / thresholds::points_shown, 1);
    for (std::size_t k = window.from; k < std::min({window.to, x.size(), error.size()}); k += step) {
      out.seen_at.push_back(x[k]);
      out.seen_force.push_back(force[k] + error[k]);
    }
    if (has_memory(out.law.family)) add_loop(x, force, {window.from, std::min(window.to, x.size())}, out);
    if (out.law.family == LawFamily::sliders) add_sides(force, error, window, out);
    return;
  }
}

}  // namespace

std::vector<DescribedLaw> described_curves(const IdentificationProblem& problem,
                                           const firmware::RigDescription& description, const Hypothesis& hypothesis) {
  std::vector<DescribedLaw> list;
  for (const firmware::LawDescription& own : description.laws) {
    if (own.curve == firmware::LawDescription::none) continue;
    const auto& table = description.rig.laws.curves[own.curve];
    if (table.place != model::LawPlace::suspension && table.place != model::LawPlace::tyre) continue;
    DescribedLaw out;
    out.words = own.name;
    out.law.place = table.place == model::LawPlace::tyre ? CurvePlace::tyre : CurvePlace::suspension;
    out.law.over = table.over == model::LawOver::velocity ? CurveOver::velocity : CurveOver::deflection;
    out.law.at.assign(table.at.begin(), table.at.begin() + table.count);
    out.law.values.assign(table.value.begin(), table.value.begin() + table.count);
    const auto range = excited_range(problem, hypothesis, out.law.place, out.law.over);
    if (!range) continue;
    out.lowest = range->lowest;
    out.highest = range->highest;
    const model::Curve<double> curve(table.at, table.value, table.count);
    constexpr int shown = 200;
    const double first = std::min(table.at.front(), range->lowest);
    const double last = std::max(table.at[table.count - 1U], range->highest);
    for (int i = 0; i <= shown; ++i) {
      out.at.push_back(first + (last - first) * i / shown);
      out.force.push_back(curve(out.at.back()));
    }
    add_points(problem, hypothesis, out);
    list.push_back(std::move(out));
  }
  return list;
}

std::vector<DescribedLaw> describe_laws(const IdentificationProblem& problem, const Fit& fit,
                                        const Uncertainty& known) {
  std::vector<DescribedLaw> list;
  for (std::size_t l = 0; l < fit.hypothesis.laws.size(); ++l) {
    DescribedLaw law = LawDescription(fit, known, l).described();
    if (const auto range = excited_range(problem, fit.hypothesis, law.law.place, law.law.over)) {
      law.lowest = range->lowest;
      law.highest = range->highest;
    }
    add_points(problem, fit.hypothesis, law);
    list.push_back(std::move(law));
  }
  return list;
}

}  // namespace host_sim::identification
