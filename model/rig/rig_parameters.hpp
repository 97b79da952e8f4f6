// The parameters of a rig.
#pragma once

#include <type_traits>

#include "model/components/air_spring_parameters.hpp"
#include "model/components/channel.hpp"
#include "model/components/delay_variation.hpp"
#include "model/components/fdva.hpp"
#include "model/components/lever.hpp"
#include "model/effects/catalogue.hpp"
#include "model/laws/law_tables.hpp"

namespace model {

/// The physical part of a rig description: parameters, effects and laws.
template <class S, LawCapacity capacity = law_capacity<S>>
struct RigParameters {
  RigKind kind = RigKind::quarter_car;
  struct {
    S mass{};  ///< m_b [kg]
  } body;
  struct {
    S mass{};  ///< m_w [kg]
  } wheel;
  struct {
    S stiffness{};  ///< k_t [N/m]
    S damping{};    ///< b_t [N s/m]
  } tyre;
  struct {
    S stiffness{};  ///< k_b [N/m]
    S damping{};    ///< b_b [N s/m]
  } suspension;
  struct {
    S virtual_damping{};  ///< b̃ [N s/m], hil only
  } machine;
  bool has_fdva = false;
  typename Fdva<S>::Parameters fdva{};
  [[no_unique_address]] AirSpringParameters<S, capacity.extensions> air_spring{};
  [[no_unique_address]] LeverTable<S, capacity.extensions> lever{};
  [[no_unique_address]] DelayVariation<S, capacity.extensions> delay_variation{};
  Effects<S> effects;
  [[no_unique_address]] Laws<S, capacity> laws{};

  /// An air spring, a lever or a delay that varies.
  [[nodiscard]] constexpr bool has_extensions() const {
    return air_spring.fitted || lever.any() || delay_variation.any();
  }
};

/// A rig that has neither laws nor extensions, for a model without room for them.
template <class S, LawCapacity capacity>
[[nodiscard]] constexpr RigParameters<S, no_laws> without_laws(const RigParameters<S, capacity>& rig) {
  RigParameters<S, no_laws> bare;
  bare.kind = rig.kind;
  bare.body.mass = rig.body.mass;
  bare.wheel.mass = rig.wheel.mass;
  bare.tyre.stiffness = rig.tyre.stiffness;
  bare.tyre.damping = rig.tyre.damping;
  bare.suspension.stiffness = rig.suspension.stiffness;
  bare.suspension.damping = rig.suspension.damping;
  bare.machine.virtual_damping = rig.machine.virtual_damping;
  bare.has_fdva = rig.has_fdva;
  bare.fdva = rig.fdva;
  bare.effects = rig.effects;
  return bare;
}

/// visit(number) for every number of a rig but those of sensor effects, laws and extensions, of effects that are not
/// active, too.
template <class Rig, class Visit>
constexpr void for_each_number(Rig& rig, const Visit& visit) {
  visit(rig.body.mass);
  visit(rig.wheel.mass);
  visit(rig.tyre.stiffness);
  visit(rig.tyre.damping);
  visit(rig.suspension.stiffness);
  visit(rig.suspension.damping);
  visit(rig.machine.virtual_damping);
  visit(rig.fdva.piston_area);
  visit(rig.fdva.duct_diameter);
  visit(rig.fdva.duct_length);
  visit(rig.fdva.oil_density);
  visit(rig.fdva.oil_viscosity);
  visit(rig.fdva.minor_loss);
  visit(rig.fdva.coupling_stiffness);
  rig.effects.for_each([&visit](auto& slot) {
    for (const auto value : std::remove_cvref_t<decltype(slot.effect)>::values) visit(slot.effect.*value);
  });
}

}  // namespace model
