// The parameters of a rig.
#pragma once

#include "model/channel.hpp"
#include "model/effects/catalogue.hpp"
#include "model/fdva.hpp"

namespace model {

/// The physical part of a rig description: parameters and effects.
template <class S>
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
  Effects<S> effects;
};

}  // namespace model
