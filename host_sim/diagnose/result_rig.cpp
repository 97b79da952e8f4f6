#include "host_sim/diagnose/result_rig.hpp"

#include "host_sim/input_error.hpp"
#include "host_sim/rig_writer.hpp"

namespace host_sim::diagnose {

std::string result_rig(const RigDescription& found, std::string_view given) {
  return std::string(result_rig_mark) + ": " + one_line(given) + " with what was found\n" + format_rig(found);
}

}  // namespace host_sim::diagnose
