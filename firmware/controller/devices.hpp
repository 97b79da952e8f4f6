// Who plays the roles of the rig.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "firmware/controller/options.hpp"
#include "firmware/description/rig_description.hpp"
#include "hal/rig.hpp"

namespace firmware::controller {

/// The back-end that was chosen, opened.
class Devices {
 public:
  Devices() = default;
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;
  virtual ~Devices() = default;

  [[nodiscard]] virtual hal::Rig roles() = 0;
  /// Lines on what a user should know, once the run has lasted; empty: nothing.
  [[nodiscard]] virtual std::string warnings() const { return {}; }
  /// Of a recording that is replayed; 0: devices.
  [[nodiscard]] virtual std::size_t rows() const { return 0; }
  /// The contacts of the stop button, and when each one opened last; empty: it has none.
  struct StopContact {
    std::string line;
    hal::Time opened = hal::never;
  };
  [[nodiscard]] virtual std::vector<StopContact> stop_contacts() const { return {}; }
  /// What was opened, a line each.
  [[nodiscard]] virtual std::string text() const = 0;
};

/// Opens them: the valves stand in the safe position from here on. Nothing in case of trouble, which is then one line.
[[nodiscard]] std::unique_ptr<Devices> open_devices(const RigDescription& rig, const Options& options,
                                                    std::string& trouble);

}  // namespace firmware::controller
