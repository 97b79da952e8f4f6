#include "host_sim/replicate/replicate_report.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/simulation/road.hpp"
#include "host_sim/replicate/thresholds.hpp"
#include "host_sim/report/formatted.hpp"
#include "host_sim/report/report.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {
namespace {

using Values = std::vector<double>;

std::string name_of(const Replication& r, std::size_t c) {
  return std::string(model::name(r.target().channels[c].channel));
}
std::string unit_of(const Replication& r, std::size_t c) {
  return std::string(model::unit(r.target().channels[c].channel));
}
std::string percent(double value, int digits = 3) {
  return std::isfinite(value) ? report::figure_text(100.0 * value, digits) + " %" : "–";
}

/// Target and what came of it, in the band.
struct Pair {
  Values wanted, reached;
  bool measured;
};

Pair pair_of(const Replication& r, std::size_t c) {
  const bool run = !r.runs().empty() && !r.runs().back().measured[c].empty();
  return {r.in_band(c, r.target().values[c]), r.in_band(c, run ? r.runs().back().measured[c] : r.predicted()[c]), run};
}

/// The events of a signal, one after the other.
Values over_events(const Replication& r, const Values& values) {
  const std::size_t end = r.runs().empty() ? values.size() : std::min(values.size(), r.runs().back().samples);
  Values all;
  for (const Part& part : r.target().events) {
    for (std::size_t k = part.from; k < std::min(part.to, end); ++k) all.push_back(values[k]);
  }
  return all;
}

/// Where the error is largest over a second.
std::size_t worst_second(const Replication& r, const Pair& pair) {
  const auto second = static_cast<std::size_t>(1.0 / r.target().period);
  std::size_t worst = r.target().events.front().from;
  double most = -1.0;
  for (const Part& part : r.target().events) {
    for (std::size_t k = part.from; k + second <= part.to; k += std::max<std::size_t>(1, second / 4)) {
      double squares = 0.0;
      for (std::size_t i = k; i < k + second; ++i) squares += std::pow(pair.wanted[i] - pair.reached[i], 2);
      if (squares > most) {
        most = squares;
        worst = k;
      }
    }
  }
  return worst;
}

report::Figure error_by_run(const Replication& r) {
  report::Panel panel{.y = {.quantity = "error ÷ target", .unit = "%", .logarithmic = true}};
  for (std::size_t c = 0; c < r.target().channels.size(); ++c) {
    report::Curve measured{.name = name_of(r, c) + " on the rig",
                           .x = {},
                           .y = {},
                           .colour = static_cast<int>(c % 6),
                           .dash = report::Dash::solid,
                           .marker = report::Marker::circle};
    report::Curve predicted{.name = name_of(r, c) + " predicted",
                            .x = {},
                            .y = {},
                            .colour = static_cast<int>(c % 6),
                            .dash = report::Dash::dotted,
                            .marker = report::Marker::open_circle};
    for (std::size_t i = 0; i < r.results().size(); ++i) {
      const double run = static_cast<double>(i + 1);
      if (std::isfinite(r.results()[i].error[c])) {
        measured.x.push_back(run);
        measured.y.push_back(100.0 * r.results()[i].error[c]);
      }
      if (std::isfinite(r.results()[i].predicted[c]) && r.results()[i].predicted[c] > 0.0) {
        predicted.x.push_back(run);
        predicted.y.push_back(100.0 * r.results()[i].predicted[c]);
      }
    }
    if (!measured.x.empty()) panel.curves.push_back(std::move(measured));
    if (!predicted.x.empty()) panel.curves.push_back(std::move(predicted));
  }
  panel.guides.push_back({.along = report::Guide::Along::y, .value = 100.0 * r.goal(), .label = "goal"});
  return {.title = "Error by run",
          .note = "rms(target − reached) ÷ rms(target) in the band. Predicted: by the model, before the run.",
          .x = {.quantity = "run", .unit = "1", .range = std::pair{0.5, static_cast<double>(r.results().size()) + 0.5}},
          .panels = {panel},
          .height = 360};
}

report::Figure in_time(const Replication& r, std::size_t c, const Pair& pair) {
  constexpr std::size_t most = 40000;  // samples in a figure
  const std::size_t worst = worst_second(r, pair);
  const double h = r.target().period;
  const std::size_t n = pair.wanted.size();
  const std::size_t from = n <= most || worst < most / 2 ? 0 : std::min(worst - most / 2, n - most),
                    to = std::min(n, from + most);
  report::Curve wanted{.name = "target", .x = {}, .y = {}, .colour = 6, .dash = report::Dash::solid};
  report::Curve reached{
      .name = pair.measured ? "reached" : "predicted", .x = {}, .y = {}, .colour = 1, .dash = report::Dash::solid};
  report::Curve error{.name = "error", .x = {}, .y = {}, .colour = 0, .dash = report::Dash::solid};
  for (std::size_t k = from; k < to; ++k) {
    const double t = h * static_cast<double>(k);
    for (report::Curve* curve : {&wanted, &reached, &error}) curve->x.push_back(t);
    wanted.y.push_back(pair.wanted[k]);
    reached.y.push_back(pair.reached[k]);
    error.y.push_back(pair.wanted[k] - pair.reached[k]);
  }
  const double begin = h * static_cast<double>(worst);
  std::string note = formatted("Shown first: the worst second, from %.4g s. Zoom out for the rest.", begin);
  if (to - from < n) note += formatted(" The page holds %.0f s around it.", h * static_cast<double>(most));
  return {.title = name_of(r, c) + " over time",
          .note = note,
          .x = {.quantity = "time in the drive", .unit = "s", .range = std::pair{begin, begin + 1.0}},
          .panels = {{.y = {.quantity = name_of(r, c), .unit = unit_of(r, c)}, .curves = {wanted, reached}},
                     {.y = {.quantity = "error", .unit = unit_of(r, c)}, .curves = {error}, .share = 0.4}},
          .height = 460};
}

report::Figure spectra(const Replication& r, std::size_t c, const Pair& pair) {
  const double rate = 1.0 / r.target().period;
  Values wanted = over_events(r, pair.wanted), reached = over_events(r, pair.reached), error = wanted;
  for (std::size_t k = 0; k < error.size(); ++k) error[k] -= reached[k];
  const FrequencyBand& band = r.target().channels[c].band;
  report::Panel panel{.y = {.quantity = "spectral density of " + name_of(r, c),
                            .unit = "(" + unit_of(r, c) + ")²/Hz",
                            .logarithmic = true}};
  const auto segment = std::min(wanted.size(), static_cast<std::size_t>(std::min(8.0, 4.0 / band.lowest) * rate));
  const auto add = [&](const Values& values, const std::string& name, int colour) {
    const PowerSpectrum s = welch(values, rate, segment);
    report::Curve curve{.name = name, .x = {}, .y = {}, .colour = colour, .dash = report::Dash::solid};
    for (std::size_t k = 1; k < s.frequency.size(); ++k) {
      if (s.frequency[k] < 0.9 * band.lowest || s.frequency[k] > band.highest) continue;
      curve.x.push_back(s.frequency[k]);
      curve.y.push_back(std::max(s.density[k], 1e-300));
    }
    panel.curves.push_back(std::move(curve));
  };
  add(wanted, "target", 6);
  add(reached, pair.measured ? "reached" : "predicted", 1);
  add(error, "error", 0);
  return {.title = "Spectrum of " + name_of(r, c),
          .note = formatted("Replicated from %.3g to %.3g Hz.", band.lowest, band.highest),
          .x = {.quantity = "frequency", .unit = "Hz", .logarithmic = true},
          .panels = {panel}};
}

report::Figure crossings(const Replication& r, std::size_t c, const Pair& pair) {
  const Values wanted = over_events(r, pair.wanted), reached = over_events(r, pair.reached);
  const auto [low, high] = std::minmax_element(wanted.begin(), wanted.end());
  const auto [least, most] = std::minmax_element(reached.begin(), reached.end());
  const double lowest = std::min(*low, *least), highest = std::max(*high, *most);
  Values levels;
  for (int i = 0; i <= 60; ++i) levels.push_back(lowest + (highest - lowest) * i / 60.0);
  report::Panel panel{.y = {.quantity = name_of(r, c), .unit = unit_of(r, c)}};
  const auto add = [&](const Values& values, const std::string& name, int colour) {
    report::Curve curve{.name = name, .x = {}, .y = {}, .colour = colour, .dash = report::Dash::solid};
    const Values counts = level_crossings(values, levels);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      if (!(counts[i] > 0.0)) continue;
      curve.x.push_back(counts[i]);
      curve.y.push_back(levels[i]);
    }
    if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
  };
  add(wanted, "target", 6);
  add(reached, pair.measured ? "reached" : "predicted", 1);
  return {.title = "Level crossings of " + name_of(r, c),
          .note = "How often the signal goes upwards through each level.",
          .x = {.quantity = "crossings", .unit = "1", .logarithmic = true},
          .panels = {panel}};
}

report::Figure rainflow_figure(const Replication& r, std::size_t c, const Pair& pair, bool of_target) {
  const Values values = over_events(r, of_target ? pair.wanted : pair.reached), wanted = over_events(r, pair.wanted);
  const auto [low, high] = std::minmax_element(wanted.begin(), wanted.end());
  const RainflowMatrix matrix = rainflow_matrix(rainflow(values), *low, *high, 32);
  report::HeatMap map{.quantity = "log₁₀(1 + cycles)", .unit = "1", .x = {}, .y = {}, .values = {}};
  for (std::size_t i = 0; i < matrix.classes; ++i) {
    map.x.push_back(matrix.middle(i));
    map.y.push_back(matrix.middle(i));
  }
  for (const double count : matrix.counts) map.values.push_back(std::log10(1.0 + count));
  const std::string what = of_target ? "target" : pair.measured ? "reached" : "predicted";
  return {.title = "Rainflow matrix of " + name_of(r, c) + ", " + what,
          .note = "Cycles by where they begin (up) and where they turn (right); the residue counts as half cycles.",
          .x = {.quantity = "to", .unit = unit_of(r, c)},
          .panels = {{.y = {.quantity = "from", .unit = unit_of(r, c)}, .heat_map = {std::move(map)}}},
          .equal_axes = true,
          .height = 420};
}

report::Table damage_table(const Replication& r) {
  report::Table table{.title = "Relative pseudo-damage, reached ÷ target",
                      .headings = {"channel", "run"},
                      .rows = {},
                      .text_columns = 2};
  for (const int k : damage_exponents) table.headings.push_back("k = " + std::to_string(k));
  for (std::size_t c = 0; c < r.target().channels.size(); ++c) {
    for (std::size_t i = 0; i < r.runs().size(); ++i) {
      std::vector<std::string> row{name_of(r, c), std::to_string(i + 1)};
      for (const double ratio : r.results()[i].damage[c])
        row.push_back(std::isfinite(ratio) ? report::figure_text(ratio, 4) : "–");
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

report::Figure drive_figure(const Replication& r) {
  constexpr std::size_t most = 40000;
  const Values& drive = r.drives().back().values;
  const std::string name(model::name(drive_channel(r.description().rig.kind)));
  const auto step = std::max<std::size_t>(1, drive.size() / most);
  report::Curve position{.name = name, .x = {}, .y = {}, .colour = 0, .dash = report::Dash::solid}, speed = position;
  speed.name = "speed";
  speed.colour = 1;
  const auto motion = firmware::through_samples(drive, 1.0 / r.target().period);
  for (std::size_t k = 0; k < drive.size(); k += step) {
    const double t = r.target().period * static_cast<double>(k);
    position.x.push_back(t);
    position.y.push_back(1e3 * drive[k]);
    speed.x.push_back(t);
    speed.y.push_back(motion[k].velocity);
  }
  return {.title = "The drive: " + r.drives().back().file,
          .note = {},
          .x = {.quantity = "time", .unit = "s"},
          .panels = {{.y = {.quantity = name, .unit = "mm"}, .curves = {position}},
                     {.y = {.quantity = "its speed", .unit = "m/s"}, .curves = {speed}, .share = 0.6}},
          .height = 420};
}

report::Table limits_table(const Replication& r) {
  report::Table table{.title = "Limits used by each drive",
                      .headings = {"drive", "stroke", "speed", "acceleration", "force", "what the limits cost"},
                      .rows = {}};
  for (std::size_t i = 0; i < r.results().size(); ++i) {
    const RunResult& result = r.results()[i];
    std::string cost = "nothing";
    if (!result.unlimited.empty()) {
      cost.clear();
      for (std::size_t c = 0; c < result.unlimited.size(); ++c) {
        cost += (c > 0 ? "; " : "") + name_of(r, c) + ": " + percent(result.predicted[c]) + " instead of " +
                percent(result.unlimited[c]);
      }
    }
    table.rows.push_back({std::to_string(i + 1), percent(result.used.stroke), percent(result.used.speed),
                          percent(result.used.acceleration), percent(result.used.force), cost});
  }
  return table;
}

std::string errors_text(const Replication& r, const Values& errors) {
  std::string text;
  for (std::size_t c = 0; c < errors.size(); ++c)
    text += (c > 0 ? ", " : "") + name_of(r, c) + " " + percent(errors[c]);
  return text;
}

}  // namespace

std::string stop_sentence(const Replication& r) {
  const WorstBand worst = r.worst_band();
  const std::string where = formatted("%s from %.3g to %.3g Hz", std::string(model::name(worst.channel)).c_str(),
                                      worst.band.lowest, worst.band.highest);
  switch (r.stop()) {
    case Stop::none:
      return {};
    case Stop::goal:
      return "Done: the error is below the goal of " + percent(r.goal()) + ".";
    case Stop::noise:
      return "Done: what is left is noise of the sensors.";
    case Stop::limits:
      return "No more to gain: the limits of the machine keep the rest. Largest error: " + where + ".";
    case Stop::unreachable:
      return "No more to gain: one foot point cannot make all targets. Largest error: " + where + ".";
    case Stop::model:
      return "No more to gain with this model. Largest error: " + where + ". --diagnose looks for what it lacks.";
  }
  return {};
}

std::string report_page(const Replication& r) {
  report::Report page("Replication: " + r.recordings().front().source,
                      "The drive that makes " + r.description().source + " do what the target shows.");
  const std::size_t best = r.best();
  if (best < r.runs().size()) {
    const double error = r.error_of(r.results()[best]);
    page.add_verdict(error <= r.goal() ? report::Verdict::good : report::Verdict::remark,
                     formatted("Run %zu is the best of %zu: ", best + 1, r.runs().size()) +
                         errors_text(r, r.results()[best].error) + " of the target is missed.");
  } else {
    page.add_verdict(report::Verdict::remark,
                     "Nothing has moved yet. The model predicts for " + r.drives().back().file + ": " +
                         errors_text(r, r.results().back().predicted) + " of the target will be missed.");
  }
  if (const std::string sentence = stop_sentence(r); !sentence.empty()) page.add_text(sentence);
  page.add_section("Runs");
  page.add_figure(error_by_run(r));
  report::Table unreachable{.title = "Channels",
                            .headings = {"channel", "band [Hz]", "weight", "rms of the target",
                                         "cannot be made by one foot point", "noise", "floor"},
                            .rows = {},
                            .text_columns = 2};
  const Floor floor = r.floor();
  for (std::size_t c = 0; c < r.target().channels.size(); ++c) {
    const TargetChannel& one = r.target().channels[c];
    unreachable.rows.push_back(
        {name_of(r, c), formatted("%.3g … %.3g", one.band.lowest, one.band.highest), report::figure_text(one.weight, 3),
         report::figure_text(r.inverse().target_rms(c), 4) + " " + unit_of(r, c), percent(r.inverse().unreachable()[c]),
         percent(floor.noise[c]), percent(floor.total[c])});
    if (!one.remark.empty()) page.add_text(one.remark + ".");
  }
  page.add_table(unreachable);
  for (std::size_t i = 0; i < r.results().size(); ++i) {
    for (const std::string& remark : r.results()[i].remarks) page.add_text(formatted("%zu: ", i + 1) + remark + ".");
  }
  for (std::size_t c = 0; c < r.target().channels.size(); ++c) {
    const Pair pair = pair_of(r, c);
    page.add_section(name_of(r, c));
    page.add_figure(in_time(r, c, pair));
    page.add_figure(spectra(r, c, pair));
    page.add_figure(crossings(r, c, pair));
    page.add_figure(rainflow_figure(r, c, pair, true));
    page.add_figure(rainflow_figure(r, c, pair, false));
  }
  page.add_section("Damage");
  if (r.runs().empty()) {
    page.add_text("Damage is compared from the first run on.");
  } else {
    page.add_table(damage_table(r));
    page.add_text(
        "Miner's sum over rainflow cycles for Wöhler lines of exponent k; the residue counts as half cycles. 1: the "
        "part ages as it did where the target was recorded.");
  }
  page.add_section("Drive");
  page.add_table(limits_table(r));
  page.add_figure(drive_figure(r));
  page.add_appendix("Rig description", r.description().text);
  return page.html();
}

std::string summary(const Replication& r) {
  std::string text;
  for (const TargetChannel& c : r.target().channels) {
    if (!c.remark.empty()) text += c.remark + "\n";
  }
  for (std::size_t c = 0; c < r.target().channels.size(); ++c) {
    if (r.inverse().unreachable()[c] > 0.01)
      text +=
          name_of(r, c) + ": " + percent(r.inverse().unreachable()[c]) + " of it cannot be made by one foot point\n";
  }
  for (std::size_t i = 0; i < r.results().size(); ++i) {
    const RunResult& result = r.results()[i];
    const bool run = i < r.runs().size();
    text += formatted("run %zu  ", i + 1);
    text += run ? "error " + errors_text(r, result.error) + "   predicted " + errors_text(r, result.predicted)
                : "predicted " + errors_text(r, result.predicted);
    if (run) {
      for (std::size_t c = 0; c < result.damage.size(); ++c)
        text += formatted("   damage (k = 5) of %s %.4g", name_of(r, c).c_str(), result.damage[c][1]);
    }
    text += "\n";
    if (!result.unlimited.empty()) text += "  the limits cost: without them " + errors_text(r, result.unlimited) + "\n";
    for (const std::string& remark : result.remarks) text += "  " + remark + "\n";
  }
  const RunResult& last = r.results().back();
  text += formatted("limits used: stroke %.3g %%, speed %.3g %%, acceleration %.3g %%, force %.3g %%\n",
                    100.0 * last.used.stroke, 100.0 * last.used.speed, 100.0 * last.used.acceleration,
                    100.0 * last.used.force);
  const std::string sentence = stop_sentence(r);
  return sentence.empty() ? text : text + sentence + "\n";
}

}  // namespace host_sim::replicate
