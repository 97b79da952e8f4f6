#include "host_sim/transfer/posterior/posterior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/estimate/uncertainty_sources.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/least_squares/gram.hpp"
#include "host_sim/transfer/common/statistics.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"

namespace host_sim::transfer {

using identification::Fit;
using identification::FreeParameter;
using identification::Hypothesis;
using identification::IdentificationProblem;
using Role = identification::FreeParameter::Role;

namespace {

Eigen::VectorXd bounds_of(const std::vector<FreeParameter>& parameters, bool upper) {
  Eigen::VectorXd bounds(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    bounds(static_cast<Eigen::Index>(i)) = upper ? parameters[i].upper : parameters[i].lower;
  }
  return bounds;
}

/// Into the box, and reflected at its sides: a stretched draw beyond a bound is a value inside.
Eigen::VectorXd reflected(const ComponentModel& model, Eigen::VectorXd u) {
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    double& x = u(static_cast<Eigen::Index>(i));
    const double lower = model.parameters[i].lower, upper = model.parameters[i].upper;
    if (x < lower) x = std::min(2.0 * lower - x, upper);
    if (x > upper) x = std::max(2.0 * upper - x, lower);
  }
  return u;
}

/// Within thresholds::near_bound of the tolerance.
bool is_near_bound(const FreeParameter& parameter, double u) {
  const double edge = thresholds::near_bound * 0.5 * (parameter.upper - parameter.lower);
  return parameter.role == Role::tolerated && (u < parameter.lower + edge || u > parameter.upper - edge);
}

/// D of (3), relative to the covariance that a fit gives.
Eigen::VectorXd stretch_of(const IdentificationProblem& problem, const identification::SearchSpace& space,
                           const Fit& fit, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd half_widths = identification::uncertainty(problem, space.suspects, fit).half_widths;
  Eigen::VectorXd stretch = Eigen::VectorXd::Ones(covariance.rows());
  const auto count = static_cast<double>(fit.residual.size());
  const double excess = (fit.chi_squared / count - 1.0) * std::sqrt(0.5 * count);
  if (excess < thresholds::discrepancy_significance && !is_stepped_finely(fit.hypothesis.rig)) {
    return stretch;  // white residuals of a smooth rig: the likelihood is right as it is
  }
  for (Eigen::Index i = 0; i < stretch.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[static_cast<std::size_t>(i)];
    // What lies at a bound has no half width; its draws lie on one side, as far as the likelihood says.
    if (is_near_bound(parameter, parameter.get(fit.hypothesis))) continue;
    const double deviation = std::sqrt(covariance(i, i));
    const double uniform =
        (parameter.upper - parameter.lower) / std::sqrt(12.0);  // of a prior that says more than data
    double wanted = half_widths(i) / 1.96;
    if (!std::isfinite(wanted) || (parameter.role == Role::tolerated && wanted > uniform)) wanted = uniform;
    const double ratio = wanted / std::max(deviation, 1e-300);
    if (ratio > thresholds::stretched_from) stretch(i) = std::min(ratio, 1e3);
  }
  return stretch;
}

double log_determinant(const Eigen::MatrixXd& covariance) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
  return factor.vectorD().array().abs().max(1e-300).log().sum();
}

double prior_width(const FreeParameter& parameter);

/// (JᵀJ/T + diag(12/width²))⁻¹, width: of the prior. Positive definite also where the recordings determine nothing; a
/// column of J that is no number tells nothing.
Eigen::MatrixXd covariance_of(const Fit& fit, double temper) {
  Eigen::MatrixXd j = fit.jacobian;
  for (Eigen::Index i = 0; i < j.cols(); ++i) {
    if (!j.col(i).allFinite()) j.col(i).setZero();
  }
  Eigen::MatrixXd h = gram(j) / temper;
  for (Eigen::Index i = 0; i < h.rows(); ++i) {
    const double width = prior_width(fit.parameters[static_cast<std::size_t>(i)]);
    h(i, i) += 12.0 / (width * width);
  }
  const Eigen::VectorXd scale = h.diagonal().cwiseSqrt().cwiseInverse();  // of parameters of many units
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * h * scale.asDiagonal());
  const Eigen::VectorXd inverse = solver.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  const Eigen::MatrixXd c = solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  return scale.asDiagonal() * c * scale.asDiagonal();
}

double prior_width(const FreeParameter& parameter) {
  const double width = parameter.upper - parameter.lower;
  return parameter.role == Role::tolerated ? width : std::min(width, thresholds::widest_prior);
}

/// A fit from a hypothesis with the effects it has: common parameters, faults, laws, effects.
Fit refitted(const IdentificationProblem& problem, const identification::SearchSpace& space, const Hypothesis& start,
             const std::vector<firmware::PlacedEffect>& effects) {
  std::vector<FreeParameter> parameters = space.common;
  for (auto& p : identification::fault_parameters(start.faults)) parameters.push_back(std::move(p));
  for (auto& p : identification::law_parameters(start.laws)) parameters.push_back(std::move(p));
  for (const auto& effect : effects) {
    for (auto& p : identification::effect_parameters(effect)) parameters.push_back(std::move(p));
  }
  return identification::fit(problem, start, std::move(parameters));
}

std::vector<firmware::PlacedEffect> with_values_of(const Hypothesis& hypothesis,
                                                   std::vector<firmware::PlacedEffect> effects) {
  const auto now = firmware::effects_of(hypothesis.rig);
  for (auto& effect : effects) {
    for (const auto& other : now) {
      if (other.entry == effect.entry && other.channel == effect.channel) effect.values = other.values;
    }
  }
  return effects;
}

/// Rivals whose odds are open, and one effect more where that gains something: each with its evidence.
void add_other_models(const IdentificationProblem& problem, const identification::SearchSpace& space,
                      const identification::SearchResult& found, double temper, const TransferProgress& progress,
                      std::vector<ComponentModel>& models) {
  const identification::SelectionCriterion criterion;
  const double own = found.best.penalised_chi_squared(criterion);
  const auto add = [&](const Hypothesis& start, std::vector<firmware::PlacedEffect> effects, std::string name,
                       double log_prior) {
    if (progress) progress(0.5, name);
    effects = with_values_of(start, std::move(effects));
    Fit fit = refitted(problem, space, start, effects);
    if (!std::isfinite(fit.chi_squared)) return;
    ComponentModel model = laplace_model(problem, space, std::move(fit), temper);
    model.name = std::move(name);
    model.effects = with_values_of(model.hypothesis, std::move(effects));
    model.log_evidence += log_prior;
    models.push_back(std::move(model));
  };
  std::size_t rivals = 0;
  for (std::size_t i = 0; i < found.causes.size(); ++i) {
    for (const identification::Rival& rival : found.causes[i].rivals) {
      const double log_odds = 0.5 * (rival.penalised_chi_squared - own) / temper;
      if (log_odds > std::log(thresholds::open_odds) || rivals >= thresholds::most_rivals) continue;
      std::vector<firmware::PlacedEffect> effects = found.best.effects;
      const std::string instead = identification::words(effects[i]);
      effects[i] = rival.effect;
      add(rival.hypothesis, effects, identification::words(rival.effect) + " in the place of " + instead, 0.0);
      ++rivals;
    }
  }
  IdentificationProblem same = problem;
  const identification::ModelFitter fitter(same, space.common, criterion);
  identification::CandidateModel base = found.best;
  base.fit = models.front().hypothesis.laws.empty()
                 ? identification::fit(problem, models.front().hypothesis, models.front().parameters, 1)
                 : Fit{};
  if (base.fit.parameters.empty() && !models.front().parameters.empty())
    return;  // beside a learned law no effect is tried
  identification::refresh_jacobian(problem, base.fit);
  std::size_t extensions = 0;
  for (const identification::CandidateModel& more :
       fitter.extended(base, found.scales, 2 * thresholds::most_extensions, thresholds::worth_refitting * temper)) {
    if (more.effects.empty() || extensions >= thresholds::most_extensions) break;
    if (!travels(*more.effects.back().entry)) continue;
    add(more.fit.hypothesis, more.effects, identification::words(more.effects.back()) + " beside what was named",
        std::log(thresholds::one_more_effect / static_cast<double>(thresholds::most_extensions)));
    ++extensions;
  }
}

void set_probabilities(std::vector<ComponentModel>& models) {
  double highest = models.front().log_evidence, sum = 0.0;
  for (const ComponentModel& m : models) highest = std::max(highest, m.log_evidence);
  for (ComponentModel& m : models) sum += m.probability = std::exp(m.log_evidence - highest);
  for (ComponentModel& m : models) m.probability /= sum;
}

/// Draws of the Laplace approximation, inside the bounds.
void draw_laplace(ComponentModel& model, std::size_t count, std::uint64_t seed) {
  firmware::Gaussian normal(seed, 73);
  const Eigen::LLT<Eigen::MatrixXd> factor(model.covariance);
  const Eigen::MatrixXd root = factor.matrixL();
  model.draws.resize(model.mode.size(), static_cast<Eigen::Index>(count));
  for (Eigen::Index i = 0; i < model.draws.cols(); ++i) {
    const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(model.mode.size(), [&] { return normal(); });
    model.draws.col(i) = reflected(model, model.mode + root * z);
  }
}

std::string unit_of(const FreeParameter& parameter) {
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    if (parameter.path == std::string(p.table) + "." + std::string(p.key)) return std::string(p.unit);
  }
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    if (!parameter.path.starts_with("effects." + std::string(entry.name) + ".")) continue;
    for (const auto& card : entry.parameters) {
      if (parameter.path.ends_with("." + std::string(card.name))) return std::string(card.unit);
    }
  }
  return "";
}

/// A learned law of the suspension that holds any multiple of what the parameter does: "velocity", "deflection"; empty:
/// none. The family of the law decides how much of the force it takes, and no record tells whether the family is right.
std::string law_beside(const FreeParameter& parameter, const Hypothesis& hypothesis) {
  using identification::CurveOver;
  if (parameter.role != Role::tolerated) return "";
  const bool of_damper = parameter.path == "suspension.damping";
  const bool of_spring = parameter.path == "suspension.stiffness";
  for (const identification::PlacedLaw& law : hypothesis.laws) {
    if (law.place != identification::CurvePlace::suspension) continue;
    const bool over_velocity = law.over == CurveOver::velocity || law.family == identification::LawFamily::along_stroke;
    const bool over_deflection = law.over == CurveOver::deflection || has_memory(law.family);
    const bool both = law.family == identification::LawFamily::free_surface;
    if (of_damper && (over_velocity || both)) return "velocity";
    if (of_spring && (over_deflection || both)) return "deflection";
  }
  return "";
}

/// (5) of a model at its mode. Tolerances that no fit has moved are drawn where the second rig is (predict/).
void find_calibration(const firmware::RigDescription& from, const IdentificationProblem& problem,
                      ComponentModel& model) {
  if (model.mode.size() == 0) return;
  Fit at_mode = identification::fit(problem, model.hypothesis, model.parameters, 0);
  identification::refresh_jacobian(problem, at_mode);
  auto sources = identification::uncertainty_sources(from, problem, at_mode);
  std::erase_if(sources, [](const identification::UncertaintySource& source) {
    return source.kind == identification::UncertaintySource::Kind::tolerance || !source.shift.allFinite();
  });
  model.calibration = identification::shifts_of(sources);
}

void describe(std::uint64_t seed, Posterior& posterior) {
  const ComponentModel& model = posterior.diagnosed();
  firmware::Gaussian normal(seed, 75);
  Eigen::MatrixXd draws = model.draws;
  for (Eigen::Index k = 0; k < draws.cols(); ++k) {
    draws.col(k) = model.with_calibration(draws.col(k), [&normal] { return normal(); });
  }
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const FreeParameter& parameter = model.parameters[i];
    if (parameter.role == Role::start) continue;
    const auto row = static_cast<Eigen::Index>(i);
    std::vector<double> values;
    for (Eigen::Index k = 0; k < model.draws.cols(); ++k) values.push_back(parameter.value(draws(row, k)));
    const Bands bands = bands_of(std::move(values));
    LearnedValue learned{
        name_of(parameter, model.hypothesis), unit_of(parameter), bands.median, bands.low95, bands.high95,
        travels(parameter, model.hypothesis)};
    if (const auto law = law_beside(parameter, model.hypothesis); !law.empty()) {
      learned.lower = parameter.value(parameter.lower);
      learned.upper = parameter.value(parameter.upper);
      posterior.confounded = 1.0;
      posterior.warnings.push_back(parameter.path + " and the learned law over the " + law +
                                   " are one force: only their sum is known and travels, and of " + parameter.path +
                                   " alone no more than its tolerance");
    }
    posterior.learned.push_back(learned);
    if (parameter.role != Role::tolerated) continue;
    double near = 0.0;
    for (Eigen::Index k = 0; k < model.draws.cols(); ++k)
      near += is_near_bound(parameter, model.draws(row, k)) ? 1.0 : 0.0;
    if (near <= thresholds::share_at_bound * static_cast<double>(model.draws.cols())) continue;
    posterior.at_bounds.push_back(parameter.path);
    posterior.warnings.push_back("the posterior of " + parameter.path +
                                 " lies at the bounds of its tolerance: the tolerance is too narrow, or something "
                                 "else is mistaken for this parameter");
  }
}

std::string figure(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

Hypothesis ComponentModel::at(const Eigen::VectorXd& u) const {
  Hypothesis moved = hypothesis;
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].put(moved, u(static_cast<Eigen::Index>(i)));
  return moved;
}

Eigen::VectorXd ComponentModel::with_calibration(Eigen::VectorXd u, const std::function<double()>& normal) const {
  for (Eigen::Index i = 0; i < calibration.cols(); ++i) u += calibration.col(i) * normal();
  return calibration.cols() > 0 ? reflected(*this, std::move(u)) : u;
}

std::string name_of(const FreeParameter& parameter, const Hypothesis& hypothesis) {
  if (!parameter.path.empty()) return parameter.path;
  if (parameter.role == Role::law) {
    return "law at the " + std::string(identification::name(hypothesis.laws[parameter.law].place)) + ", value " +
           std::to_string(parameter.number + 1);
  }
  if (parameter.role == Role::fault) return "fault of the recording, value " + std::to_string(parameter.number + 1);
  return "start of recording " + std::to_string(parameter.recording + 1) + ", state " +
         std::to_string(parameter.state + 1);
}

ComponentModel laplace_model(const IdentificationProblem& problem, const identification::SearchSpace& space, Fit fit,
                             double temper) {
  identification::refresh_jacobian(problem, fit);
  ComponentModel model;
  model.hypothesis = fit.hypothesis;
  model.parameters = fit.parameters;
  model.chi_squared = fit.chi_squared;
  const auto d = static_cast<Eigen::Index>(fit.parameters.size());
  model.mode.resize(d);
  for (Eigen::Index i = 0; i < d; ++i) model.mode(i) = fit.parameters[static_cast<std::size_t>(i)].get(fit.hypothesis);
  model.log_evidence = -0.5 * fit.chi_squared / temper;
  if (d == 0) return model;
  const Eigen::MatrixXd plain = covariance_of(fit, temper);
  model.log_evidence += 0.5 * static_cast<double>(d) * std::log(2.0 * std::numbers::pi) + 0.5 * log_determinant(plain);
  for (const FreeParameter& parameter : fit.parameters) model.log_evidence -= std::log(prior_width(parameter));
  const Eigen::VectorXd stretch = stretch_of(problem, space, fit, plain);
  model.covariance = stretch.asDiagonal() * plain * stretch.asDiagonal();
  return model;
}

ChainReport sample_model(const IdentificationProblem& problem, double temper, const Discrepancy& discrepancy,
                         const SamplerOptions& options, ComponentModel& model) {
  if (model.mode.size() == 0) {
    model.draws.resize(0, 1);
    return {1.0, static_cast<double>(options.draws), 1.0, 1.0, ""};
  }
  const identification::Fit at_mode = [&] {
    identification::Fit fit = identification::fit(problem, model.hypothesis, model.parameters, 0);
    identification::refresh_jacobian(problem, fit);
    return fit;
  }();
  const Eigen::MatrixXd plain = covariance_of(at_mode, temper);
  const auto densities = [&](const std::vector<Eigen::VectorXd>& at) {
    std::vector<identification::Variation> variations;
    for (const Eigen::VectorXd& u : at) variations.push_back({model.at(u), std::nullopt});
    std::vector<double> values;
    for (const Eigen::VectorXd& r : identification::residuals_of_each(problem, variations, false, nullptr)) {
      values.push_back(-0.5 * r.squaredNorm() / temper);
    }
    return values;
  };
  const Samples samples = sample(densities, model.mode, plain, bounds_of(model.parameters, false),
                                 bounds_of(model.parameters, true), options);
  model.draws = samples.all();
  ChainReport report{samples.rhat.maxCoeff(), samples.effective.minCoeff(), samples.accepted, 1.0, ""};
  firmware::Gaussian normal(options.seed, 74);
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(plain.rows(), plain.cols());
  if (discrepancy.any()) {
    const Eigen::LLT<Eigen::MatrixXd> factor(
        discrepancy.widening + 1e-9 * Eigen::MatrixXd(discrepancy.widening.diagonal().cwiseMax(1e-300).asDiagonal()));
    root = factor.matrixL();
  }
  for (Eigen::Index i = 0; i < plain.rows(); ++i) {
    if (is_near_bound(model.parameters[static_cast<std::size_t>(i)], model.mode(i))) continue;  // one-sided
    const Eigen::VectorXd row = model.draws.row(i);
    const double sampled = std::sqrt((row.array() - row.mean()).square().mean());
    const double expected = std::min(std::sqrt(plain(i, i)), (model.parameters[static_cast<std::size_t>(i)].upper -
                                                              model.parameters[static_cast<std::size_t>(i)].lower) /
                                                                 std::sqrt(12.0));
    const double ratio = sampled / std::max(expected, 1e-300);
    if (std::abs(std::log(std::max(ratio, 1e-300))) > std::abs(std::log(report.largest_ratio))) {
      report.largest_ratio = ratio;
      report.worst = name_of(model.parameters[static_cast<std::size_t>(i)], model.hypothesis);
    }
  }
  for (Eigen::Index k = 0; k < model.draws.cols(); ++k) {
    Eigen::VectorXd u = model.draws.col(k);
    for (Eigen::Index i = 0; i < u.size(); ++i) {  // (3)
      u(i) = model.mode(i) + (u(i) - model.mode(i)) * std::sqrt(model.covariance(i, i) / plain(i, i));
    }
    const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(u.size(), [&] { return normal(); });
    model.draws.col(k) = reflected(model, u + root * z);  // (4)
  }
  if (discrepancy.any()) model.covariance += discrepancy.widening;
  return report;
}

Posterior find_posterior(const firmware::RigDescription& from, const identification::Identified& first,
                         std::size_t draws, std::uint64_t seed, const TransferProgress& progress) {
  Posterior posterior;
  // The diagnosis has chosen; the second rig validates. Nothing need be held out any more.
  const IdentificationProblem problem = first.problem.with_all_fitted();
  const identification::SearchSpace space = identification::untied(first.space, first.found.freed);
  const Fit& best = first.found.best.fit;
  Fit fit = identification::fit(problem, best.hypothesis, best.parameters);
  posterior.temper = identification::temper_of(fit);
  ComponentModel diagnosed = laplace_model(problem, space, fit, posterior.temper);
  diagnosed.name = "as diagnosed";
  diagnosed.effects = with_values_of(diagnosed.hypothesis, first.found.best.effects);
  if (diagnosed.mode.size() > 0) {
    identification::refresh_jacobian(problem, fit);
    posterior.discrepancy = find_discrepancy(problem, fit, covariance_of(fit, 1.0));
  }
  posterior.models.push_back(std::move(diagnosed));
  add_other_models(problem, space, first.found, posterior.temper, progress, posterior.models);
  set_probabilities(posterior.models);
  const double least = posterior.models.front().probability / thresholds::open_odds;
  posterior.models.erase(std::remove_if(posterior.models.begin() + 1, posterior.models.end(),
                                        [&](const ComponentModel& m) { return m.probability < least; }),
                         posterior.models.end());
  set_probabilities(posterior.models);
  SamplerOptions options{draws, seed, {}};
  if (progress) options.progress = [&](double share) { progress(share, "sampling"); };
  const ChainReport report =
      sample_model(problem, posterior.temper, posterior.discrepancy, options, posterior.models.front());
  posterior.draws = draws;
  posterior.largest_rhat = report.largest_rhat;
  posterior.fewest_effective = report.fewest_effective;
  posterior.accepted = report.accepted;
  const auto warn = [&](const std::string& text) { posterior.warnings.push_back(text); };
  if (report.largest_rhat > thresholds::largest_rhat) {
    warn("the chains have not converged: R-hat " + figure(report.largest_rhat) + ", expected below " +
         figure(thresholds::largest_rhat));
  }
  if (report.fewest_effective < thresholds::fewest_effective) {
    warn("only " + figure(report.fewest_effective) + " effective draws: the ends of the bands are uncertain");
  }
  if (std::abs(std::log(report.largest_ratio)) > std::log(thresholds::laplace_ratio)) {
    const bool narrower = report.largest_ratio > 1.0;
    warn("the Laplace approximation is " + figure(narrower ? report.largest_ratio : 1.0 / report.largest_ratio) +
         (narrower ? " times narrower" : " times wider") + " than the draws of " + report.worst +
         ": the draws are used");
  }
  const ComponentModel& model = posterior.models.front();
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!travels(model.parameters[i], model.hypothesis) || !posterior.discrepancy.any()) continue;
    posterior.confounded =
        std::max(posterior.confounded, posterior.discrepancy.widening(k, k) / model.covariance(k, k));
  }
  for (std::size_t i = 1; i < posterior.models.size(); ++i) {
    draw_laplace(posterior.models[i], thresholds::predictive_draws, seed + i);
  }
  const bool calibrated = std::any_of(from.calibration.begin(), from.calibration.end(),
                                      [](const auto& calibration) { return calibration.has_value(); });
  for (ComponentModel& each : posterior.models) {
    if (calibrated) find_calibration(from, problem, each);
  }
  describe(seed, posterior);
  return posterior;
}

ComponentModel naive_model(const firmware::RigDescription& /*from*/, const identification::Identified& first) {
  std::vector<identification::PreparedRecording> recordings = first.problem.samples();
  for (auto& r : recordings) {
    if (r.channels.size() > 1) std::erase(r.channels, model::Channel::x_act);
  }
  const Hypothesis given = first.space.given;
  const IdentificationProblem problem(std::move(recordings), given);
  std::set<std::string> tolerated;
  for (const FreeParameter& p : first.space.tolerated) tolerated.insert(p.path);
  std::vector<FreeParameter> parameters;
  for (const FreeParameter& p : first.space.suspects) {
    if (travels(p, given) && tolerated.count(p.path) > 0) parameters.push_back(p);
  }
  Fit fit = identification::fit(problem, given, parameters);
  identification::refresh_jacobian(problem, fit);
  ComponentModel model;
  model.name = "everything fitted with the first rig's own effects ignored";
  model.hypothesis = fit.hypothesis;
  model.parameters = fit.parameters;
  model.chi_squared = fit.chi_squared;
  model.mode.resize(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < model.mode.size(); ++i) {
    model.mode(i) = fit.parameters[static_cast<std::size_t>(i)].get(fit.hypothesis);
  }
  if (model.mode.size() > 0) {
    model.covariance = covariance_of(fit, identification::temper_of(fit));
    draw_laplace(model, thresholds::predictive_draws, 1);
  } else {
    model.draws.resize(0, 1);
  }
  return model;
}

}  // namespace host_sim::transfer
