#include "host_sim/identification/estimate/uncertainty.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/noise/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {
namespace {

using Index = Eigen::Index;

constexpr double of_normal = 1.96;  // 95 % of a normal distribution

/// One block: residuals and their derivatives by every parameter.
struct Block {
  std::size_t recording = 0;
  Window window{};
  double spread = 1.0;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

std::vector<Response> read_fitted(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  std::vector<Response> responses;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    responses.emplace_back();
    if (!r.is_fitted()) continue;
    responses.back() =
        read_channels(hypothesis, *r.samples, r.samples->input, hypothesis.starts[i], r.fitted.to, r.resolution());
  }
  return responses;
}

std::vector<Block> cut_into_blocks(const IdentificationProblem& problem) {
  double seconds = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (r.is_fitted()) seconds += static_cast<double>(r.fitted.size()) * r.samples->input.period;
  }
  const double each = std::max(seconds / thresholds::most_blocks, thresholds::shortest_block);
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    const double length = static_cast<double>(r.fitted.size()) * r.samples->input.period;
    const auto count = static_cast<std::size_t>(
        std::max(1.0, std::floor(length / std::max(each, static_cast<double>(thresholds::shortest_whitened) *
                                                             r.samples->compared_period()))));
    for (std::size_t b = 0; b < count; ++b) {
      Block& block = blocks.emplace_back();
      block.recording = i;
      block.window = {r.fitted.from + r.fitted.size() * b / count, r.fitted.from + r.fitted.size() * (b + 1) / count};
    }
  }
  return blocks;
}

Eigen::VectorXd whitened(const IdentificationProblem& problem, const Whitening& whitening, const Block& block,
                         const Response& response) {
  Eigen::VectorXd values(static_cast<Index>(whitening.count()));
  whitening.whiten(whitening.spectra(*problem.recordings()[block.recording].samples, response), values.data());
  return values;
}

/// A hypothesis with one parameter moved; nothing where that is no rig.
std::optional<Hypothesis> moved_in(const IdentificationProblem& problem, const Hypothesis& from,
                                   const FreeParameter& parameter, double by) {
  Hypothesis hypothesis = from;
  parameter.put(hypothesis, parameter.get(from) + by);
  if (firmware::find_rig_fault(hypothesis.rig, problem.sample_period())) return std::nullopt;
  return hypothesis;
}

/// Residuals and Jacobians of all blocks.
std::vector<Block> blocks_of(const IdentificationProblem& problem, const Fit& fit) {
  const Hypothesis& hypothesis = fit.hypothesis;
  const std::vector<FreeParameter>& parameters = fit.parameters;
  const std::vector<double> differences = last_differences(fit);
  std::vector<Block> blocks = cut_into_blocks(problem);
  const std::vector<Response> here = read_fitted(problem, hypothesis);
  std::vector<Whitening> whitenings;
  for (Block& block : blocks) {
    whitenings.push_back(problem.whitening(block.recording, block.window));
    block.spread = whitenings.back().spread();
    block.residual = whitened(problem, whitenings.back(), block, here[block.recording]);
    block.jacobian.setZero(block.residual.size(), static_cast<Index>(parameters.size()));
  }
  for_all(parameters.size(), [&](std::size_t p) {
    const double step = differences[p];
    const auto above = moved_in(problem, hypothesis, parameters[p], step),
               below = moved_in(problem, hypothesis, parameters[p], -step);
    if (!above && !below) return;
    const std::vector<Response> high = above ? read_fitted(problem, *above) : here,
                                low = below ? read_fitted(problem, *below) : here;
    const double apart = (above ? step : 0.0) + (below ? step : 0.0);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      Block& block = blocks[b];
      const Eigen::VectorXd column = (whitened(problem, whitenings[b], block, high[block.recording]) -
                                      whitened(problem, whitenings[b], block, low[block.recording])) /
                                     apart;
      if (column.allFinite()) block.jacobian.col(static_cast<Index>(p)) = column;
    }
  });
  return blocks;
}

/// Inverse of a symmetric matrix that may be singular: what is open becomes very wide.
Eigen::MatrixXd inverse(Eigen::MatrixXd matrix) {
  for (Index i = 0; i < matrix.rows(); ++i) matrix(i, i) += 1e-13 * matrix(i, i) + 1e-30;
  return matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

/// Relative change of a parameter for a unit of its coordinate, inverted.
double coordinate_of_relative(const FreeParameter& parameter, double u) {
  if (parameter.logarithmic || parameter.role == FreeParameter::Role::start) return 1.0;
  if (parameter.role == FreeParameter::Role::effect) return std::max(std::abs(u), 1e-6);
  return std::abs(parameter.value(u) / parameter.scale);
}

/// Degrees of freedom of as many blocks as count: those that hold no information about a combination do not. `shares`: of
/// each.
double freedom_of(const std::vector<double>& shares) {
  double sum = 0.0, squares = 0.0;
  for (const double share : shares) {
    sum += share;
    squares += share * share;
  }
  const double counting = squares > 0.0 ? sum * sum / squares : 1.0;
  return std::max(counting - 1.0, 2.0);
}

/// (4): how far the estimate moves without each frequency band of the fit's own residuals.
Eigen::MatrixXd band_shifts(const IdentificationProblem& problem, const Fit& fit) {
  const Index n = fit.jacobian.cols();
  Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(n, static_cast<Index>(noise_bands));
  std::vector<Eigen::MatrixXd> information(noise_bands, Eigen::MatrixXd::Zero(n, n));
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
  Index at = 0;
  for (const ProblemRecording& r : problem.recordings()) {
    if (!r.is_fitted()) continue;
    const auto each = static_cast<Index>(2 * r.samples->channels.size());
    for (std::size_t k = 0; k < r.fit_whitening->bins(); ++k, at += each) {
      const std::size_t b = std::min(noise_bands - 1, noise_band_of(r.fit_whitening->frequency(k)));
      const auto rows = fit.jacobian.middleRows(at, each);
      gradients.col(static_cast<Index>(b)) += rows.transpose() * fit.residual.segment(at, each);
      information[b] += rows.transpose() * rows;
    }
  }
  for (const Eigen::MatrixXd& of_band : information) whole += of_band;
  for (Index i = 0; i < n; ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const double width = p.upper - p.lower;
    whole(i, i) += (p.role == FreeParameter::Role::tolerated ? 12.0 / (width * width) : 0.0);
  }
  Eigen::MatrixXd shifts(n, static_cast<Index>(noise_bands));
  Index bands = 0;
  for (std::size_t b = 0; b < noise_bands; ++b) {
    if (!(information[b].trace() > 0.0)) continue;
    const Eigen::MatrixXd without = whole - information[b];
    shifts.col(bands++) = inverse(without) * gradients.col(static_cast<Index>(b));
  }
  if (bands < 3) return {};
  return shifts.leftCols(bands);
}

/// (6), with its sign
Eigen::VectorXd step_shift(const IdentificationProblem& problem, const Fit& fit) {
  if (!has_corners(fit.hypothesis.rig)) return Eigen::VectorXd::Zero(fit.jacobian.cols());
  const Eigen::VectorXd change = residuals(problem, predict(problem, fit.hypothesis, true)) -
                                 residuals(problem, predict(problem, fit.hypothesis, false));
  return fit.covariance() * (fit.jacobian.transpose() * change);
}

/// Vectors with few entries that span the same space: each has an entry of 1 where the others have none.
Eigen::MatrixXd sparse_basis(Eigen::MatrixXd vectors) {
  std::vector<Index> pivots;
  for (Index c = 0; c < vectors.cols(); ++c) {
    Index pivot = 0;
    double most = 0.0;
    for (Index r = 0; r < vectors.rows(); ++r) {
      if (std::find(pivots.begin(), pivots.end(), r) != pivots.end()) continue;
      if (std::abs(vectors(r, c)) <= most) continue;
      most = std::abs(vectors(r, c));
      pivot = r;
    }
    if (!(most > 0.0)) continue;
    pivots.push_back(pivot);
    vectors.col(c) /= vectors(pivot, c);
    for (Index other = 0; other < vectors.cols(); ++other) {
      if (other != c) vectors.col(other) -= vectors(pivot, other) * Eigen::VectorXd(vectors.col(c));
    }
  }
  return vectors;
}

bool ends_with_one_of(const std::string& name, std::initializer_list<std::string_view> endings) {
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return name.ends_with(ending); });
}

/// The names, with "all stiffnesses and dampings" for these where none is missing.
std::string list_of(const std::vector<std::string>& inside, const std::vector<std::string>& names) {
  const auto is_force_law = [](const std::string& name) { return ends_with_one_of(name, {"stiffness", "damping"}); };
  const auto all = std::count_if(names.begin(), names.end(), is_force_law);
  const auto held = std::count_if(inside.begin(), inside.end(), is_force_law);
  std::vector<std::string> list;
  const bool shortened = all > 2 && all == held;
  for (const std::string& name : inside) {
    if (!shortened || !is_force_law(name)) list.push_back(name);
  }
  if (shortened) list.emplace_back("all stiffnesses and dampings");
  return joined(list);
}

/// True if a unit contains the unit of mass: N, N/m, N s/m, kg, kg/m³, Pa.
bool holds_mass(std::string_view unit) {
  return unit.starts_with("N") || unit.starts_with("kg") || unit.starts_with("Pa");
}

/// The unit of a parameter by its path, of the rig or of one of its effects.
std::string_view unit_of_path(const Hypothesis& hypothesis, const std::string& path) {
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    if (path == std::string(p.table) + "." + std::string(p.key)) return p.unit;
  }
  for (const firmware::PlacedEffect& effect : firmware::effects_of(hypothesis.rig)) {
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      if (path == firmware::effect_path(effect, i)) return effect.entry->parameters[i].unit;
    }
  }
  return "";
}

/// The information along the coordinates of a fit: of the data alone, and with the tolerances.
struct Informed {
  Eigen::MatrixXd directions;  ///< a column for each coordinate: without (7), where that is open
  Eigen::MatrixXd of_data, with_tolerance;
  std::vector<Undetermined> undetermined;
};

/// (7) in coordinates of the fit: by how much each moves for a relative change.
Eigen::VectorXd mass_scale(const Fit& fit) {
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(static_cast<Index>(fit.parameters.size()));
  for (Index i = 0; i < scale.size(); ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    if (p.role == FreeParameter::Role::start || !holds_mass(unit_of_path(fit.hypothesis, p.path))) continue;
    const double u = p.get(fit.hypothesis);
    scale(i) = p.logarithmic ? 1.0 : p.role == FreeParameter::Role::effect ? u : p.value(u) / p.scale;
  }
  return scale;
}

/// The combinations of parameters that the data leave open beside (7): null vectors of the information in relative
/// changes, in words.
std::vector<Undetermined> null_vectors(const Fit& fit, const Eigen::MatrixXd& information, bool measures_force) {
  std::vector<std::string> names;
  std::vector<Index> kept;
  for (Index i = 0; i < information.rows(); ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    if (p.path.empty()) continue;  // states at the start, faults of the recording: nobody asks for these
    kept.push_back(i);
    names.push_back(p.path);
  }
  const auto m = static_cast<Index>(kept.size());
  if (m == 0) return {};
  Eigen::MatrixXd relative(m, m);
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < m; ++j) {
      const Index a = kept[static_cast<std::size_t>(i)], b = kept[static_cast<std::size_t>(j)];
      const auto unit = [&](Index k) {
        const FreeParameter& p = fit.parameters[static_cast<std::size_t>(k)];
        return coordinate_of_relative(p, p.get(fit.hypothesis));
      };
      relative(i, j) = unit(a) * unit(b) * information(a, b);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(relative);
  Index count = 0;  // ascending eigenvalues
  while (count < m && eigen.eigenvalues()(count) < std::pow(thresholds::undetermined_deviation, -2)) ++count;
  return in_words(eigen.eigenvectors().leftCols(count), names, measures_force);
}

/// Every parameter that (7) moves, in words.
Undetermined scale_in_words(const Fit& fit, const std::vector<FreeParameter>& every) {
  std::vector<std::string> names;
  for (const std::vector<FreeParameter>* list : {&every, &fit.parameters}) {
    for (const FreeParameter& p : *list) {
      const bool listed = std::find(names.begin(), names.end(), p.path) != names.end();
      if (p.role == FreeParameter::Role::start || listed) continue;
      if (holds_mass(unit_of_path(fit.hypothesis, p.path))) names.push_back(p.path);
    }
  }
  return {list_of(names, names) + " in one ratio", "no force is measured"};
}

Informed informed_by(const IdentificationProblem& problem, const std::vector<FreeParameter>& every, const Fit& fit,
                     const Eigen::MatrixXd& information) {
  const auto fitted = static_cast<Index>(fit.parameters.size());
  const auto is_force = [](model::Channel channel) { return model::unit(channel) == "N"; };
  const bool measures_force =
      std::any_of(problem.channels().begin(), problem.channels().end(), is_force) ||
      std::any_of(problem.samples().begin(), problem.samples().end(), [](const PreparedRecording& r) {
        return r.input.is_force() || !r.input.actuator_force.empty();  // what drives the rig is measured, too
      });
  const Eigen::VectorXd scale = mass_scale(fit);
  // A described value without a tolerance is exact: one of them holds the scale.
  const bool all_fitted = std::all_of(every.begin(), every.end(), [&](const FreeParameter& p) {
    const auto same = [&](const FreeParameter& other) { return other.path == p.path; };
    return !holds_mass(unit_of_path(fit.hypothesis, p.path)) ||
           std::any_of(fit.parameters.begin(), fit.parameters.end(), same);
  });
  const bool open = !measures_force && all_fitted && scale.squaredNorm() > 0.0;
  Informed informed;
  informed.directions = Eigen::MatrixXd::Identity(fitted, fitted);
  informed.of_data = information;
  if (!open) {
    informed.undetermined = null_vectors(fit, information, measures_force);
  } else {
    informed.undetermined.push_back(scale_in_words(fit, every));
    // Without what differences at corners make of a change that changes nothing.
    informed.directions -= scale * scale.transpose() / scale.squaredNorm();
    informed.of_data = informed.directions.transpose() * information * informed.directions;
  }
  informed.with_tolerance = informed.of_data;
  for (Index i = 0; i < fitted; ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const double width = p.upper - p.lower;
    if (p.role == FreeParameter::Role::tolerated) informed.with_tolerance(i, i) += 12.0 / (width * width);
  }
  return informed;
}

}  // namespace

double student(double degrees_of_freedom) {
  constexpr double z = 1.959964;
  const double n = degrees_of_freedom;
  return z + (std::pow(z, 3) + z) / (4.0 * n) +
         (5.0 * std::pow(z, 5) + 16.0 * std::pow(z, 3) + 3.0 * z) / (96.0 * n * n);
}

std::vector<Undetermined> in_words(const Eigen::MatrixXd& vectors, const std::vector<std::string>& names,
                                   bool measures_force) {
  const Eigen::MatrixXd basis = sparse_basis(vectors);
  std::vector<Undetermined> list;
  std::vector<std::string> alone;
  for (Index k = 0; k < basis.cols(); ++k) {
    const double most = basis.col(k).cwiseAbs().maxCoeff();
    if (!(most > 0.0)) continue;
    std::vector<std::string> inside;
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (Index i = 0; i < basis.rows(); ++i) {
      const double entry = basis(i, k) / most;
      if (std::abs(entry) < thresholds::least_entry) continue;
      inside.push_back(names[static_cast<std::size_t>(i)]);
      least = std::min(least, entry);
      greatest = std::max(greatest, entry);
    }
    if (inside.size() == 1) {
      alone.push_back(inside.front());
      continue;
    }
    const bool alike = least * greatest > 0.0 && std::abs(greatest - least) < thresholds::alike_entries;
    const bool with_mass =
        std::any_of(inside.begin(), inside.end(), [](const std::string& name) { return name.ends_with("mass"); });
    list.push_back({list_of(inside, names) + (alike ? " in one ratio" : ", one against the other"),
                    alike && with_mass && !measures_force ? "no force is measured"
                                                          : "the measured channels do not tell them apart"});
  }
  if (!alone.empty()) {
    list.push_back({joined(alone) + (alone.size() > 1 ? ", each" : ""), "the measured channels hardly change with it"});
  }
  return list;
}

double Uncertainty::half_width_of(const Eigen::VectorXd& g) const {
  double half = of_normal * std::sqrt(std::max(g.dot(covariance * g), 0.0));
  if (block_shares.cols() > 0) {
    std::vector<double> shares;
    for (const Eigen::MatrixXd& of_block : information) shares.push_back(g.dot(of_block * g));
    const auto count = static_cast<double>(block_shares.cols());
    const double variance = (block_shares.transpose() * g).squaredNorm() * count / (count - 1.0);
    half = std::max(half, student(freedom_of(shares)) * std::sqrt(variance));
  }
  if (band_shifts.cols() > 0) {
    const auto count = static_cast<double>(band_shifts.cols());
    const double variance = (band_shifts.transpose() * g).squaredNorm() * (count - 1.0) / count;
    half = std::max(half, student(count - 1.0) * std::sqrt(variance));
  }
  half += std::abs(g.dot(step_shift));
  return other_shifts.cols() == 0 ? half : std::hypot(half, of_normal * (other_shifts.transpose() * g).norm());
}

Uncertainty::VarianceParts Uncertainty::variance_parts(const Eigen::VectorXd& g) const {
  const Eigen::VectorXd moved = inverse_information * g;
  VarianceParts parts;
  parts.tolerances = prior.cwiseProduct(moved.cwiseAbs2());
  parts.noise = std::max(g.dot(moved) - parts.tolerances.sum(), 0.0);
  const double informed = parts.sum();
  double whole = std::max(g.dot(covariance * g), informed);
  const auto take = [&whole](double variance, double freedom) {
    if (variance > whole * (1.0 + of_normal * std::sqrt(2.0 / freedom))) whole = variance;
  };
  if (block_shares.cols() > 0) {
    std::vector<double> shares;
    for (const Eigen::MatrixXd& of_block : information) shares.push_back(g.dot(of_block * g));
    const auto count = static_cast<double>(block_shares.cols());
    take((block_shares.transpose() * g).squaredNorm() * count / (count - 1.0), freedom_of(shares));
  }
  if (band_shifts.cols() > 0) {
    const auto count = static_cast<double>(band_shifts.cols());
    take((band_shifts.transpose() * g).squaredNorm() * (count - 1.0) / count, count - 1.0);
  }
  parts.model = whole - informed;
  return parts;
}

void Uncertainty::add_shifts(const Eigen::MatrixXd& shifts) {
  if (shifts.cols() == 0 || shifts.rows() != half_widths.size()) return;
  Eigen::MatrixXd all(shifts.rows(), other_shifts.cols() + shifts.cols());
  if (other_shifts.cols() > 0) all.leftCols(other_shifts.cols()) = other_shifts;
  all.rightCols(shifts.cols()) = shifts;
  other_shifts = std::move(all);
  for (Index i = 0; i < half_widths.size(); ++i) {
    if (std::isfinite(half_widths(i))) half_widths(i) = std::hypot(half_widths(i), of_normal * shifts.row(i).norm());
  }
}

Uncertainty uncertainty(const IdentificationProblem& problem, const std::vector<FreeParameter>& every, const Fit& fit) {
  Uncertainty result;
  const auto fitted = static_cast<Index>(fit.parameters.size());
  result.half_widths = Eigen::VectorXd::Zero(fitted);
  if (fitted == 0) return result;
  const std::vector<Block> blocks = blocks_of(problem, fit);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(fitted, fitted);
  for (const Block& block : blocks) whole += block.jacobian.transpose() * block.jacobian;
  Informed informed = informed_by(problem, every, fit, whole);
  result.undetermined = std::move(informed.undetermined);
  const Eigen::MatrixXd variance = inverse(informed.with_tolerance), of_data = inverse(informed.of_data);
  result.inverse_information = variance;
  result.prior = (informed.with_tolerance - informed.of_data).diagonal();
  result.directions = informed.directions;

  Eigen::MatrixXd gradients(informed.directions.cols(), static_cast<Index>(blocks.size()));
  std::vector<Eigen::MatrixXd> information;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::MatrixXd jacobian = blocks[b].jacobian * informed.directions;
    gradients.col(static_cast<Index>(b)) = jacobian.transpose() * blocks[b].residual / std::sqrt(blocks[b].spread);
    information.emplace_back(jacobian.transpose() * jacobian);
  }
  if (gradients.cols() >= 3) {
    const Eigen::VectorXd mean = gradients.rowwise().mean();
    gradients.colwise() -= mean;
    result.block_shares = variance * gradients;
    for (const Eigen::MatrixXd& of_block : information) {
      result.information.emplace_back(variance.transpose() * of_block * variance);
    }
  }
  const double temper = std::max(1.0, fit.chi_squared / static_cast<double>(fit.residual.size()));
  result.covariance = variance * temper;
  if (temper > thresholds::model_is_wrong) result.band_shifts = band_shifts(problem, fit);
  result.step_shift = step_shift(problem, fit);

  for (Index i = 0; i < fitted; ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    double& half = result.half_widths(i);
    half = result.half_width_of(Eigen::VectorXd::Unit(fitted, i));
    const bool by_tolerance = variance(i, i) < 0.5 * of_data(i, i);
    if (by_tolerance) half = std::max(half, 2.0 * std::numbers::sqrt3 * std::sqrt(variance(i, i)));
    const bool at_bound = p.role == FreeParameter::Role::tolerated && p.at_bound(fit.hypothesis);
    if (at_bound || std::isnan(half)) {
      half = std::numeric_limits<double>::infinity();
    }
  }
  return result;
}

}  // namespace host_sim::identification
