#include "host_sim/identification/prepare/noise_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "host_sim/identification/common/butterworth.hpp"
#include "host_sim/identification/common/golden_section.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/signal/summary.hpp"

namespace host_sim::identification {
namespace {

/// |H(x)|² of a Butterworth low-pass.
double butterworth_power(int order, double x) { return 1.0 / (1.0 + std::pow(x * x, order)); }

/// Images k = −folds … folds of (1). Those beyond have 1e-3 of the amplitude at the Nyquist frequency.
constexpr int folds = 8;

/// (2); corner and f in units of the sample rate. Of first order in closed form: its images fall too slowly for a sum.
double held_power(int order, double corner, double f, double late) {
  using std::numbers::pi;
  if (f < 1e-9) return 1.0;
  if (order == 1) {
    const double forgets = std::exp(-2.0 * pi * corner);
    const double forgets_since = std::exp(-2.0 * pi * corner * (late < 0.0 ? 1.0 + late : late));
    const std::complex<double> before = std::polar(1.0, -2.0 * pi * f);
    return std::norm(1.0 - forgets_since + forgets_since * (1.0 - forgets) * before / (1.0 - forgets * before));
  }
  std::complex<double> sum = 0.0;
  for (int k = -folds; k <= folds; ++k) {
    sum += butterworth(order, (f + k) / corner) * std::polar(1.0, 2.0 * pi * late * k) / (f + k);
  }
  return std::norm(sum * std::sin(pi * f) / pi);
}

/// Power of a channel in a narrow band: the median over its lines.
struct BandLevel {
  double frequency, power, freedom, tail;  ///< ν of (5); q(f) of (4)
};

/// A channel's bands where motion may be, and above it.
struct ChannelBands {
  std::vector<BandLevel> below, levels;
  bool begin_above_motion = false;  ///< at noise_begins; at a low sample rate motion may reach beyond
};

/// Of an even number of values the mean of the two in the middle.
double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return values.size() % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

std::vector<BandLevel> band_levels(const PowerSpectrum& spectrum, double period, bool is_position, double first,
                                   double last, double bands) {
  const double rate = 1.0 / period;
  const double averages = 1.0 / std::pow(spectrum.relative_standard_error, 2);
  const double width = (last - first) / bands;
  std::vector<BandLevel> levels;
  std::vector<double> lines;
  std::size_t k = 0;
  while (k < spectrum.frequency.size() && spectrum.frequency[k] < first) ++k;
  for (int b = 0; b < static_cast<int>(bands); ++b) {
    const double end = first + width * (b + 1);
    lines.clear();
    double sum = 0.0;  // of the lines' frequencies: where noise falls, half a line of one side is 2 % of its power
    for (; k < spectrum.frequency.size() && spectrum.frequency[k] < end; ++k) {
      lines.push_back(spectrum.density[k]);
      sum += spectrum.frequency[k];
    }
    if (lines.empty()) continue;
    const double f = sum / static_cast<double>(lines.size());
    // A line is a χ² of 2 · averages degrees of freedom ÷ that number; its median is (1 − 1/(9 averages))³ of its mean.
    const double median_of_mean = std::pow(1.0 - 1.0 / (9.0 * averages), 3);
    const double power = median(lines) * 0.5 * rate / median_of_mean;
    // Hann: neighbouring lines share 35/18; the median of many scatters as the mean of 1/1.57 as many.
    const double freedom = averages * std::max(1.0, static_cast<double>(lines.size()) / (35.0 / 18.0 * 1.57));
    const double step = 1.0 / (4.0 * std::pow(std::sin(std::numbers::pi * f * period), 2));
    levels.push_back({f, power, freedom, is_position ? step * step : step});
  }
  return levels;
}

ChannelBands bands_of(const std::vector<double>& samples, double period, bool is_position) {
  const double rate = 1.0 / period;
  const auto segment = static_cast<std::size_t>(rate);
  if (samples.size() < 8 * segment || segment < 32) return {};
  const PowerSpectrum spectrum = welch(samples, rate, segment);
  const double first = std::min(thresholds::noise_begins, thresholds::noise_begins_share * rate);
  const double below = thresholds::slowest_noise_seen;
  return {band_levels(spectrum, period, is_position, below, first, thresholds::motion_spectrum_bands),
          band_levels(spectrum, period, is_position, first, thresholds::noise_ends_share * rate,
                      thresholds::noise_spectrum_bands),
          first >= thresholds::noise_begins};
}

/// Removes the bands in which a filter leaves so little that rounding is seen. Returns whether there are any.
bool drop_rounding(std::vector<BandLevel>& levels) {
  const double least = levels.empty() ? 0.0 : thresholds::least_filtered_power * levels.front().power;
  const auto nothing =
      std::find_if(levels.begin(), levels.end(), [&](const BandLevel& l) { return !(l.power > least); });
  const bool any = nothing != levels.end();
  levels.erase(nothing, levels.end());
  return any;
}

struct LevelFit {
  double square = 0.0, tail = 0.0;  ///< level² and b of (3)
  double deviance = std::numeric_limits<double>::infinity();
  double relative_error = 0.0;  ///< of level²
};

/// The bands with the tail of a motion that a filter rounds off, q(f) = 1/(2πfT)^{2·order}.
std::vector<BandLevel> with_tail_of_order(std::vector<BandLevel> levels, int order, double period) {
  for (BandLevel& l : levels) l.tail = std::pow(2.0 * std::numbers::pi * l.frequency * period, -2 * order);
  return levels;
}

enum class Tail : unsigned char { none, of_steps, of_motion };  ///< (4), (4′)

/// ν of (6), `loose`: the share of the power whose form is not known exactly.
double freedom_of(const BandLevel& level, double loose, double period) {
  const double form = loose * thresholds::form_known_to / (1.0 - 2.0 * level.frequency * period);
  return 1.0 / (1.0 / level.freedom + form * form);
}

/// level² and b for one h: Fisher scoring, since (3) is linear in both. `is_read`: d of (2) is known.
LevelFit fit_level(const std::vector<BandLevel>& levels, const NoiseColour& colour, double period, Tail tail,
                   bool is_read = false) {
  LevelFit fit;
  const bool is_exact = is_read || colour.is_white() || colour.filter != NoiseColour::Filter::held;
  std::vector<double> h, expected, freedom;
  for (const BandLevel& l : levels) {
    h.push_back(colour.power(l.frequency, period));
    freedom.push_back(freedom_of(l, is_exact ? 0.0 : 1.0, period));
    expected.push_back(l.power);
  }
  for (int round = 0; round < 8; ++round) {
    double a11 = 0.0, a12 = 0.0, a22 = 0.0, b1 = 0.0, b2 = 0.0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const BandLevel& l = levels[i];
      const double weight = freedom[i] / std::pow(expected[i], 2), u = h[i], v = h[i] * l.tail;
      a11 += weight * u * u;
      a12 += weight * u * v;
      a22 += weight * v * v;
      b1 += weight * u * l.power;
      b2 += weight * v * l.power;
    }
    const double determinant = a11 * a22 - a12 * a12;
    fit.square = b1 / a11;
    fit.tail = 0.0;
    double variance = 1.0 / a11;
    if (tail != Tail::none && determinant > 1e-9 * a11 * a22) {
      const double square = (a22 * b1 - a12 * b2) / determinant, moving = (a11 * b2 - a12 * b1) / determinant;
      variance = a22 / determinant;
      if (square >= 0.0 && moving >= 0.0) {
        fit.square = square;
        fit.tail = moving;
      } else if (square < 0.0) {
        fit.square = 0.0;
        fit.tail = b2 / a22;
      }
    }
    fit.relative_error = fit.square > 0.0 ? std::sqrt(variance) / fit.square : 1.0;
    fit.deviance = 0.0;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      expected[i] = std::max(h[i] * (fit.square + fit.tail * levels[i].tail), 1e-300);
      const double ratio = levels[i].power / expected[i];
      if (tail == Tail::of_motion) {
        const double moving = h[i] * fit.tail * levels[i].tail / expected[i];
        freedom[i] = freedom_of(levels[i], moving, period);
      }
      fit.deviance += 2.0 * freedom[i] * (ratio - 1.0 - std::log(ratio)) + std::log(levels[i].freedom / freedom[i]);
    }
  }
  return fit;
}

struct ColourFit {
  NoiseColour colour;
  LevelFit level;
  double price = std::numeric_limits<double>::infinity();  ///< (5)
  double corner_error = 0.0;                               ///< relative standard error
};

/// Relative standard error of a corner from the curvature of the deviance over its logarithm, which rises by 1 at one
/// of them; at most 1.
template <class Deviance>
double corner_error(const Deviance& deviance_at) {
  constexpr double difference = 0.02;
  const double curvature = (deviance_at(difference) + deviance_at(-difference) - 2.0 * deviance_at(0.0)) / 2.0;
  return curvature > 0.0 ? std::min(difference / std::sqrt(curvature), 1.0) : 1.0;
}

double corner_error(const std::vector<BandLevel>& levels, const NoiseColour& colour, double period, Tail tail) {
  return corner_error([&](double logarithm) {
    NoiseColour tried = colour;
    tried.corner *= std::exp(logarithm);
    return fit_level(levels, tried, period, tail).deviance;
  });
}

/// true: in each band below noise_begins the noise has less than thresholds::most_noise_of_power times the channel's
/// power. More than the channel's own power is impossible; the rest allows for the error of the fit.
bool holds_noise(const std::vector<BandLevel>& below, const NoiseColour& colour, double square, double period) {
  return std::all_of(below.begin(), below.end(), [&](const BandLevel& l) {
    return square * colour.power(l.frequency, period) < thresholds::most_noise_of_power * l.power;
  });
}

double lowest_corner(const std::vector<BandLevel>& levels) {
  return thresholds::lowest_corner_share * levels.front().frequency;
}

/// Below the lowest corner only the product of level and corner is seen.
bool is_unseen(const std::vector<BandLevel>& levels, const NoiseColour& colour) {
  return colour.corner < 1.01 * lowest_corner(levels);
}

/// The best corner of one kind of low-pass that the channel can hold: a scan, then golden section.
ColourFit fit_corner(const ChannelBands& bands, NoiseColour colour, double period, Tail tail) {
  const std::vector<BandLevel>& levels = bands.levels;
  const auto deviance_at = [&](double logarithm) {
    NoiseColour tried = colour;
    tried.corner = std::exp(logarithm);
    const LevelFit level = fit_level(levels, tried, period, tail);
    const bool held = holds_noise(bands.below, tried, level.square, period);
    return held ? level.deviance : std::numeric_limits<double>::infinity();
  };
  const double lowest = std::log(lowest_corner(levels));
  const double highest = std::log(0.49 / period);
  constexpr int scanned = 24;
  const double step = (highest - lowest) / scanned;
  double best = lowest, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= scanned; ++i) {
    const double deviance = deviance_at(lowest + step * i);
    if (deviance < least) {
      least = deviance;
      best = lowest + step * i;
    }
  }
  const LowestPoint found =
      golden_section(deviance_at, std::max(lowest, best - step), std::min(highest, best + step), 16);
  ColourFit fit{colour, {}, 0.0, 0.0};
  fit.colour.corner = std::exp(found.at);
  fit.level = fit_level(levels, fit.colour, period, tail);
  fit.corner_error = corner_error(levels, fit.colour, period, tail);
  return fit;
}

}  // namespace

double NoiseColour::power(double f, double period) const {
  if (is_white()) return 1.0;
  using std::numbers::pi;
  const double turns = std::min(f * period, 0.4999), edge = std::min(corner * period, 0.4999);
  switch (filter) {
    case Filter::analogue:
      return butterworth_power(order, turns / edge);
    case Filter::folded:
      return butterworth_power(order, std::sin(pi * turns) / std::sin(pi * edge));
    case Filter::held:
      return held_power(order, edge, turns, late);
    case Filter::digital:
      break;
  }
  return butterworth_power(order, std::tan(pi * turns) / std::tan(pi * edge));
}

double NoiseColour::mean_power(double period) const {
  if (is_white()) return 1.0;
  constexpr int lines = 512;
  double sum = 0.0;
  for (int i = 0; i < lines; ++i) sum += power((i + 0.5) / (2.0 * lines * period), period);
  return sum / lines;
}

double ChannelNoise::rms(double period) const { return level * std::sqrt(colour.mean_power(period)); }

bool ChannelNoise::is_known() const { return relative_error <= thresholds::noise_level_known; }

bool ChannelNoise::shows_a_filter() const {
  return is_known() && !colour.is_white() && corner_half_width <= thresholds::corner_known * colour.corner;
}

namespace {

/// The cheapest law of (5) among white noise and low-passes, with and without the tail of (4).
ColourFit best_colour(const ChannelBands& bands, double period, const std::optional<NoiseColour>& expected) {
  const std::vector<BandLevel>& levels = bands.levels;
  ColourFit best;
  const auto consider = [&](ColourFit fit, double parameters) {
    fit.price = fit.level.deviance + thresholds::colour_price * parameters;
    const bool is_possible = fit.colour.is_white() || holds_noise(bands.below, fit.colour, fit.level.square, period);
    if (is_possible && fit.price < best.price) best = fit;
  };
  const double corner_price = expected ? thresholds::other_corner_price / thresholds::colour_price : 1.0;
  for (const Tail tail : {Tail::none, Tail::of_steps}) {
    const double of_tail = tail == Tail::none ? 0.0 : 1.0;
    if (expected) {
      // Whose own spectrum hardly shows the corner takes it from the others, and says little of it.
      const double error = std::min(corner_error(levels, *expected, period, tail), thresholds::corner_known / 2.0);
      consider({*expected, fit_level(levels, *expected, period, tail), 0.0, error}, of_tail);
    }
    consider({{}, fit_level(levels, {}, period, tail), 0.0, 0.0}, of_tail);
    for (int order = 1; order <= thresholds::highest_filter_order; ++order) {
      using enum NoiseColour::Filter;
      for (const NoiseColour::Filter filter : {digital, analogue, folded, held}) {
        if (filter == held && (order == 1 || tail != Tail::none || !bands.begin_above_motion)) continue;
        consider(fit_corner(bands, {0.0, order, filter}, period, tail), of_tail + corner_price);
      }
    }
  }
  return best;
}

/// Held noise behind a low-pass of one order, with the instant d of (2) at which it is read, and the corner near
/// `start` that goes with it. Of d is known what is usual, thresholds::usual_reading; to its price, without those of
/// parameters, it adds what that costs.
ColourFit read_at_its_instant(const std::vector<BandLevel>& levels, double period, double start, int order) {
  constexpr double range = 0.5;  // of the corner's logarithm
  constexpr int rounds = 12;     // to 3e-3 of a range
  const auto fit_at = [&](double logarithm, double late) {
    ColourFit fit{{start * std::exp(logarithm), order, NoiseColour::Filter::held, late}, {}, 0.0, 0.0};
    fit.level = fit_level(levels, fit.colour, period, Tail::none, true);
    fit.price = fit.level.deviance + std::pow(late / thresholds::usual_reading, 2);
    return fit;
  };
  const auto best_instant = [&](double logarithm) {
    return golden_section([&](double late) { return fit_at(logarithm, late).price; }, -thresholds::latest_reading,
                          thresholds::latest_reading, rounds);
  };
  const double at = golden_section([&](double x) { return best_instant(x).value; }, -range, range, rounds).at;
  ColourFit read = fit_at(at, best_instant(at).at);
  read.corner_error = corner_error([&](double more) { return best_instant(at + more).value; });
  return read;
}

/// The same colour, or held noise of this order or a lower one where that is better: when it is read, its form is near
/// those of other kinds and orders. Not what may be a tail as well.
void set_instant(const ChannelBands& bands, double period, ColourFit& fit) {
  const bool is_digital = fit.colour.order > 1 && fit.colour.filter == NoiseColour::Filter::digital;
  const bool may_be_tail = fit.level.tail > 0.0 || is_unseen(bands.levels, fit.colour);
  if (fit.colour.is_white() || is_digital || may_be_tail || !bands.begin_above_motion) return;
  const NoiseColour before = fit.colour;
  const double of_parameters = fit.price - fit.level.deviance;
  fit.price = of_parameters + fit_level(bands.levels, before, period, Tail::none, true).deviance;
  for (int order = before.order; order >= 1; --order) {
    ColourFit read = read_at_its_instant(bands.levels, period, before.corner, order);
    read.price += of_parameters;
    if (read.price < fit.price && holds_noise(bands.below, read.colour, read.level.square, period)) fit = read;
  }
}

/// The cheapest tail of (4′) over white noise that is seen.
ColourFit best_floor(const std::vector<BandLevel>& levels, double period) {
  constexpr double tail_and_order = 2.0;
  ColourFit best;
  for (int order = thresholds::flattest_motion; order <= thresholds::steepest_motion; ++order) {
    ColourFit fit{{}, fit_level(with_tail_of_order(levels, order, period), {}, period, Tail::of_motion), 0.0, 0.0};
    fit.price = fit.level.deviance + thresholds::colour_price * tail_and_order;
    const bool seen = 0.5 * fit.level.relative_error < thresholds::noise_level_known;
    if (seen && fit.price < best.price) best = fit;
  }
  return best;
}

/// Noise below the tail of a foot point's motion; none where rounding could make it.
std::optional<ColourFit> floor_of_motion(const std::vector<BandLevel>& levels, const std::vector<double>& samples,
                                         double period) {
  const ColourFit floor = best_floor(levels, period);
  if (std::sqrt(floor.level.square) > thresholds::least_floor * largest_magnitude(samples)) return floor;
  return std::nullopt;
}

}  // namespace

std::optional<NoiseSpectrumFit> fit_noise_spectrum(const std::vector<double>& samples, double period, bool is_position,
                                                   const std::optional<NoiseColour>& expected, bool is_foot_point) {
  ChannelBands bands = bands_of(samples, period, is_position);
  std::vector<BandLevel>& levels = bands.levels;
  constexpr std::size_t fewest = 6;
  if (levels.size() < fewest) return std::nullopt;
  // A floor that rounding cannot make is judged in all bands; where there is none, a filter ends in rounding.
  const auto floor = is_foot_point ? floor_of_motion(levels, samples, period) : std::nullopt;
  NoiseSpectrumFit fit;
  ColourFit best;
  if (floor && floor->price < best_colour(bands, period, expected).price + thresholds::other_corner_price) {
    best = *floor;
  } else {
    fit.noise.ends = drop_rounding(levels);
    if (levels.size() < fewest) return std::nullopt;
    best = best_colour(bands, period, expected);
    if (!expected || best.colour != *expected) set_instant(bands, period, best);
  }
  fit.noise.colour = best.colour;
  double lowest = std::numeric_limits<double>::infinity(), least_bound = lowest;
  for (const BandLevel& l : levels) {
    const double white = l.power / best.colour.power(l.frequency, period);
    lowest = std::min(lowest, white);
    least_bound = std::min(least_bound, white * (1.0 + thresholds::highest_level_deviations / std::sqrt(l.freedom)));
  }
  fit.noise.level = std::sqrt(std::max(best.level.square, thresholds::least_of_tail * lowest));
  fit.noise.highest_level = std::sqrt(least_bound);
  fit.noise.relative_error = 0.5 * best.level.relative_error;
  fit.noise.corner_half_width = 1.96 * best.corner_error * best.colour.corner;
  fit.tail = best.level.tail;
  const bool is_expected = expected && best.colour.corner == expected->corner;
  if (fit.tail > 0.0 && !is_expected) fit.noise.corner_half_width = best.colour.corner;
  if (!is_expected && is_unseen(levels, best.colour)) {
    fit.noise.corner_half_width = thresholds::unseen_corner * best.colour.corner;
  }
  return fit;
}

std::optional<NoiseColour> expected_colour(const ChannelNoises& noises) {
  std::vector<NoiseColour> colours;
  std::size_t known = 0, shown = 0;
  for (std::size_t c = 0; c < noises.size(); ++c) {
    if (model::unit(model::channel_at(c)) != "m" || !(noises[c].level > 0.0) || !noises[c].is_known()) continue;
    ++known;
    if (noises[c].colour.is_white()) continue;
    colours.push_back(noises[c].colour);
    if (noises[c].corner_half_width < thresholds::unseen_corner * noises[c].colour.corner) ++shown;
  }
  if (colours.empty() || 2 * colours.size() < known) return std::nullopt;
  if (shown == 0 && colours.size() == 1) return std::nullopt;  // nobody sees it
  const auto middle = colours.begin() + static_cast<std::ptrdiff_t>(colours.size() / 2);
  std::nth_element(colours.begin(), middle, colours.end(),
                   [](const NoiseColour& a, const NoiseColour& b) { return a.corner < b.corner; });
  return *middle;
}

}  // namespace host_sim::identification
