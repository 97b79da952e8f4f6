// The part of a rig that travels: the component between wheel and body.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/identification/estimate/free_parameter.hpp"

namespace host_sim::transfer {

/// Whether a parameter belongs to the component: suspension.*, fdva.*, the parameters of effects of suspension and
/// FDVA, the values of laws at the suspension. Everything else – delay, lag, virtual damping, sensors, moving mass,
/// guides, body, wheel, tyre, start states, faults of the recording – stays behind.
[[nodiscard]] bool travels(std::string_view path);
[[nodiscard]] bool travels(const firmware::CatalogueEntry& effect);
[[nodiscard]] bool travels(const identification::FreeParameter& parameter, const identification::Hypothesis& learned);

/// Checks that two descriptions describe one component. InputError that names the parameter, law or effect where they
/// differ. The second rig may have a damper of its own beside the component (a suspension.damping that is larger): a
/// hil rig computes it as machine.virtual_damping. Another number of open ducts is another setting of the same
/// component. Returns remarks on both.
[[nodiscard]] std::vector<std::string> check_same_component(const firmware::RigDescription& from,
                                                            const firmware::RigDescription& to);

/// The second rig with the component of a hypothesis of the first one:
///
///   (1)  p_to = p_learned                        stiffnesses, FDVA, effects, laws
///   (2)  b_to = b_to,described + b_learned − b_from,described      damping: the second rig's own damper stays
[[nodiscard]] model::RigParameters<double> with_component(const model::RigParameters<double>& to,
                                                          const model::RigParameters<double>& from,
                                                          const identification::Hypothesis& learned);

}  // namespace host_sim::transfer
