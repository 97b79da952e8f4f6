// The file of an FMU: a ZIP archive.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/fmu/model_description.hpp"

namespace host_sim::fmu {

/// A machine that an FMU can run on.
struct Binary {
  std::string platform;  ///< "linux64" (x86-64), "aarch64-linux", "win64": its folder beside the program
  std::filesystem::path file;
};

/// The libraries that were built: lib/rigtwin/fmu/PLATFORM/rigtwin.so (win64: rigtwin.dll) beside the folder of the
/// program, and, in a build tree, that of the neighbouring build for another machine (build/host beside build/aarch64
/// and build/win64).
[[nodiscard]] std::vector<Binary> built_binaries();

/// The presets that build the libraries which `binaries` lacks.
[[nodiscard]] std::vector<std::string> missing_presets(const std::vector<Binary>& binaries);

/// The folder of a binary under binaries/: that of FMI 2.0.4, section 2.3, or the tuple of FMI 3.0, section 2.5.1.4.
[[nodiscard]] std::string folder_in_fmu(const Binary& binary, Version version);

/// Writes the FMU: modelDescription.xml, binaries/, resources/. The same rig and libraries give the same bytes.
/// InputError without any library; OutputError.
void write_fmu(const std::filesystem::path& file, const firmware::RigDescription& rig,
               const std::vector<Binary>& binaries, Version version);

}  // namespace host_sim::fmu
