#include "tests/calibration/calibration.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/plan/plan.hpp"
#include "tests/support/part_of.hpp"
#include "tests/truth/truth.hpp"

namespace calibration {
namespace {

constexpr double unseen = 1.5;  ///< [standard deviations]

/// The road or command of a truth, as its recorder would see it without noise.
firmware::FootPointMotion motion_of(const truth::Truth& truth) {
  truth::Fineness silent;
  silent.noise = false;
  const truth::Record record = truth::simulate(truth, silent).front();
  const auto& column = record.channels.at(truth.kind == truth::Kind::component_bench ? "x_cmd" : "z_r");
  return firmware::through_samples(column, truth.sample_rate);
}

truth::Effect hidden(const host_sim::plan::PlannedEffect& effect, double value) {
  truth::Effect hidden{std::string(effect.subject.entry->name), {}, {}};
  if (effect.subject.channel) hidden.channel = std::string(model::name(*effect.subject.channel));
  for (std::size_t p = 0; p < effect.subject.values.size(); ++p) {
    hidden.parameters[std::string(effect.subject.entry->parameters[p].name)] =
        p == effect.parameter ? value : effect.subject.values[p];
  }
  return hidden;
}

void diagnose(truth::Truth truth, const host_sim::plan::PlannedEffect& effect, Case& one) {
  namespace id = host_sim::identification;
  truth.effects = {hidden(effect, one.value)};
  const firmware::RigDescription description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  std::vector<id::Record> records;
  records.push_back(
      {firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv"), id::Use::shared});
  const id::Diagnosis diagnosis = id::diagnose(description, std::move(records));
  for (const id::NamedEffect& named : diagnosis.effects) {
    const std::string name = id::words(named.effect);
    char text[160];
    std::snprintf(text, sizeof text, "%s%s %.3f", one.found.empty() ? "" : ", ", name.c_str(), named.confidence);
    one.found += text;
    if (name != one.effect) continue;
    one.named = true;
    one.believed = named.confidence > 0.5;
  }
}

}  // namespace

std::vector<Case> calibrate(const Asked& asked) {
  truth::Wanted wanted;
  wanted.duration = asked.duration;
  truth::Truth truth = truth::draw("none:" + asked.kind, asked.seed, wanted);
  truth.records.resize(1);
  const firmware::RigDescription description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  host_sim::plan::Setting setting;
  setting.motion = motion_of(truth);
  const host_sim::plan::Rehearsal rehearsal(description, setting);
  const host_sim::plan::Plan plan = host_sim::plan::make_plan(description, setting);

  std::vector<Case> cases;
  std::vector<const host_sim::plan::PlannedEffect*> effects;
  for (const host_sim::plan::PlannedEffect& effect : plan.effects) {
    if (!effect.named_at || effect.subject.seen_by_itself) continue;
    const std::string name = host_sim::plan::words(effect.subject);
    if (!support::is_in_part(name, asked.part - 1, asked.parts)) continue;
    cases.push_back({name, *effect.named_at, true});
    effects.push_back(&effect);
    host_sim::plan::SizeSearch search(rehearsal, effect.subject, effect.parameter);
    const auto small = search.with(unseen);
    if (!small || small->significance > 2.0) continue;
    cases.push_back({cases.back().effect, small->value, false});
    effects.push_back(&effect);
  }
  host_sim::identification::for_all(cases.size(), [&](std::size_t i) {
    try {
      diagnose(truth, *effects[i], cases[i]);
    } catch (const std::exception& error) {  // steps of the generator are too long for a stiff effect
      cases[i].failure = error.what();
    }
  });
  return cases;
}

}  // namespace calibration
