// Any bytes as a rig description: an InputError of one line, or a rig that the model and the firmware take.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void require_one_line(std::string_view line) {
  require(line.starts_with("RIG.toml:") && line.find(", expected ") != std::string_view::npos);
  require(line.find('\n') == std::string_view::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  firmware::RigDescription description;
  try {
    description = firmware::parse_rig(text, "RIG.toml");
  } catch (const firmware::InputError& error) {
    require_one_line(error.what());
    return 0;
  }
  require(description.sample_rate >= 1.0 && description.sample_rate <= 1e5);
  for (const auto& [path, tolerance] : description.tolerance) {
    require(tolerance >= 0.0 && firmware::find_parameter(description.rig, path) != nullptr);
  }
  // Three samples through the firmware: whatever a description says, it stops nothing of ours.
  try {
    const auto motion = firmware::excitation(description.rig, firmware::FootPointMotion(3), description.sample_rate);
    require(host_sim::run_closed_loop(description, motion, {}).recording.size() <= 3);
  } catch (const firmware::InputError& error) {
    require_one_line(error.what());
  }
  return 0;
}
