#include "host_sim/diagnose/redundancy.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <map>
#include <optional>

#include "host_sim/catalogue.hpp"
#include "host_sim/diagnose/fit.hpp"
#include "host_sim/diagnose/looks.hpp"
#include "host_sim/diagnose/piece.hpp"
#include "host_sim/diagnose/relation.hpp"
#include "host_sim/gaussian.hpp"
#include "host_sim/spectrum.hpp"

namespace host_sim::diagnose {
namespace {

using model::Channel;
using model::RigKind;
using Series = std::vector<double>;

constexpr double block_length = 2.0;  // [s]
constexpr double looked_at = 120.0;   // of each recording [s]
constexpr double settled = 2.0;       // [s]: a component's start is not known
constexpr double believed = 1e-3;     // relative error of a sum of terms that is not looked into
constexpr double top = 60.0;          // [Hz]
constexpr std::array<double, Residue::bands + 1> edges{0.5, 1.0, 2.0, 3.0, 4.5, 6.5, 9.0, 13.0, 18.0, 26.0, 40.0, top};

/// The component alone, on a bench.
model::RigParameters<double> component_of(const model::RigParameters<double>& rig) {
  model::RigParameters<double> bench = rig;
  bench.kind = RigKind::component_bench;
  bench.machine.virtual_damping = 0.0;
  for (const PlacedEffect& effect : effects_of(rig)) {
    if (effect.entry->place != model::Place::suspension && effect.entry->place != model::Place::fdva) {
      remove_effect(bench, *effect.entry, effect.channel);
    }
  }
  return bench;
}

/// What a bench answers to a motion.
Series answer(const model::RigParameters<double>& bench, const Recording& recording, const Series& motion, bool reached,
              Channel asked) {
  Recording driven;
  driven.sample_period = recording.sample_period;
  driven.time = recording.time;
  driven.ducts = recording.ducts;
  driven[reached ? Channel::x_act : Channel::x_cmd] = motion;
  const Drive drive = drive_of(bench, driven);
  return respond(bench, drive, resting(bench, drive))[index(asked)];
}

/// Of a relation over all recordings: the residual and what each tolerated parameter makes of it, as series.
struct Columns {
  std::vector<ResidualSeries> residual;    // by recording
  std::vector<std::vector<Series>> moved;  // by parameter, by recording: for a relative change of 1
  std::vector<double> lower, upper;        // bounds of what they may still change by, relative
  std::vector<std::string> inner;          // the last of them: the component's own
  std::vector<Series> force_noise;         // of the component's force, by recording: a sample of it
};

struct Spectra {
  std::vector<Eigen::MatrixXcd> cross;  // by line: of residual (0) and parameters (1 … p)
  std::vector<double> noise, carried;   // of the relation; of it, what goes through the component
  double resolution = 0.0, blocks = 0.0;
};

class Relations {
 public:
  Relations(const RigDescription& description, const std::vector<Recording>& recordings)
      : description_(description), recordings_(recordings), window_(recordings.front().sample_period) {}

  [[nodiscard]] Residue residue(const Relation& relation) const {
    Residue out;
    out.relation = relation.words;
    // The component's force is not linear in its parameters: Gauss–Newton.
    std::map<std::string, double> deviations;
    Columns columns;
    Spectra s;
    Eigen::VectorXd theta;
    constexpr int most_steps = 4;
    for (int step = 1; step <= most_steps; ++step) {
      columns = columns_of(relation, deviations);
      s = spectra_of(columns, relation);
      if (s.blocks == 0.0) return out;
      theta = fitted(columns, s);
      double change = 0.0;
      for (std::size_t i = 0; i < columns.inner.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(columns.moved.size() - columns.inner.size() + i);
        deviations[columns.inner[i]] += theta(at);
        change = std::max(change, std::abs(theta(at)));
      }
      if (change < 1e-3) break;
    }
    const auto m = theta.size();
    for (std::size_t r = 0; r < columns.residual.size(); ++r) {
      for (std::size_t i = 0; i < columns.moved.size(); ++i) {
        for (std::size_t k = 0; k < columns.residual[r].values.size(); ++k) {
          columns.residual[r].values[k] += theta(static_cast<Eigen::Index>(i)) * columns.moved[i][r][k];
        }
      }
    }
    Eigen::VectorXcd combination(m + 1);
    combination(0) = 1.0;
    for (Eigen::Index i = 0; i < m; ++i) combination(i + 1) = theta(i);

    const double duration = 0.5 * block_length * (s.blocks + 1.0);
    std::array<double, Residue::bands> above{};
    double loud_power = 0.0, loud_noise = 0.0;
    for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
      double power = 0.0, quiet = 0.0, width = 0.0;
      for (std::size_t k = 1; k < s.noise.size(); ++k) {
        const double f = static_cast<double>(k) * s.resolution;
        if (f < edges[b] || f >= edges[b + 1]) continue;
        power += (combination.transpose() * s.cross[k] * combination.conjugate()).value().real();
        quiet += s.noise[k];
        width += s.resolution;
      }
      if (!(quiet > 0.0)) continue;
      out.excess[b] = power / quiet - 1.0;
      // A band's mean power scatters by 1/√(duration × width).
      const double z = (power / quiet - 1.0) * std::sqrt(duration * width);
      out.significance = std::max(out.significance, z);
      if (z < 8.0) continue;
      above[b] = out.excess[b] * width;
      loud_power += power;
      loud_noise += quiet;
    }
    if (loud_noise > 0.0) out.ratio = loud_power / loud_noise;
    double total = 0.0, sum = 0.0;
    for (const double e : above) total += e;
    for (std::size_t b = 0; b < above.size() && total > 0.0; ++b) {
      if (sum < 0.1 * total) out.lowest = edges[b];
      sum += above[b];
      out.highest = edges[b + 1];
      if (sum >= 0.9 * total) break;
    }
    add_suspects(relation, s.resolution, s.noise, s.carried, out);
    if (out.loud()) out.looks = looks_of(relation.motion, columns.residual, recordings_, window_);
    return out;
  }

 private:
  /// Cross-spectra of residual (0) and parameters (1 … p), and of noise.
  [[nodiscard]] Spectra spectra_of(const Columns& columns, const Relation& relation) const {
    Spectra result;
    const double rate = 1.0 / recordings_.front().sample_period;
    const std::size_t length = good_fft_size(static_cast<std::size_t>(block_length * rate));
    const std::size_t p = columns.moved.size();

    BlockTransform transform(hann_window(length), Detrend::none);
    const double resolution = rate / static_cast<double>(length);
    const auto bins = std::min(transform.bins(), static_cast<std::size_t>(top / resolution) + 1);
    std::vector<Eigen::MatrixXcd> spectra(
        bins, Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(p) + 1, static_cast<Eigen::Index>(p) + 1));
    std::vector<double> noise(bins, 0.0);
    const double scale = 2.0 / (rate * transform.window_power());
    double blocks = 0.0;
    for (std::size_t r = 0; r < columns.residual.size(); ++r) {
      const auto& trusted = columns.residual[r].trusted;
      for (std::size_t from = 0; from + length <= trusted.size(); from += length / 2) {
        const auto begin = trusted.begin() + static_cast<std::ptrdiff_t>(from);
        if (std::find(begin, begin + static_cast<std::ptrdiff_t>(length), false) !=
            begin + static_cast<std::ptrdiff_t>(length)) {
          continue;
        }
        blocks += 1.0;
        std::vector<std::vector<std::complex<double>>> lines;
        // Freed from the mean as the window weights it: a constant c is c W₀ at 0 and −c W₀/2 at the next line. The
        // plain mean of a derivative is the difference of its ends, which would carry fast noise down here.
        const auto transformed = [&](const Series& s) {
          const auto all = transform(std::span(s).subspan(from, length));
          std::vector<std::complex<double>> line(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(bins));
          line[1] += 0.5 * line[0];
          line[0] = 0.0;
          return line;
        };
        const auto add = [&](const Series& s) { lines.push_back(transformed(s)); };
        add(columns.residual[r].values);
        for (const auto& moved : columns.moved) add(moved[r]);
        for (std::size_t k = 0; k < bins; ++k) {
          for (std::size_t i = 0; i <= p; ++i) {
            for (std::size_t j = 0; j <= p; ++j) {
              spectra[k](static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) +=
                  scale * lines[i][k] * std::conj(lines[j][k]);
            }
          }
        }
        if (columns.force_noise[r].empty()) continue;
        const auto line = transformed(columns.force_noise[r]);
        for (std::size_t k = 0; k < bins; ++k) noise[k] += scale * std::norm(line[k]);
      }
    }
    if (blocks == 0.0) return result;
    for (auto& matrix : spectra) matrix /= blocks;
    for (double& v : noise) v /= blocks;
    const std::vector<double> carried = noise;  // through the component
    add_sensor_noise(relation, resolution, noise);
    return {std::move(spectra), std::move(noise), carried, resolution, blocks};
  }

  /// The parameters, relative, inside their bounds.
  [[nodiscard]] static Eigen::VectorXd fitted(const Columns& columns, const Spectra& s) {
    const auto m = static_cast<Eigen::Index>(columns.moved.size());
    if (m == 0) return {};
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(m, m);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(m);
    for (std::size_t k = 1; k < s.noise.size(); ++k) {
      h += s.cross[k].bottomRightCorner(m, m).real() / s.noise[k];
      g += s.cross[k].bottomLeftCorner(m, 1).real() / s.noise[k];
    }
    h.diagonal() *= 1.0 + 1e-9;
    const auto vector_of = [m](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), m); };
    return bounded_step(h, g, {vector_of(columns.lower), vector_of(columns.upper)});
  }

  [[nodiscard]] Columns columns_of(const Relation& relation, const std::map<std::string, double>& deviations) const {
    Columns columns;
    auto bench = component_of(description_.rig);
    const auto tolerance = [&](const std::string& path) {
      const auto it = description_.tolerance.find(path);
      return it == description_.tolerance.end() ? 0.0 : it->second;
    };
    std::vector<const Signal*> linear;
    for (const auto& [path, part] : relation.tolerated) {
      if (!(tolerance(path) > 0.0)) continue;
      linear.push_back(&part);
      columns.lower.push_back(-tolerance(path));
      columns.upper.push_back(tolerance(path));
    }
    std::vector<double> nominal;
    if (relation.deflection) {
      for (const auto& [path, bound] : description_.tolerance) {
        double* const value = find_parameter(bench, path);
        if (!(path.starts_with("suspension.") || path.starts_with("fdva.")) || value == nullptr || *value == 0.0 ||
            !(bound > 0.0)) {
          continue;
        }
        const auto it = deviations.find(path);
        const double deviation = it == deviations.end() ? 0.0 : it->second;
        columns.inner.push_back(path);
        columns.lower.push_back(-bound - deviation);
        columns.upper.push_back(bound - deviation);
        nominal.push_back(*value);
        *value *= 1.0 + deviation;
      }
    }
    columns.moved.resize(columns.lower.size());
    for (const Recording& r : recordings_) {
      Series residual = samples_of(r, relation.sum, &window_);
      std::size_t at = 0;
      for (const Signal* part : linear) columns.moved[at++].push_back(samples_of(r, *part, &window_));
      Series force_noise;
      const auto subtract = [&](const Series& model) {
        const Series smooth = window_(model, 0);
        for (std::size_t k = 0; k < residual.size(); ++k) residual[k] -= smooth[k];
      };
      if (relation.machine)
        subtract(answer(explained_part(description_.rig), r, r[Channel::x_cmd], false, Channel::x_act));
      if (relation.deflection) {
        const Series motion = samples_of(r, *relation.deflection, nullptr);
        const Series force = answer(bench, r, motion, true, Channel::F);
        subtract(force);
        const auto change = [&](const Series& other, double per) {
          Series difference(force.size());
          for (std::size_t k = 0; k < force.size(); ++k) difference[k] = (other[k] - force[k]) / per;
          return window_(difference, 0);
        };
        for (std::size_t i = 0; i < nominal.size(); ++i) {
          auto rig = bench;
          *find_parameter(rig, columns.inner[i]) += 0.01 * nominal[i];
          Series moved = change(answer(rig, r, motion, true, Channel::F), -0.01);
          columns.moved[at++].push_back(std::move(moved));
        }
        Series noisy = motion;
        Gaussian gaussian(1, 17);
        double variance = 0.0;
        for (const Term& t : *relation.deflection) variance += std::pow(t.factor * noise_of(r, t.channel), 2);
        for (double& v : noisy) v += std::sqrt(variance) * gaussian();
        force_noise = change(answer(bench, r, noisy, true, Channel::F), 1.0);
      }
      const auto margin = static_cast<std::size_t>(window_.reach() + 1);
      std::vector<bool> trusted(r.size(), true);
      const auto from = std::max(margin, static_cast<std::size_t>(settled / r.sample_period));
      for (std::size_t k = 0; k < trusted.size(); ++k) trusted[k] = k >= from && k + margin < r.size();
      Signal all = relation.sum;
      if (relation.deflection) all.insert(all.end(), relation.deflection->begin(), relation.deflection->end());
      for (const Term& t : all) {
        const auto& range = description_.range[index(t.channel)];
        for (std::size_t k = 0; range && k < r.size(); ++k) {
          if (range->holds(r[t.channel][k])) continue;
          for (std::size_t i = k - std::min(k, margin); i < std::min(k + margin, r.size()); ++i) trusted[i] = false;
        }
      }
      columns.residual.push_back({std::move(residual), std::move(trusted)});
      columns.force_noise.push_back(std::move(force_noise));
    }
    return columns;
  }

  [[nodiscard]] double noise_of(const Recording& r, Channel channel) const {
    if (channel == Channel::x_cmd) return 0.0;
    return diagnose::noise_of(description_, r, channel);
  }

  void add_sensor_noise(const Relation& relation, double resolution, std::vector<double>& noise) const {
    const Recording& r = recordings_.front();
    const double period = r.sample_period;
    std::array<double, model::channel_count> rms{};
    for (const Term& t : relation.sum) rms[index(t.channel)] = noise_of(r, t.channel);
    // The largest term's own power, for what the relations themselves are not exact to.
    for (std::size_t k = 0; k < noise.size(); ++k) {
      const double f = static_cast<double>(k) * resolution;
      std::array<std::complex<double>, model::channel_count> gains{};
      for (const Term& t : relation.sum) gains[index(t.channel)] += t.factor * window_.gain(t.order, f);
      for (std::size_t c = 0; c < gains.size(); ++c) noise[k] += 2.0 * period * std::norm(gains[c]) * rms[c] * rms[c];
    }
    const Series largest = samples_of(r, {relation.sum.front()}, &window_);
    const PowerSpectrum power = welch(std::span(largest).subspan(static_cast<std::size_t>(window_.reach())),
                                      1.0 / period, static_cast<std::size_t>(block_length / period));
    for (std::size_t k = 0; k < std::min(noise.size(), power.density.size()); ++k) {
      noise[k] += believed * believed * power.density[k];
    }
  }

  /// What a unit of power at each origin makes of the relation, in its noise, band by band.
  void add_suspects(const Relation& relation, double resolution, const std::vector<double>& noise,
                    const std::vector<double>& carried, Residue& out) const {
    double deflection_noise = 0.0;
    if (relation.deflection) {
      for (const Term& t : *relation.deflection) {
        deflection_noise += std::pow(t.factor * noise_of(recordings_.front(), t.channel), 2);
      }
    }
    const double period = recordings_.front().sample_period;
    for (const Origin& origin : relation.origins) {
      const auto known = [&](const Residue::Suspect& suspect) { return suspect.place == origin.place; };
      if (std::any_of(out.suspects.begin(), out.suspects.end(), known)) continue;
      Residue::Suspect suspect{origin.place, {}};
      for (std::size_t b = 0; b < Residue::bands; ++b) {
        double power = 0.0, quiet = 0.0;
        for (std::size_t k = 1; k < noise.size(); ++k) {
          const double f = static_cast<double>(k) * resolution;
          if (f < edges[b] || f >= edges[b + 1]) continue;
          quiet += noise[k];
          if (!origin.sensor) {
            power += std::norm(window_.gain(0, f));
            continue;
          }
          std::complex<double> gain;
          for (const Term& t : relation.sum) {
            if (t.channel == *origin.sensor) gain += t.factor * window_.gain(t.order, f);
          }
          power += std::norm(gain);
          if (!relation.deflection || !(deflection_noise > 0.0)) continue;
          for (const Term& t : *relation.deflection) {
            if (t.channel == *origin.sensor)
              power += t.factor * t.factor * carried[k] / (2.0 * period * deflection_noise);
          }
        }
        suspect.gain[b] = quiet > 0.0 ? power / quiet : 0.0;
      }
      out.suspects.push_back(std::move(suspect));
    }
  }

  const RigDescription& description_;
  const std::vector<Recording>& recordings_;
  SmoothWindow window_;
};

}  // namespace

std::vector<Residue> redundancy(const RigDescription& description, const std::vector<Evidence>& evidence) {
  for (const PlacedEffect& effect : effects_of(description.rig)) {
    const auto place = effect.entry->place;
    if (place != model::Place::suspension && place != model::Place::fdva && place != model::Place::machine) return {};
  }
  std::vector<Recording> recordings;
  for (const Evidence& e : evidence) {
    const auto most = static_cast<std::size_t>(looked_at / e.recording.sample_period);
    if (e.fit.size() > 0) recordings.push_back(cut(e.recording, e.fit.from, std::min(e.fit.to, e.fit.from + most)));
  }
  if (recordings.empty()) return {};
  const Relations relations(description, recordings);
  std::vector<Residue> list;
  for (const Relation& relation : relations_of(description.rig, recordings.front())) {
    list.push_back(relations.residue(relation));
  }
  return list;
}

std::string likely_place(const std::vector<Residue>& residues) {
  double all = 0.0;
  std::vector<std::string> places;
  for (const Residue& r : residues) {
    for (const double x : r.excess) all += r.loud() ? x * x : 0.0;
    for (const auto& suspect : r.suspects) {
      if (std::find(places.begin(), places.end(), suspect.place) == places.end()) places.push_back(suspect.place);
    }
  }
  if (!(all > 0.0)) return "";
  // Of each place the spectrum that explains most, band by band: x ≈ power · gain over the relations.
  std::vector<std::pair<double, std::string>> unexplained;
  for (const std::string& place : places) {
    double left = 0.0;
    for (std::size_t b = 0; b < Residue::bands; ++b) {
      double xg = 0.0, gg = 0.0, xx = 0.0;
      for (const Residue& r : residues) {
        const auto suspect = std::find_if(r.suspects.begin(), r.suspects.end(),
                                          [&](const Residue::Suspect& s) { return s.place == place; });
        const double gain = suspect == r.suspects.end() ? 0.0 : suspect->gain[b], x = std::max(r.excess[b], 0.0);
        xg += x * gain;
        gg += gain * gain;
        xx += x * x;
      }
      left += xx - (gg > 0.0 ? xg * xg / gg : 0.0);
    }
    unexplained.emplace_back(left / all, place);
  }
  std::sort(unexplained.begin(), unexplained.end());
  constexpr double enough = 0.1, as_good = 0.02;
  if (unexplained.empty() || unexplained.front().first > enough) return "";
  std::string words;
  int count = 0;
  for (const auto& [left, place] : unexplained) {
    if (left > unexplained.front().first + as_good) break;
    words += (words.empty() ? "" : " or ") + place;
    ++count;
  }
  return count > 3 ? "" : words;
}

}  // namespace host_sim::diagnose
