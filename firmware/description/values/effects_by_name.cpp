#include "firmware/description/values/effects_by_name.hpp"

#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "model/rig/rig_model.hpp"

namespace firmware {
namespace {

using model::Channel;
using Rig = model::RigParameters<double>;

template <class Slot>
using EffectOf = std::remove_cvref_t<decltype(std::declval<Slot>().effect)>;

template <class Effect>
Effect effect_with(std::span<const double> values) {
  Effect effect{};
  for (std::size_t i = 0; i < values.size(); ++i) effect.*Effect::values[i] = values[i];
  return effect;
}

template <class Effect>
double tyre_force_of(std::span<const double> values, double force, double deflection, double static_load) {
  return effect_with<Effect>(values).tyre_force(force, deflection, static_load);
}

template <class Effect>
concept Remembers = requires(const Effect& effect) {
  effect.force_after(0.0, 0.0);
};

template <class Effect>
CatalogueEntry entry_of(bool of_channel) {
  const auto& card = Effect::card;
  CatalogueEntry entry{.name = card.name,
                       .subsystem = card.subsystem,
                       .rigs = card.rigs,
                       .needs_fdva = card.needs_fdva,
                       .needs_air_spring = card.needs_air_spring,
                       .parameters = card.parameters,
                       .equation = card.equation,
                       .shows = card.shows,
                       .linearisation = card.linearisation,
                       .corner = card.corner,
                       .contains = card.contains,
                       .imitates = card.imitates,
                       .force = card.force,
                       .lateness = card.lateness,
                       .words = card.words,
                       .remembers = Remembers<Effect>,
                       .of_channel = of_channel,
                       .tyre_force = nullptr};
  if constexpr (model::TyreLaw<Effect>) entry.tyre_force = tyre_force_of<Effect>;
  return entry;
}

std::vector<CatalogueEntry> all_entries() {
  std::vector<CatalogueEntry> entries;
  const Rig rig;
  rig.effects.for_each([&](const auto& slot) { entries.push_back(entry_of<EffectOf<decltype(slot)>>(false)); });
  rig.effects.for_each_sensor([&](const auto& slot, Channel channel) {
    if (channel == model::channel_at(0)) entries.push_back(entry_of<EffectOf<decltype(slot)>>(true));
  });
  return entries;
}

/// visit(slot) of the effect of that name and channel.
template <class AnyRig, class Visitor>
void visit_slot(AnyRig& rig, std::string_view name, std::optional<Channel> channel, const Visitor& visit) {
  if (channel) {
    rig.effects.for_each_sensor([&](auto& slot, Channel of) {
      if (of == *channel && EffectOf<decltype(slot)>::card.name == name) visit(slot);
    });
  } else {
    rig.effects.for_each([&](auto& slot) {
      if (EffectOf<decltype(slot)>::card.name == name) visit(slot);
    });
  }
}

template <class Slot>
PlacedEffect placed(const Slot& slot, std::optional<Channel> channel) {
  using Effect = EffectOf<Slot>;
  PlacedEffect effect{find_effect(Effect::card.name), channel, {}};
  for (const auto& value : Effect::values) effect.values.push_back(slot.effect.*value);
  return effect;
}

}  // namespace

std::span<const CatalogueEntry> catalogue() {
  static const std::vector<CatalogueEntry> entries = all_entries();
  return entries;
}

const CatalogueEntry* find_effect(std::string_view name) {
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

std::vector<PlacedEffect> effects_of(const Rig& rig) {
  std::vector<PlacedEffect> effects;
  rig.effects.for_each([&](const auto& slot) {
    if (slot.active) effects.push_back(placed(slot, std::nullopt));
  });
  rig.effects.for_each_sensor([&](const auto& slot, Channel channel) {
    if (slot.active) effects.push_back(placed(slot, channel));
  });
  return effects;
}

std::string effect_path(const PlacedEffect& effect, std::size_t parameter) {
  std::string path = "effects." + std::string(effect.entry->name) + ".";
  if (effect.channel) path += std::string(model::name(*effect.channel)) + ".";
  return path + std::string(effect.entry->parameters[parameter].name);
}

void put_effect(Rig& rig, const PlacedEffect& effect) {
  visit_slot(rig, effect.entry->name, effect.channel, [&](auto& slot) {
    slot.active = true;
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      slot.effect.*EffectOf<decltype(slot)>::values[i] = effect.values[i];
    }
  });
}

void remove_effect(Rig& rig, const CatalogueEntry& entry, std::optional<Channel> channel) {
  visit_slot(rig, entry.name, channel, [](auto& slot) { slot = {}; });
}

bool has_place(const Rig& rig, const CatalogueEntry& entry, std::optional<Channel> channel) {
  if (!entry.rigs.contains(rig.kind) || (entry.needs_fdva && !rig.has_fdva)) return false;
  if (entry.needs_air_spring && !rig.air_spring.fitted) return false;
  if (entry.of_channel != channel.has_value()) return false;
  return !channel || model::has_sensor(rig.kind, *channel);
}

}  // namespace firmware
