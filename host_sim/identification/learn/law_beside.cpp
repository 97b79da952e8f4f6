#include "host_sim/identification/learn/law_beside.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host_sim/identification/select/select_model.hpp"

namespace host_sim::identification {
namespace {

bool are_same(const EffectsBeside& a, const EffectsBeside& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.entry == y.entry && x.channel == y.channel; });
}

/// Whether an effect is itself a curve over that variable, at the suspension or the tyre.
bool is_curve(const firmware::PlacedEffect& effect, CurveOver over) {
  return effect.entry->force.over == variable_of(over);
}

bool is_power_of_suspension(const firmware::PlacedEffect& effect, CurveOver over, double exponent) {
  return !effect.channel && effect.entry->subsystem == model::Subsystem::suspension &&
         effect.entry->force.is_power(variable_of(over), exponent);
}

bool relaxes(const firmware::PlacedEffect& effect) { return effect.entry->force.form == model::Form::relaxing; }

constexpr double probe = 12345.0;

/// The effect with one number that makes `value_in` of a rig that number.
template <class Value>
const firmware::CatalogueEntry* effect_that_sets(std::optional<model::Channel> channel, const Value& value_in) {
  return firmware::find_effect_that([&](const firmware::CatalogueEntry& entry) {
    if (entry.of_channel != channel.has_value() || entry.parameters.size() != 1) return false;
    model::RigParameters<double> rig{};
    firmware::put_effect(rig, {&entry, channel, {probe}});
    return value_in(rig) == probe;
  });
}

double mount_of(const model::RigParameters<double>& rig) {
  model::SuspensionComponent<double> part{};
  rig.effects.act_on(part);
  return part.mount_stiffness;
}

double offset_of_force(const model::RigParameters<double>& rig) {
  return rig.effects.sensor_paths()[index(model::Channel::F)].offset;
}

}  // namespace

EffectsBeside effects_of(const LawBehindMount& law, const IdentificationProblem& problem,
                         const model::RigParameters<double>& rig) {
  const firmware::CatalogueEntry* const mount = effect_that_sets(std::nullopt, mount_of);
  const bool described = mount_of(rig) != 0.0;
  if (mount == nullptr || described || !firmware::has_place(rig, *mount, std::nullopt)) return {};
  EffectsBeside effects{{mount, std::nullopt, {law.stiffness}}};
  const firmware::CatalogueEntry* const offset = effect_that_sets(model::Channel::F, offset_of_force);
  const bool tared = problem.samples().front().has_unknown_mean(model::Channel::F);
  const bool has_offset = offset_of_force(rig) != 0.0;
  if (offset != nullptr && !tared && !has_offset && firmware::has_place(rig, *offset, model::Channel::F)) {
    effects.push_back({offset, model::Channel::F, {law.offset}});
  }
  return effects;
}

model::Over variable_of(CurveOver over) {
  return over == CurveOver::velocity ? model::Over::velocity : model::Over::deflection;
}

model::Subsystem subsystem_of(CurvePlace place) {
  switch (place) {
    case CurvePlace::tyre:
      return model::Subsystem::tyre;
    case CurvePlace::body_guide:
      return model::Subsystem::body_guide;
    case CurvePlace::wheel_guide:
      return model::Subsystem::wheel_guide;
    default:
      return model::Subsystem::suspension;
  }
}

bool is_friction(const firmware::PlacedEffect& effect) {
  return is_power_of_suspension(effect, CurveOver::velocity, 0.0);
}
bool is_guide(CurvePlace place) { return place == CurvePlace::body_guide || place == CurvePlace::wheel_guide; }

bool may_act_beside(const firmware::PlacedEffect& effect, CurvePlace place, CurveOver over) {
  return effect.channel || effect.entry->subsystem != subsystem_of(place) ||
         (!is_guide(place) && !is_curve(effect, over));
}

std::vector<EffectsBeside> effects_beside(const EffectsBeside& all, CurvePlace place, CurveOver over) {
  const model::Subsystem own = subsystem_of(place);
  const auto those = [&](const auto& keep) {
    EffectsBeside kept;
    std::copy_if(all.begin(), all.end(), std::back_inserter(kept), keep);
    return kept;
  };
  const auto elsewhere = [](const firmware::PlacedEffect& e) {
    return e.channel.has_value() || e.entry->subsystem == model::Subsystem::machine;
  };
  std::vector<EffectsBeside> list{
      {}, those(elsewhere), those([&](const auto& e) { return elsewhere(e) || e.entry->subsystem != own; })};
  if (over == CurveOver::velocity) {
    list.push_back(those(is_friction));
    list.push_back(those([&](const auto& e) { return elsewhere(e) || is_friction(e); }));
    list.push_back(those([&](const auto& e) { return elsewhere(e) || e.entry->subsystem != own || is_friction(e); }));
  }
  // Last, of those at the place, laws of another kind: a curve over velocity beside free play, a spring, a branch.
  list.push_back(those([&](const auto& e) { return may_act_beside(e, place, over); }));
  std::vector<EffectsBeside> different;
  for (auto effects = list.rbegin(); effects != list.rend(); ++effects) {
    if (std::none_of(different.begin(), different.end(), [&](const EffectsBeside& d) { return are_same(d, *effects); }))
      different.push_back(std::move(*effects));
  }
  std::reverse(different.begin(), different.end());
  return different;
}

std::vector<EffectsBeside> effects_beside_stack(const EffectsBeside& all) {
  std::vector<EffectsBeside> different;
  const auto add = [&](const auto& keep) {
    EffectsBeside kept;
    std::copy_if(all.begin(), all.end(), std::back_inserter(kept), keep);
    if (std::none_of(different.begin(), different.end(), [&](const EffectsBeside& d) { return are_same(d, kept); }))
      different.push_back(std::move(kept));
  };
  const auto remembers = [&](const firmware::PlacedEffect& e) {
    return e.entry->remembers || relaxes(e) || is_friction(e) || e.entry->force.form == model::Form::falling;
  };
  add([&](const auto& e) { return !remembers(e); });
  add([&](const auto& e) { return !remembers(e) || is_friction(e); });
  add([](const auto& e) { return e.channel || e.entry->subsystem != model::Subsystem::suspension; });
  return different;
}

EffectsBeside effects_beside_guide(const EffectsBeside& all, CurvePlace place) {
  EffectsBeside kept;
  std::copy_if(all.begin(), all.end(), std::back_inserter(kept),
               [&](const auto& e) { return may_act_beside(e, place, CurveOver::velocity); });
  return kept;
}

Reasons reasons_for(const IdentificationProblem& problem, const SearchResult& found) {
  const auto& effects = found.best.effects;
  const auto holds = [&](const auto& keep) { return std::any_of(effects.begin(), effects.end(), keep); };
  const auto power = [](CurveOver variable, double exponent) {
    return [=](const auto& e) { return is_power_of_suspension(e, variable, exponent); };
  };
  const auto several = [&](const auto& keep) {
    return std::count_if(effects.begin(), effects.end(), [&](const auto& e) {
             return e.entry->subsystem == model::Subsystem::suspension && keep(e);
           }) > 1;
  };
  const auto over = [](CurveOver variable) { return [variable](const auto& e) { return is_curve(e, variable); }; };
  return {leaves_a_rest(problem, found), several(over(CurveOver::velocity)) || holds(power(CurveOver::velocity, 2.0)),
          several(over(CurveOver::deflection)) || holds(power(CurveOver::deflection, 3.0)),
          holds(relaxes) && several([](const auto& /*e*/) { return true; })};
}

}  // namespace host_sim::identification
