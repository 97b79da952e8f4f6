#include "host_sim/transfer/report/wording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/report/report.hpp"
#include "host_sim/transfer/common/thresholds.hpp"

namespace host_sim::transfer {
namespace {

using report::figure_text;

constexpr std::array<std::string_view, 2> response_words{"the wheel load", "the body acceleration"};

std::string range_of(double lowest, double highest) {
  return figure_text(std::max(lowest, thresholds::lowest_frequency), 3) + " to " + figure_text(highest, 3) + " Hz";
}

/// What must change in the component, from force (3) of the worst band.
std::string direction_of(const BandCheck& band) {
  const double soft = band.force.real(), damped = band.force.imag();
  if (std::max(std::abs(soft), std::abs(damped)) < 0.5 * thresholds::worth_saying) {
    return per_cent(band.deviation) + " off";
  }
  if (std::abs(soft) >= std::abs(damped)) {
    return per_cent(std::abs(soft)) + (soft > 0.0 ? " too soft" : " too stiff");
  }
  return "damped " + per_cent(std::abs(damped)) + " of its force " + (damped > 0.0 ? "too little" : "too much");
}

std::string joined_words(const std::vector<OwnedEffect>& list) {
  std::vector<std::string> texts;
  for (const OwnedEffect& effect : list) texts.push_back(words(effect));
  return identification::joined(texts);
}

std::string lines_text(const Validation& v) {
  return figure_text(100.0 * v.coverage95, 3) + " % of the lines lie in the 95 % band, " +
         figure_text(100.0 * v.coverage50, 3) + " % in the 50 % band";
}

/// Significant digits that tell the ends of an interval apart: two of its width, four at least.
int digits_of(const LearnedValue& value) {
  const double width = value.upper - value.lower;
  if (!(width > 0.0) || !(std::abs(value.value) > 0.0)) return 4;
  return std::clamp(static_cast<int>(std::ceil(std::log10(std::abs(value.value) / width))) + 2, 4, 8);
}

/// The bands fail by what the second rig has of its own, and by nothing else.
bool second_rig_explains(const Transfer& t) {
  return t.validation && !t.validation->holds && t.overlap.least() >= thresholds::least_overlap &&
         !t.both.second_only.empty() && t.with_own && t.with_own->validation && t.with_own->validation->holds;
}

/// What holds at the end comes first: no band blames the component for what is not its own.
std::string second_rig_text(const Transfer& t) {
  return "The component's model holds with what the second rig has of its own: " + joined_words(t.both.second_only) +
         ". With it the bands hold (" + lines_text(*t.with_own->validation) +
         "). The prediction, made without it, does not hold: ";
}

std::string prediction_text(const Transfer& t) {
  const Bands load = t.prediction.quantity(Quantity::rms_F_w);
  const Budget& budget = t.prediction.budget[0];
  const auto largest = static_cast<std::size_t>(std::max_element(budget.begin(), budget.end()) - budget.begin());
  std::string text = "Predicted rms wheel load: " + figure_text(load.median, 4) + " N, 95 % band " +
                     figure_text(load.low95, 4) + " to " + figure_text(load.high95, 4) + " N";
  if (budget[largest] > 0.0) {
    constexpr std::array<std::string_view, source_count> names{"the component's parameters",
                                                               "effects that rival each other",
                                                               "the discrepancy of the component's model",
                                                               "the second rig's own tolerances",
                                                               "measurement noise",
                                                               "the calibration of the sensors"};
    text += "; " + per_cent(budget[largest]) + " of its variance come from " + std::string(names[largest]);
  }
  return text + ".";
}

}  // namespace

bool Transfer::holds() const { return validation && validation->holds && overlap.least() >= thresholds::least_overlap; }

std::string per_cent(double share) {
  char text[48];
  const double value = 100.0 * share;
  std::snprintf(text, sizeof text, std::abs(value) < 9.95 ? "%.2g %%" : "%.0f %%", value);
  return text;
}

std::string words(const OwnedEffect& effect) {
  std::string text = effect.words.empty() ? effect.name : effect.words;
  std::string values;
  for (const LearnedValue& value : effect.parameters) {
    const int digits = digits_of(value);
    values += (values.empty() ? "" : "; ") + value.path + " = " + figure_text(value.value, digits) +
              (value.unit.empty() || value.unit == "1" ? "" : " " + value.unit) + ", " +
              figure_text(value.lower, digits) + " … " + figure_text(value.upper, digits);
  }
  return values.empty() ? text : text + " (" + values + ")";
}

std::string words(const SharedValue& value) {
  return value.path + ": " + figure_text(value.first.value, 4) + " on the first rig, " +
         figure_text(value.second.value, 4) + " on the second" +
         (value.unit.empty() || value.unit == "1" ? "" : " " + value.unit) + ", " + figure_text(std::abs(value.z), 2) +
         " standard deviations apart: " +
         (value.equal ? "equal, pooled " + figure_text(value.pooled.value, 4) + " (" +
                            figure_text(value.pooled.lower, 4) + " … " + figure_text(value.pooled.upper, 4) + ")"
                      : "not one value, not pooled");
}

std::string words(const NextMeasurement& next) {
  return next.what + ": the component's part of the bands shrinks to " + per_cent(next.remaining) +
         ", the band of the wheel load to " + per_cent(next.band);
}

std::string discrepancy_text(const Posterior& posterior) {
  if (!posterior.discrepancy.measured)
    return "No channel of the first rig stands for the component's force: no discrepancy can be found.";
  if (!posterior.discrepancy.any())
    return "The component's model leaves nothing but noise on the first rig: no discrepancy is carried over.";
  std::string text;
  for (const auto& band : posterior.discrepancy.bands) {
    if (!(band.relative > 0.0)) continue;
    text += (text.empty() ? "" : ", ") + per_cent(band.relative) + " at " + figure_text(band.lowest, 3) + " … " +
            figure_text(band.highest, 3) + " Hz";
  }
  return "The component's model leaves a rest of its force on the first rig (" + text +
         "). It is carried over as a band-limited process beside the parameters. The part that a change of parameters "
         "would imitate cannot be seen in a rest; the parameters are widened by it, which is up to " +
         per_cent(posterior.confounded) + " of a parameter's variance.";
}

std::vector<std::string> range_sentences(const Validation& validation, std::size_t response) {
  std::vector<std::string> sentences;
  std::vector<BandCheck> own;
  for (const BandCheck& band : validation.bands) {
    if (band.response == response) own.push_back(band);
  }
  for (std::size_t i = 0; i < own.size();) {
    std::size_t j = i;
    const auto damping_rules = [](const BandCheck& b) { return std::abs(b.force.imag()) > std::abs(b.force.real()); };
    while (j < own.size() && own[j].holds == own[i].holds &&
           (own[i].holds || (damping_rules(own[j]) == damping_rules(own[i]) &&
                             (own[j].force.real() > 0.0) == (own[i].force.real() > 0.0)))) {
      ++j;
    }
    double width = 0.0, worst = -1.0;
    std::size_t at = i;
    for (std::size_t k = i; k < j; ++k) {
      width = std::max({width, own[k].half_width, own[k].holds ? own[k].deviation : 0.0});
      if (own[k].deviation > worst) {
        worst = own[k].deviation;
        at = k;
      }
    }
    const std::string range = "from " + range_of(own[i].lowest, own[j - 1].highest) + " the component's model ";
    const std::string subject(response_words[response]);
    if (own[i].holds) {
      sentences.push_back(range + "holds to ± " + per_cent(width) + " of " + subject);
    } else {
      const double beyond = own[at].deviation;
      sentences.push_back(range + "is " + direction_of(own[at]) + " beyond what parameters allow: " + subject + " is " +
                          per_cent(beyond) + " off, the band allows ± " + per_cent(own[at].half_width));
    }
    i = j;
  }
  return sentences;
}

std::string verdict_text(const Transfer& t) {
  std::string text;
  if (!t.validation) {
    text = "No recording of the second rig: a prediction, not validated. " + prediction_text(t);
  } else {
    const Validation& v = *t.validation;
    const bool shown = t.overlap.least() >= thresholds::least_overlap;
    text = !shown    ? "The first rig was not excited where the second one moves: no verdict on the component. "
           : v.holds ? "The prediction holds: "
           : second_rig_explains(t) ? second_rig_text(t)
                                    : "The prediction does not hold: ";
    std::string sentences;
    for (std::size_t r = 0; r < 2; ++r) {
      for (const std::string& sentence : range_sentences(v, r)) sentences += (sentences.empty() ? "" : "; ") + sentence;
    }
    if (shown && !second_rig_explains(t)) text += sentences + ". ";
    text += lines_text(v) + ". " + prediction_text(t);
    const Bands load = t.prediction.quantity(Quantity::rms_F_w);
    const double measured = v.measured.quantity[0];
    if (std::isfinite(measured)) {
      text += " Measured: " + figure_text(measured, 4) + " N" +
              (measured >= load.low95 && measured <= load.high95 ? "." : ", outside of it.");
    }
  }
  if (!t.both.travels.empty()) text += " What travels: " + joined_words(t.both.travels) + ".";
  if (!t.both.stays.empty()) text += " What stays on the first rig: " + joined_words(t.both.stays) + ".";
  if (!t.both.second_only.empty() && !second_rig_explains(t)) {
    text += " On the second rig alone: " + joined_words(t.both.second_only) + ".";
    if (t.with_own && t.with_own->validation) {
      text += std::string(t.with_own->validation->holds ? " With it the bands hold ("
                                                        : " With it the bands still do not hold (") +
              lines_text(*t.with_own->validation) + ").";
    }
  }
  if (!t.both.component_on_second_only.empty()) {
    text += " The component shows on the second rig what the first did not: " +
            joined_words(t.both.component_on_second_only) + ".";
  }
  for (const SharedValue& shared : t.both.shared) {
    if (!shared.equal) text += " " + words(shared) + ".";
  }
  if (t.both.second_unexplained) text += " The second rig's own diagnosis leaves a rest that it does not explain.";
  if (t.overlap.least() < thresholds::full_overlap) {
    text += " Of the second rig's motion the first has shown " + per_cent(t.overlap.in_frequency) +
            " by frequency and " + per_cent(t.overlap.in_travel) + " by travel; the rest is extrapolated.";
  }
  return text;
}

}  // namespace host_sim::transfer
