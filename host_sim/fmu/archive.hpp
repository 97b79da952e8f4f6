// The file of an FMU: a ZIP archive.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"

namespace host_sim::fmu {

/// A machine that an FMU can run on: its folder under binaries/, by FMI 2.0.4, section 2.3.
struct Binary {
  std::string platform;  ///< "linux64" (x86-64), "aarch64-linux"
  std::filesystem::path file;
};

/// The libraries that were built: lib/rigtwin/fmu/PLATFORM/rigtwin.so beside the folder of the program, and, in a build
/// tree, that of the neighbouring build for another machine (build/host beside build/aarch64).
[[nodiscard]] std::vector<Binary> built_binaries();

/// Writes the FMU: modelDescription.xml, binaries/, resources/. The same rig and libraries give the same bytes.
/// InputError without any library; OutputError.
void write_fmu(const std::filesystem::path& file, const firmware::RigDescription& rig,
               const std::vector<Binary>& binaries);

}  // namespace host_sim::fmu
