#include "tests/reference/diagnose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

namespace reference {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double scan_seconds = 8.0;
const bool loud = std::getenv("REFERENCE_LOUD") != nullptr;

/// The least of ½ dᵀH d + gᵀd in a box: what leaves the box furthest is fixed at its bound, one after the other.
VectorXd bounded_step(const MatrixXd& hessian, const VectorXd& gradient, const VectorXd& lower, const VectorXd& upper) {
  const Index n = gradient.size();
  VectorXd step = VectorXd::Zero(n);
  std::vector<Index> open;
  for (Index i = 0; i < n; ++i) open.push_back(i);
  while (!open.empty()) {
    const MatrixXd h = hessian(open, open);
    const VectorXd g = gradient(open) + hessian(open, Eigen::all) * step;  // what is open has the step 0
    const VectorXd d = h.ldlt().solve(-g);
    double worst = 1e-9;
    std::size_t out = open.size();
    for (std::size_t i = 0; i < open.size(); ++i) {
      const double beyond = std::max(lower(open[i]) - d(static_cast<Index>(i)), d(static_cast<Index>(i)) - upper(open[i]));
      if (beyond > worst) worst = beyond, out = i;
    }
    if (out == open.size()) {
      step(open) = d;
      break;
    }
    step(open[out]) = std::clamp(d(static_cast<Index>(out)), lower(open[out]), upper(open[out]));
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(out));
  }
  return step;
}

Model described(const firmware::RigDescription& description) { return {std::vector<double>(description.tolerance.size()), {}}; }

class Search {
 public:
  explicit Search(const Problem& problem) : problem_(problem) {
    const Measured& first = problem.recordings().front();
    scales_ = scales_of(problem.description().rig, first, predicted(problem.description(), described(problem.description()), first));
  }

  [[nodiscard]] const model::MotionScales& scales() const { return scales_; }
  [[nodiscard]] const Problem& problem() const { return problem_; }

  /// Gauss–Newton, first with the weights of noise alone, then with (3) of the residual at hand. `known`: columns of J of
  /// the tolerated parameters that are kept.
  [[nodiscard]] Fit fit(Model start, const MatrixXd& known, int most = 10) const {
    Fit f;
    f.parameters = parameters_of(start, problem_.recordings().front(), scales_);
    f.model = std::move(start);
    f.residual = problem_.residual(f.model);
    const auto n = static_cast<Index>(f.parameters.size());
    f.jacobian = MatrixXd::Zero(f.residual.size(), n);
    f.jacobian.leftCols(known.cols()) = known;
    if (known.cols() > 0) descend(f, known.cols(), most, [](const VectorXd& r) { return VectorXd::Ones(r.size()); }, [](const VectorXd& r) { return r.allFinite() ? r.squaredNorm() : INFINITY; });
    descend(f, known.cols(), most, [this](const VectorXd& r) { return problem_.weights(r); }, [this](const VectorXd& r) { return problem_.counted(r); });
    f.left = problem_.counted(f.residual);
    weigh(f);
    return f;
  }

  template <class Weights, class Counted>
  void descend(Fit& f, Index known, int most, const Weights& weights, const Counted& counted) const {
    const Index n = f.jacobian.cols();
    double left = counted(f.residual);
    for (int i = 0; i < most && n > 0; ++i) {
      differentiate(f, known);
      const MatrixXd weighted = weights(f.residual).asDiagonal() * f.jacobian;
      MatrixXd hessian = f.jacobian.transpose() * weighted;
      hessian.diagonal() += 1e-9 * hessian.diagonal() + VectorXd::Constant(n, 1e-6);
      const VectorXd gradient = weighted.transpose() * f.residual;
      const double before = left;
      for (double trust = 1.0; trust > 0.01; trust /= 4.0) {
        VectorXd lower(n), upper(n);
        for (Index p = 0; p < n; ++p) {
          const Parameter& parameter = f.parameters[static_cast<std::size_t>(p)];
          const double u = parameter.get(f.model);
          const double far = parameter.tolerated ? 2.0 : trust * (parameter.logarithmic ? 1.0 : std::max(1.0, 3.0 * std::abs(u)));
          lower(p) = std::max(std::min(parameter.lower - u, 0.0), -far);
          upper(p) = std::min(std::max(parameter.upper - u, 0.0), far);
        }
        const VectorXd step = trust * bounded_step(hessian, gradient, lower / trust, upper / trust);
        Model moved = f.model;
        for (Index p = 0; p < n; ++p) {
          const Parameter& parameter = f.parameters[static_cast<std::size_t>(p)];
          parameter.put(moved, parameter.get(f.model) + step(p));
        }
        const VectorXd residual = problem_.residual(moved);
        const double now = counted(residual);
        if (!(now < left)) continue;
        f.model = std::move(moved);
        f.residual = residual;
        left = now;
        break;
      }
      if (left > before - 0.3) break;
    }
  }

  struct Scanned {
    Cause cause;
    double gain;
    double size;
  };
  /// What each cause would gain beside a fit: the change d of the residual by its start, at the best size a, while all
  /// parameters make way: min (r + a d + J u)ᵀ W (r + a d + J u) + 3 |u|².
  [[nodiscard]] std::vector<Scanned> scan(const Fit& f) const {
    const VectorXd w = problem_.weights(f.residual);
    const MatrixXd weighted = w.asDiagonal() * f.jacobian;
    MatrixXd hessian = f.jacobian.transpose() * weighted;
    for (Index p = 0; p < hessian.rows(); ++p) hessian(p, p) += f.parameters[static_cast<std::size_t>(p)].tolerated ? 3.0 : 1e-6;
    const Eigen::LDLT<MatrixXd> solver(hessian);
    const VectorXd own = solver.solve(weighted.transpose() * f.residual);
    const VectorXd rest = f.residual - f.jacobian * own;
    std::vector<Scanned> result;
    for (const Cause& cause : candidates(problem_.description().rig, problem_.recordings().front(), scales_)) {
      const auto model = with(f.model, cause);
      if (!model) continue;
      VectorXd d = problem_.residual(*model) - f.residual;
      if (!d.allFinite()) continue;
      d -= f.jacobian * solver.solve(weighted.transpose() * d);
      const double dd = d.dot(w.asDiagonal() * d);
      if (!(dd > 0.0)) continue;
      const bool signed_size = cause.entry->parameters.size() > 0 && cause.entry->parameters[0].lower < 0.0;
      const double a = std::clamp(-d.dot(w.asDiagonal() * rest) / dd, signed_size ? -1e9 : 0.0, signed_size ? 1e9 : 30.0);
      result.push_back({cause, f.left - problem_.counted(rest + a * d), a});
    }
    std::stable_sort(result.begin(), result.end(), [](const auto& x, const auto& y) { return x.gain > y.gain; });
    return result;
  }

  /// The start of a scanned cause, or that with its first number in proportion to the best size, or in inverse proportion.
  [[nodiscard]] Model start_of(const Fit& f, const Scanned& scanned) const {
    Model best = *with(f.model, scanned.cause);
    if (scanned.cause.values.empty() || !scanned.cause.entry->parameters[0].fitted) return best;
    double least = problem_.counted(problem_.residual(best));
    const auto& card = scanned.cause.entry->parameters[0];
    for (const double factor : {scanned.size, 1.0 / scanned.size}) {
      Cause other = scanned.cause;
      other.values[0] = card.neutral + factor * (other.values[0] - card.neutral);
      if (!(other.values[0] > card.lower && other.values[0] < card.upper)) continue;
      const Model model = *with(f.model, other);
      const double left = problem_.counted(problem_.residual(model));
      if (left < least) least = left, best = model;
    }
    return best;
  }

  /// A model with one cause more, in the place of one that it contains; none if it is there, or contained.
  [[nodiscard]] static std::optional<Model> with(Model model, const Cause& cause) {
    std::erase_if(model.causes, [&](const Cause& c) { return c.entry->name == cause.entry->contains; });
    for (const Cause& c : model.causes) {
      if ((c.entry == cause.entry && c.channel == cause.channel) || c.entry->contains == cause.entry->name) return {};
    }
    model.causes.push_back(cause);
    return model;
  }

 private:
  void differentiate(Fit& f, Index from) const {
    for (Index p = from; p < f.jacobian.cols(); ++p) {
      const Parameter& parameter = f.parameters[static_cast<std::size_t>(p)];
      Model moved = f.model;
      const double u = parameter.get(moved), step = u + 0.01 > parameter.upper ? -0.01 : 0.01;
      parameter.put(moved, u + step);
      f.jacobian.col(p) = (problem_.residual(moved) - f.residual) / step;
    }
  }

  /// (4)
  void weigh(Fit& f) const {
    std::vector<double> widths;
    for (const Parameter& parameter : f.parameters) widths.push_back(parameter.width());
    const MatrixXd hessian = f.jacobian.transpose() * problem_.weights(f.residual).asDiagonal() * f.jacobian;
    f.evidence = f.left + occam(hessian, widths);
    const auto channels = static_cast<double>(problem_.recordings().front().channels.size());
    for (const Cause& cause : f.model.causes) f.evidence += 2.0 * (log_prior_of_cause + (cause.channel ? std::log(channels) : 0.0));
  }

  const Problem& problem_;
  model::MotionScales scales_;
};

std::string names(const Model& model) {
  std::set<std::string> sorted;
  for (const Cause& cause : model.causes) sorted.insert(words(cause));
  std::string text;
  for (const std::string& one : sorted) text += (text.empty() ? "" : " + ") + one;
  return text;
}

void say(const char* what, const Fit& f) {
  if (!loud) return;
  std::fprintf(stderr, "%s %s: E %.1f evidence %.1f", what, names(f.model).c_str(), f.left, f.evidence);
  for (const Cause& c : f.model.causes) {
    std::fprintf(stderr, " |");
    for (const double v : c.values) std::fprintf(stderr, " %.4g", v);
  }
  std::fprintf(stderr, "\n");
}

}  // namespace

Problem::Problem(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings,
                 double seconds, const Model& noise)
    : description_(description) {
  for (const firmware::Recording& recording : recordings) {
    recordings_.push_back(measured(description, recording, seconds));
    whitenings_.emplace_back(description, recordings_.back(), noise);
    const auto& cells = whitenings_.back().cells();
    cells_.insert(cells_.end(), cells.begin(), cells.end());
  }
}

VectorXd Problem::residual(const Model& model) const {
  VectorXd all(static_cast<Index>(cells_.size()));
  Index from = 0;
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const VectorXd part = whitenings_[r](recordings_[r], predicted(description_, model, recordings_[r]));
    all.segment(from, part.size()) = part;
    from += part.size();
  }
  return all;
}

std::vector<Cell> Problem::cells(const VectorXd& residual) const {
  std::vector<Cell> cells(bands * recordings_.front().channels.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells[cells_[i]].power += std::pow(residual(static_cast<Index>(i)), 2);
    cells[cells_[i]].count += 1.0;
  }
  return cells;
}

double Problem::counted(const VectorXd& residual) const {
  double sum = 0.0;
  for (const Cell& cell : cells(residual)) sum += reference::counted(cell);
  return std::isfinite(sum) ? sum : INFINITY;
}

VectorXd Problem::weights(const VectorXd& residual) const {
  const std::vector<Cell> all = cells(residual);
  VectorXd w(residual.size());
  for (Index i = 0; i < w.size(); ++i) w(i) = weight(all[cells_[static_cast<std::size_t>(i)]]);
  return w;
}

std::string words(const Cause& cause) {
  return std::string(cause.entry->name) + (cause.channel ? " of " + std::string(name(*cause.channel)) : "");
}

namespace {

/// All models that were compared with one whitening, by the names of their causes.
class Comparison {
 public:
  Comparison(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings, const Model& noise)
      : whole_(description, recordings, 1e9, noise), beginning_(description, recordings, scan_seconds, noise), full_(whole_), brief_(beginning_) {
    std::vector<std::string> front{take(full_.fit(described(description), {}))};
    for (std::size_t depth = 0; depth < most_causes; ++depth) {
      const double before = best().evidence;
      std::set<std::string> next;
      for (const std::string& key : front) next.merge(expand(models_.at(key).model, fitted));
      front.assign(next.begin(), next.end());
      std::sort(front.begin(), front.end(), [&](const auto& a, const auto& b) { return models_.at(a).evidence < models_.at(b).evidence; });
      if (front.size() > beam) front.resize(beam);
      if (front.empty() || !(models_.at(front.front()).evidence < before)) break;
    }
    // Elimination and swaps.
    for (double before = INFINITY; best().evidence < before - 0.1;) {
      const Model model = best().model;
      take(full_.fit(model, {}));
      before = best().evidence;
      for (std::size_t c = 0; c < model.causes.size(); ++c) {
        Model less = model;
        less.causes.erase(less.causes.begin() + static_cast<std::ptrdiff_t>(c));
        take(full_.fit(less, {}));
        expand(models_.at(names(less)).model, 2);
      }
    }
  }

  [[nodiscard]] const Problem& problem() const { return whole_; }
  [[nodiscard]] std::vector<Fit> models() const {
    std::vector<Fit> all;
    for (const auto& [key, f] : models_) all.push_back(f);
    std::sort(all.begin(), all.end(), [](const Fit& a, const Fit& b) { return a.evidence < b.evidence; });
    return all;
  }

 private:
  static constexpr std::size_t beam = 2, scanned = 8, starts = 2, fitted = 4, most_causes = 4;

  [[nodiscard]] const Fit& best() const {
    return std::min_element(models_.begin(), models_.end(), [](const auto& a, const auto& b) { return a.second.evidence < b.second.evidence; })->second;
  }

  std::string take(Fit f) {
    say("model", f);
    const std::string key = names(f.model);
    const auto [it, fresh] = models_.try_emplace(key, f);
    if (!fresh && f.evidence < it->second.evidence) it->second = std::move(f);
    return key;
  }

  /// Scans all causes beside those of a model over the beginning of the recordings, fits the `scanned` best there and the
  /// `most` best of these to the whole.
  std::set<std::string> expand(const Model& parent, std::size_t most) {
    const Fit shorter = brief_.fit(parent, {}, 3), longer = full_.fit(parent, {}, 3);
    take(longer);
    const auto tolerated = static_cast<Index>(parent.tolerated.size());
    std::map<std::string, std::vector<Fit>> tried;
    for (const auto& candidate : brief_.scan(shorter)) {
      const std::string name = words(candidate.cause);
      if (!(candidate.gain > 2.0 * log_prior_of_cause)) break;
      if (tried.size() >= scanned && !tried.contains(name)) continue;
      if (tried[name].size() >= starts) continue;
      tried[name].push_back(brief_.fit(brief_.start_of(shorter, candidate), shorter.jacobian.leftCols(tolerated), 6));
      if (loud) std::fprintf(stderr, "  scan %s gain %.1f size %.3g\n", name.c_str(), candidate.gain, candidate.size);
      say("   brief", tried[name].back());
    }
    std::vector<const Fit*> order;
    for (const auto& [name, fits] : tried) order.push_back(&*std::min_element(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.evidence < b.evidence; }));
    std::sort(order.begin(), order.end(), [](const Fit* a, const Fit* b) { return a->evidence < b->evidence; });
    std::set<std::string> taken;
    for (std::size_t i = 0; i < std::min(most, order.size()); ++i) taken.insert(take(full_.fit(order[i]->model, longer.jacobian.leftCols(tolerated))));
    return taken;
  }

  Problem whole_, beginning_;
  Search full_, brief_;
  std::map<std::string, Fit> models_;
};

}  // namespace

Verdict diagnose(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings) {
  Model noise = described(description);
  std::optional<Comparison> comparison;
  Verdict verdict;
  for (int round = 0; round < 3; ++round) {
    comparison.emplace(description, recordings, noise);
    verdict.models = comparison->models();
    const Model found = verdict.models.front().model;
    if (names(found) == names(noise)) break;
    noise = found;
    if (loud) std::fprintf(stderr, "=== whitened again\n");
  }
  std::vector<double> values;
  for (const Fit& f : verdict.models) values.push_back(f.evidence);
  const std::vector<double> shares = posterior(values);
  for (std::size_t m = 0; m < shares.size() && shares[m] > 0.0; ++m) {
    const Fit& f = verdict.models[m];
    verdict.unexplained += shares[m] * unexplained(comparison->problem().cells(f.residual), 0.05);
    for (const Cause& cause : f.model.causes) {
      const auto there = std::find_if(verdict.causes.begin(), verdict.causes.end(), [&](const auto& found) { return words(found.cause) == words(cause); });
      if (there == verdict.causes.end()) verdict.causes.push_back({cause, shares[m]});
      else there->confidence += shares[m];
    }
  }
  std::sort(verdict.causes.begin(), verdict.causes.end(), [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  return verdict;
}

}  // namespace reference
