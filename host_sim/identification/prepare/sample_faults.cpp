#include "host_sim/identification/prepare/sample_faults.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Samples on either side of (1), and the fit_coefficients of its polynomial.
constexpr std::ptrdiff_t neighbours = 6;
constexpr int fit_coefficients = 5;
/// Samples beside k that (1) needs: three more than it has fit_coefficients.
constexpr std::size_t fewest_neighbours = fit_coefficients + 3;
/// A block of (3); the scale is that of three.
constexpr std::size_t scale_block = 64;
/// Median of |x| of a normal distribution, inverted.
constexpr double deviation_of_median = 1.4826;

using Powers = Eigen::Matrix<double, fit_coefficients, 1>;

Powers powers(std::ptrdiff_t offset) {
  Powers p;
  double power = 1.0;
  for (int i = 0; i < fit_coefficients; ++i, power *= static_cast<double>(offset) / neighbours) p(i) = power;
  return p;
}

/// A polynomial around one place, that of (1) or (6).
struct LocalFit {
  double value = 0.0;     ///< p_k
  double leverage = 0.0;  ///< l_k
  double squares = 0.0;   ///< of what is left
  double freedom = 0.0;   ///< samples less coefficients
};

/// Samples of a polynomial, and what it has beside its coefficients.
struct FitWindow {
  std::size_t at;
  std::optional<std::ptrdiff_t> jump{};  ///< a step between this offset and the next one
  bool with_itself = false;              ///< the sample at `at` takes part
};

/// `used`: whether a sample takes part. nullopt: too few.
template <class Used>
std::optional<LocalFit> local_fit(const std::vector<double>& samples, const FitWindow& window, const Used& used) {
  using FitRow = Eigen::Matrix<double, fit_coefficients + 1, 1>;
  Eigen::Matrix<double, fit_coefficients + 1, fit_coefficients + 1> normal;
  normal.setZero();
  FitRow right = FitRow::Zero();
  if (!window.jump) normal(fit_coefficients, fit_coefficients) = 1.0;  // no step
  const auto row = [&](std::ptrdiff_t offset) {
    FitRow r;
    r << powers(offset), window.jump && offset > *window.jump ? 1.0 : 0.0;
    return r;
  };
  std::array<std::ptrdiff_t, 2 * neighbours + 1> offsets{};
  std::size_t count = 0;
  const auto n = static_cast<std::ptrdiff_t>(samples.size()), k = static_cast<std::ptrdiff_t>(window.at);
  for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(-neighbours, -k); j <= std::min(neighbours, n - 1 - k); ++j) {
    const auto place = static_cast<std::size_t>(k + j);
    if ((j == 0 && !window.with_itself) || !used(place)) continue;
    offsets[count++] = j;
    const FitRow r = row(j);
    normal += r * r.transpose();
    right += r * samples[place];
  }
  if (count < fewest_neighbours) return std::nullopt;
  const auto solver = normal.ldlt();
  const FitRow fitted = solver.solve(right);
  LocalFit fit;
  fit.value = fitted.dot(row(0));
  fit.leverage = row(0).dot(solver.solve(row(0)));
  for (std::size_t i = 0; i < count; ++i) {
    const double error = samples[static_cast<std::size_t>(k + offsets[i])] - fitted.dot(row(offsets[i]));
    fit.squares += error * error;
  }
  fit.freedom = static_cast<double>(count) - fit_coefficients - (window.jump ? 1.0 : 0.0);
  return fit;
}

/// Weights of p_k on whole windows, and l_k there.
struct WholeWindow {
  std::array<double, 2 * neighbours + 1> weights{};
  double leverage = 0.0;

  WholeWindow() {
    Eigen::Matrix<double, fit_coefficients, fit_coefficients> normal;
    normal.setZero();
    for (std::ptrdiff_t j = -neighbours; j <= neighbours; ++j) {
      if (j != 0) normal += powers(j) * powers(j).transpose();
    }
    const Powers first = normal.ldlt().solve(powers(0));
    for (std::ptrdiff_t j = -neighbours; j <= neighbours; ++j) {
      if (j != 0) weights[static_cast<std::size_t>(j + neighbours)] = first.dot(powers(j));
    }
    leverage = first(0);
  }
};

/// e of (2), not a number where too few samples are usable.
std::vector<double> deviations(const std::vector<double>& samples, const std::vector<bool>& unusable) {
  static const WholeWindow whole;
  const std::size_t n = samples.size();
  std::vector<double> errors(n, std::nan(""));
  const auto used = [&](std::size_t k) { return unusable.empty() || !unusable[k]; };
  std::size_t usable_since = 0;  // first of the usable samples without a break that end at k + neighbours
  for (std::size_t end = 0; end < n + neighbours; ++end) {
    if (end < n && !used(end)) usable_since = end + 1;
    if (end < neighbours) continue;
    const std::size_t k = end - neighbours;
    if (!used(k)) continue;
    if (end < n && k >= neighbours && usable_since + neighbours <= k) {
      double predicted = 0.0;
      for (std::size_t j = 0; j < whole.weights.size(); ++j)
        predicted += whole.weights[j] * samples[k - neighbours + j];
      errors[k] = (samples[k] - predicted) / std::sqrt(1.0 + whole.leverage);
    } else if (const auto fit = local_fit(samples, {k}, used)) {
      errors[k] = (samples[k] - fit->value) / std::sqrt(1.0 + fit->leverage);
    }
  }
  return errors;
}

/// The value below which a share of these lies; 0 of none.
double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * last);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Median of the distance from the median: what a few samples far off do not move.
double spread_of(std::vector<double> samples) {
  const double middle = quantile(samples, 0.5);
  for (double& v : samples) v = std::abs(v - middle);
  return quantile(samples, 0.5);
}

/// (3)
struct NoiseScale {
  std::vector<double> of_block;
  double tails = 1.0;  ///< by how much tails are longer than those of a normal distribution
  [[nodiscard]] double operator()(std::size_t k) const { return of_block[k / scale_block]; }
};
NoiseScale noise_scale(const std::vector<double>& samples, const std::vector<double>& errors, double step) {
  const std::size_t blocks = (errors.size() + scale_block - 1) / scale_block;
  const double least =
      std::max(thresholds::rounding_error * step, thresholds::least_outlier_scale * spread_of(samples));
  std::vector<double> list, sizes;
  for (std::size_t b = 0; b < blocks; ++b) {
    sizes.clear();
    const std::size_t from = b > 0 ? (b - 1) * scale_block : 0, to = std::min(errors.size(), (b + 2) * scale_block);
    for (std::size_t k = from; k < to; ++k) {
      if (!std::isnan(errors[k])) sizes.push_back(std::abs(errors[k]));
    }
    list.push_back(std::max(deviation_of_median * quantile(sizes, 0.5), least));
  }
  // Where noise has longer tails than a normal distribution, an outlier stands out of those.
  sizes.clear();
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (!std::isnan(errors[k])) sizes.push_back(std::abs(errors[k]) / list[k / scale_block]);
  }
  constexpr double normal = 1.96;  // 95 % of |x|
  const double tails = std::max(quantile(sizes, 0.95) / normal, 1.0);
  return {std::move(list), tails};
}

/// (4) to (6) of one sample, with what `used` leaves.
template <class Used>
bool stands_alone(const std::vector<double>& samples, std::size_t k, const NoiseScale& noise, const Used& used) {
  const double scale = noise(k);
  const auto without = local_fit(samples, {k}, used);
  if (!without) return false;
  const double error = std::abs(samples[k] - without->value) / std::sqrt(1.0 + without->leverage);
  const double quiet = std::pow(thresholds::quiet_beside_outlier * scale, 2);
  if (!(error > thresholds::outlier_deviations * noise.tails * scale) || without->squares > quiet * without->freedom)
    return false;
  const double least = without->squares + std::pow(thresholds::no_jump * scale, 2);
  for (std::ptrdiff_t at = 1 - neighbours; at < neighbours - 1; ++at) {
    const auto jump = local_fit(samples, {k, at, true}, used);
    if (jump && jump->squares < least) return false;
  }
  return true;
}

/// Of one sample, with what was found before left out, and `others` of its neighbours: an outlier near the end of the
/// fit bends it more than it stands out, so each place is tried.
bool is_outlier(const std::vector<double>& samples, std::size_t k, const NoiseScale& noise, std::vector<bool>& out,
                int others) {
  if (stands_alone(samples, k, noise, [&](std::size_t place) { return !out[place]; })) return true;
  if (others == 0) return false;
  const std::size_t end = std::min(samples.size(), k + neighbours + 1);
  for (std::size_t j = k - std::min<std::size_t>(k, neighbours); j < end; ++j) {
    if (j == k || out[j]) continue;
    out[j] = true;
    const bool alone = is_outlier(samples, k, noise, out, others - 1);
    out[j] = false;
    if (alone) return true;
  }
  return false;
}

}  // namespace

std::vector<double> relative_deviations(const std::vector<double>& samples, const std::vector<bool>& unusable,
                                        double step) {
  std::vector<double> errors = deviations(samples, unusable);
  const NoiseScale noise = noise_scale(samples, errors, step);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double s = noise(k) * noise.tails;
    errors[k] = s > 0.0 && !std::isnan(errors[k]) ? errors[k] / s : 0.0;
  }
  return errors;
}

std::optional<double> cut_off_at(const std::vector<double>& samples) {
  double highest = 0.0;
  for (const double v : samples) highest = std::max(highest, std::abs(v));
  if (!(highest > 0.0) || !std::isfinite(highest)) return std::nullopt;
  std::vector<double> large;
  for (const double v : samples) {
    if (std::abs(v) > thresholds::overshoot * highest) large.push_back(std::abs(v));
  }
  std::sort(large.begin(), large.end(), std::greater<>());
  for (std::size_t first = 0; first < large.size();) {
    std::size_t next = first;
    while (next < large.size() && large[next] >= large[first] * (1.0 - 1e-9)) ++next;
    if (next - first >= thresholds::fewest_at_limit && 4 * first <= next - first) return large[first];
    first = next;
  }
  return std::nullopt;
}

std::vector<std::size_t> find_outliers(const std::vector<double>& samples, const std::vector<bool>& unusable,
                                       double step) {
  const std::vector<double> errors = deviations(samples, unusable);
  const NoiseScale noise = noise_scale(samples, errors, step);
  const std::optional<double> limit = cut_off_at(samples);
  const auto is_beside_limit = [&](std::size_t k) {
    for (std::size_t i = k - std::min<std::size_t>(k, 6); i < std::min(k + 7, samples.size()); ++i) {
      if (i != k && std::abs(samples[i]) >= *limit * (1.0 - 1e-9)) return true;
    }
    return false;
  };
  std::vector<std::size_t> candidates;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (limit && is_beside_limit(k)) continue;
    const double s = noise(k) * noise.tails;
    if (s > 0.0 && std::abs(errors[k]) > thresholds::outlier_deviations * s) candidates.push_back(k);
  }
  const auto relative = [&](std::size_t k) { return std::abs(errors[k]) / (noise(k) * noise.tails); };
  std::sort(candidates.begin(), candidates.end(),
            [&](std::size_t a, std::size_t b) { return relative(a) > relative(b); });
  std::vector<bool> out = unusable;
  out.resize(samples.size(), false);
  std::vector<std::size_t> found;
  const auto add = [&](std::size_t k, int others) {
    if (out[k] || !is_outlier(samples, k, noise, out, others)) return;
    out[k] = true;
    found.push_back(k);
  };
  for (const std::size_t k : candidates) add(k, 1);
  if (found.size() >= thresholds::strikes_often) {
    const auto is_peak = [&](std::size_t k) {
      const std::size_t last = std::min(k + 1, errors.size() - 1);
      return std::abs(errors[k]) >= std::abs(errors[k - std::min<std::size_t>(k, 1)]) &&
             std::abs(errors[k]) >= std::abs(errors[last]);
    };
    const double alike = thresholds::alike_outliers * relative(found[found.size() / 2]);  // largest first: the median
    for (const std::size_t k : candidates) {
      if (is_peak(k) && relative(k) > alike) add(k, 2);
    }
    for (const std::size_t k : candidates) add(k, 1);
  }
  const bool any =
      std::any_of(found.begin(), found.end(), [&](std::size_t k) { return relative(k) > thresholds::surest_outlier; });
  if (!any || static_cast<double>(found.size()) > thresholds::most_outliers * static_cast<double>(samples.size())) {
    return {};
  }
  std::sort(found.begin(), found.end());
  return found;
}

double place_deviation(const std::vector<double>& values, const std::vector<std::size_t>& places) {
  std::vector<double> at;  // the values there
  std::size_t before = 0;
  for (const std::size_t k : places) {
    if (at.empty() || k > before + neighbours) at.push_back(values[k]);
    before = k;
  }
  std::sort(at.begin(), at.end());
  // How many values lie between two of these, those that are equal to one below it and above it.
  std::vector<std::size_t> below(at.size() + 1), up_to(at.size() + 1);
  for (const double v : values) {
    ++below[static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), v) - at.begin())];
    ++up_to[static_cast<std::size_t>(std::lower_bound(at.begin(), at.end(), v) - at.begin())];
  }
  const auto n = static_cast<double>(values.size()), count = static_cast<double>(at.size());
  std::size_t less = 0, not_more = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    less += below[i];
    not_more += up_to[i];
    const double share = 0.5 * static_cast<double>(less + not_more) / n;
    largest = std::max({largest, share - static_cast<double>(i) / count, static_cast<double>(i + 1) / count - share});
  }
  return std::sqrt(count) * largest;
}

void mend_outliers(std::vector<double>& samples, const std::vector<std::size_t>& outliers,
                   const std::vector<bool>& unusable) {
  std::vector<bool> out = unusable;
  out.resize(samples.size(), false);
  for (const std::size_t k : outliers) out[k] = true;
  std::vector<double> mended;
  for (const std::size_t k : outliers) {
    const auto fit = local_fit(samples, {k}, [&](std::size_t place) { return !out[place]; });
    mended.push_back(fit ? fit->value : samples[k > 0 ? k - 1 : k]);
  }
  for (std::size_t i = 0; i < outliers.size(); ++i) samples[outliers[i]] = mended[i];
}

double quantisation_step(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  // Between the lowest and the highest value.
  const auto first = std::upper_bound(samples.begin(), samples.end(), samples.empty() ? 0.0 : samples.front());
  const auto last = std::lower_bound(first, samples.end(), samples.empty() ? 0.0 : samples.back());
  std::vector<double> distances;
  for (auto next = first; next != last && next + 1 != last; ++next) {
    if (*(next + 1) > *next) distances.push_back(*(next + 1) - *next);
  }
  if (distances.size() < thresholds::fewest_distances) return 0.0;
  std::vector<double> sorted = distances;
  const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quarter, sorted.end());
  double step = *quarter;
  const auto multiple = [&step](double distance) { return std::round(distance / step); };
  for (int round = 0; round < 3; ++round) {
    double sum = 0.0, steps = 0.0;
    for (const double distance : distances) {
      constexpr double near = 5.0;  // [steps]: of far ones the multiple is not certain yet
      if (multiple(distance) < 1.0 || multiple(distance) > near) continue;
      sum += distance;
      steps += multiple(distance);
    }
    step = sum / steps;
  }
  // (7) from value to value, so that an error of the step does not grow along them.
  const auto off_grid = std::count_if(distances.begin(), distances.end(), [&](double distance) {
    return multiple(distance) < 1.0 || std::abs(distance / step - multiple(distance)) > thresholds::grid_error;
  });
  const double allowed = (1.0 - thresholds::on_the_grid) * static_cast<double>(distances.size());
  return static_cast<double>(off_grid) <= allowed ? step : 0.0;
}

double rounding_noise(double step) { return step / std::sqrt(12.0); }

}  // namespace host_sim::identification
