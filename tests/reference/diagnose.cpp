#include "tests/reference/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace reference {
namespace {

/// How far the search looks: seconds that are scanned, causes that are fitted to these, starts of each, causes that are
/// fitted to the whole, models that go on, causes of a model.
constexpr double scan_seconds = 8.0, whole_recording = 1e6;
constexpr std::size_t scanned = 5, starts = 2, fitted = 3, beam = 2, most_causes = 4;

std::string names(const Model& model) {
  std::set<std::string> sorted;
  for (const Cause& cause : model.causes) sorted.insert(words(cause));
  std::string text;
  for (const std::string& one : sorted) text += one + "; ";
  return text;
}

bool better(const Fit& a, const Fit& b) { return a.evidence < b.evidence; }

/// With one cause more, in the place of one that it contains; nullopt: it is there, or contained.
std::optional<Model> with(Model model, const Cause& cause) {
  std::erase_if(model.causes, [&](const Cause& c) { return c.entry->name == cause.entry->contains; });
  for (const Cause& c : model.causes) {
    if ((c.entry == cause.entry && c.channel == cause.channel) || c.entry->contains == cause.entry->name) return {};
  }
  model.causes.push_back(cause);
  return model;
}

/// All models that were compared with one whitening.
class Search {
 public:
  Search(const Description& description, const std::vector<firmware::Recording>& recordings, const Model& noise)
      : whole_(description, recordings, whole_recording, noise),
        beginning_(description, recordings, scan_seconds, noise) {
    std::vector<Model> front{{std::vector<double>(description.tolerance.size()), {}}};
    take(whole_.fit(front.front(), {}, 10));
    for (std::size_t causes = 0; causes < most_causes; ++causes) {
      const double before = best().evidence;
      std::map<std::string, Fit> next;
      for (const Model& model : front) {
        for (const Fit& f : expand(model, fitted)) next.insert_or_assign(names(f.model), models_.at(names(f.model)));
      }
      std::vector<Fit> order;
      for (const auto& [key, f] : next) order.push_back(f);
      std::sort(order.begin(), order.end(), better);
      if (order.empty() || !(order.front().evidence < before)) break;
      front.clear();
      for (std::size_t i = 0; i < std::min(beam, order.size()); ++i) front.push_back(order[i].model);
    }
    // Elimination, and where more than noise is left swaps.
    for (double before = INFINITY; best().evidence < before - 0.1;) {
      before = best().evidence;
      const Model model = best().model;
      const bool left = unexplained(whole_.cells(best().residual)) > 0.5;
      take(whole_.fit(model, {}, 10));
      for (std::size_t c = 0; c < model.causes.size(); ++c) {
        Model less = model;
        less.causes.erase(less.causes.begin() + static_cast<std::ptrdiff_t>(c));
        less = take(whole_.fit(less, {}, 10)).model;
        if (left) expand(less, 2);
      }
    }
  }

  [[nodiscard]] const Fit& best() const {
    const auto less = [](const auto& a, const auto& b) { return better(a.second, b.second); };
    return std::min_element(models_.begin(), models_.end(), less)->second;
  }
  [[nodiscard]] const std::map<std::string, Fit>& models() const { return models_; }
  [[nodiscard]] const Problem& problem() const { return whole_; }

 private:
  /// The best fit of these causes so far.
  const Fit& take(const Fit& fit) {
    Fit& kept = models_.try_emplace(names(fit.model), fit).first->second;
    if (better(fit, kept)) kept = fit;
    return kept;
  }

  /// One cause more than `parent`: the best of a scan of the beginning, fitted there, the best of these to the whole.
  std::vector<Fit> expand(const Model& parent, std::size_t most) {
    const auto tolerated = static_cast<Eigen::Index>(parent.tolerated.size());
    const Fit brief = beginning_.fit(parent, {}, 3), whole = take(whole_.fit(parent, {}, 3));
    std::map<std::string, std::vector<Fit>> tried;
    for (const auto& [cause, gain] : beginning_.scan(brief)) {
      const auto model = with(brief.model, cause);
      if (!model || gain < 2.0 * log_prior || (tried.size() >= scanned && !tried.contains(words(cause)))) continue;
      auto& fits = tried[words(cause)];
      if (fits.size() < starts) fits.push_back(beginning_.fit(*model, brief.jacobian.leftCols(tolerated), 6));
    }
    std::vector<Fit> order, children;
    for (const auto& [key, fits] : tried) order.push_back(*std::min_element(fits.begin(), fits.end(), better));
    std::sort(order.begin(), order.end(), better);
    for (std::size_t i = 0; i < std::min(most, order.size()); ++i) {
      children.push_back(take(whole_.fit(order[i].model, whole.jacobian.leftCols(tolerated), 10)));
    }
    return children;
  }

  Problem whole_, beginning_;
  std::map<std::string, Fit> models_;  ///< by their causes
};

}  // namespace

Verdict diagnose(const Description& description, const std::vector<firmware::Recording>& recordings) {
  // What was found passes the noise of a car's foot point on: whiten, search, and again until the names stay.
  Model noise{std::vector<double>(description.tolerance.size()), {}};
  std::optional<Search> search;
  for (int round = 0; round < 3; ++round) {
    search.emplace(description, recordings, noise);
    const Model found = search->best().model;
    if (description.rig.kind != model::RigKind::quarter_car || names(found) == names(noise)) break;
    noise = found;
  }
  std::vector<double> evidence;
  for (const auto& [key, fit] : search->models()) evidence.push_back(fit.evidence);
  const std::vector<double> shares = posterior(evidence);
  Verdict verdict;
  std::map<std::string, Verdict::Found> found;
  auto share = shares.begin();
  for (const auto& [key, fit] : search->models()) {
    if (*share > 0.0) verdict.unexplained += *share * unexplained(search->problem().cells(fit.residual));
    for (const Cause& cause : fit.model.causes) {
      if (*share > 0.0) found.try_emplace(words(cause), Verdict::Found{cause, 0.0}).first->second.confidence += *share;
    }
    ++share;
  }
  for (const auto& [key, cause] : found) verdict.causes.push_back(cause);
  std::sort(verdict.causes.begin(), verdict.causes.end(),
            [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  return verdict;
}

}  // namespace reference
