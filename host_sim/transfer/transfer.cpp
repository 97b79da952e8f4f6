#include "host_sim/transfer/transfer.hpp"

#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"
#include "host_sim/transfer/report/wording.hpp"

namespace host_sim::transfer {
namespace {

/// A share of the whole, as the progress of one step.
TransferProgress step_of(const TransferProgress& progress, double from, double to, std::string what) {
  if (!progress) return {};
  return [progress, from, to, what = std::move(what)](double share, const std::string& detail) {
    progress(from + share * (to - from), detail.empty() ? what : what + ": " + detail);
  };
}

identification::Identified identify(const firmware::RigDescription& rig, std::vector<identification::Record> records,
                                    const TransferProgress& progress) {
  return identification::identify(
      rig, std::move(records),
      [&](double share, const std::string& what, std::size_t /*simulations*/, std::size_t /*candidates*/) {
        if (progress) progress(share, what);
      });
}

void check_second_rig(const firmware::RigDescription& to) {
  if (to.rig.kind == model::RigKind::quarter_car) return;
  throw firmware::InputError(to.source, to.line_of("kind"),
                             "kind is " + std::string(model::name(to.rig.kind)) + " for the second rig",
                             "quarter_car, on which the component drives over a road");
}

/// InputError where the posterior is so wide that the second rig with its draws is mostly no rig.
void require_draws(const Transfer& t, const identification::Identified& first) {
  const double finite =
      static_cast<double>(t.prediction.draws.size()) / static_cast<double>(thresholds::predictive_draws);
  if (finite >= thresholds::least_finite) return;
  throw firmware::InputError(first.problem.samples().front().recording.source, 0,
                             "it leaves the component open: only " + per_cent(finite) +
                                 " of the draws stay finite on the second rig, of whose motion it has shown " +
                                 per_cent(t.overlap.in_frequency) + " by frequency and " +
                                 per_cent(t.overlap.in_travel) + " by travel",
                             "recordings that move the component as the second rig does");
}

void check_first_rig(const firmware::RigDescription& from) {
  if (from.rig.kind != model::RigKind::driven_mass) return;
  throw firmware::InputError(from.source, from.line_of("driven_by"), "a mass that a force drives is the first rig",
                             "a rig whose component is moved");
}

void add_remarks(const std::vector<std::string>& more, const std::string& of, std::vector<std::string>& remarks) {
  for (const std::string& remark : more) remarks.push_back(of + remark);
}

}  // namespace

Transfer transfer_component(TransferInput input, const TransferProgress& progress) {
  check_first_rig(input.from);
  check_second_rig(input.to);
  Transfer t;
  t.remarks = check_same_component(input.from, input.to);
  const identification::Identified first =
      identify(input.from, std::move(input.first), step_of(progress, 0.0, 0.2, "first rig"));
  add_remarks(first.diagnosis.remarks, "first rig: ", t.remarks);
  t.component_verdict = identification::sentence(first.diagnosis);
  std::optional<identification::Identified> second;
  if (!input.second.empty()) {
    second = identify(input.to, std::move(input.second), step_of(progress, 0.2, 0.35, "second rig"));
    add_remarks(second->diagnosis.remarks, "second rig: ", t.remarks);
    t.second = on_recordings(input.to, *second);
  } else {
    t.second = on_road(input.to, input.road);
  }
  t.posterior = find_posterior(input.from, first, input.draws, input.seed, step_of(progress, 0.35, 0.75, "posterior"));
  if (progress) progress(0.75, "prediction");
  t.overlap =
      overlap_of(first, t.second, with_component(input.to.rig, input.from.rig, t.posterior.diagnosed().hypothesis));
  t.prediction = predict_second_rig(input.from, t.posterior, t.second, input.seed, thresholds::predictive_draws,
                                    thresholds::source_draws);
  require_draws(t, first);
  if (progress) progress(0.85, "next measurement");
  t.next = next_measurements(input.from, first, t.posterior, sensitivity_of(input.from, t.posterior, t.second),
                             t.prediction.budget[static_cast<std::size_t>(Quantity::rms_F_w)]);
  add_remarks(t.next.remarks, "", t.remarks);
  if (progress) progress(0.95, "validation");
  t.both = sort_effects(first, t.posterior);
  if (second) {
    compare_with_second(*second, t.posterior, t.both);
    t.validation = validate(t.prediction, t.second);
    if (!t.both.second_only.empty()) {
      SecondRig own = t.second;
      own.description = with_own_effects(input.to, second->diagnosis);
      t.with_own.emplace();
      t.with_own->prediction =
          predict_second_rig(input.from, t.posterior, own, input.seed, thresholds::source_draws * 2, 2);
      t.with_own->validation = validate(t.with_own->prediction, own);
    }
  }
  if (!t.both.stays.empty()) {
    t.naive_model = naive_model(input.from, first);
    t.naive.emplace();
    t.naive->prediction = predict_naively(input.from, *t.naive_model, t.second, thresholds::source_draws * 2);
    if (t.naive->prediction.draws.empty()) t.naive.reset();
    if (second && t.naive) t.naive->validation = validate(t.naive->prediction, t.second);
  }
  return t;
}

}  // namespace host_sim::transfer
