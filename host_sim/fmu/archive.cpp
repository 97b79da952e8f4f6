#include "host_sim/fmu/archive.hpp"

#include <zip.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <system_error>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/fmu/variables.hpp"

namespace host_sim::fmu {
namespace {

struct Machine {
  std::string_view platform;  ///< folder of FMI 2.0
  std::string_view tuple;     ///< folder of FMI 3.0
  std::string_view preset;    ///< that builds its library
  std::string_view ending;    ///< of its library
};
constexpr std::array machines{
    Machine{"linux64", "x86_64-linux", "host", ".so"},
    Machine{"aarch64-linux", "aarch64-linux", "aarch64", ".so"},
    Machine{"win64", "x86_64-windows", "win64", ".dll"},
};

/// An archive in memory, by libzip: OutputFile then writes it, complete or not at all.
class Archive {
 public:
  explicit Archive(const std::filesystem::path& file) : file_(file) {
    zip_error_init(&error_);
    source_ = zip_source_buffer_create(nullptr, 0, 0, &error_);
    if (source_ == nullptr) fail();
    zip_source_keep(source_);  // read after the archive is closed
    archive_ = zip_open_from_source(source_, ZIP_TRUNCATE, &error_);
    if (archive_ == nullptr) fail();
  }
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
    if (source_ != nullptr) zip_source_free(source_);
    zip_error_fini(&error_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// `bytes` must live until finish().
  void add(const std::string& name, std::string_view bytes) {
    zip_source_t* const source = zip_source_buffer(archive_, bytes.data(), bytes.size(), 0);
    if (source == nullptr) fail();
    const zip_int64_t index = zip_file_add(archive_, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      fail();
    }
    zip_set_file_compression(archive_, static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE,
                             6);                    // zlib's usual level
    constexpr zip_uint16_t date = (1U << 5U) | 1U;  // 1 January 1980: no time, the same bytes every time
    zip_file_set_dostime(archive_, static_cast<zip_uint64_t>(index), 0, date, 0);
  }

  [[nodiscard]] std::string finish() {
    if (zip_close(archive_) != 0) fail();
    archive_ = nullptr;
    if (zip_source_open(source_) != 0) fail();
    std::string bytes;
    std::array<char, 65536> part{};
    for (zip_int64_t got = 0; (got = zip_source_read(source_, part.data(), part.size())) > 0;) {
      bytes.append(part.data(), static_cast<std::size_t>(got));
    }
    zip_source_close(source_);
    return bytes;
  }

 private:
  [[noreturn]] void fail() {
    throw firmware::OutputError(file_.string(), "no ZIP archive could be made", "memory for it");
  }

  std::filesystem::path file_;
  zip_error_t error_{};
  zip_source_t* source_ = nullptr;
  zip_t* archive_ = nullptr;
};

std::string read_binary(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw firmware::InputError(file.string(), 0, "cannot be read", "the library of an FMU");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

std::vector<Binary> built_binaries() {
  std::error_code unknown;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path prefix = program.parent_path().parent_path();
  const std::filesystem::path library = std::filesystem::path("lib") / "rigtwin" / "fmu";
  std::vector<Binary> found;
  for (const Machine& machine : machines) {
    for (const std::filesystem::path& root : {prefix, prefix.parent_path() / machine.preset}) {
      const std::filesystem::path file =
          root / library / machine.platform / (std::string(model_identifier) + std::string(machine.ending));
      if (!std::filesystem::exists(file, unknown)) continue;
      found.push_back({std::string(machine.platform), file});
      break;
    }
  }
  return found;
}

std::vector<std::string> missing_presets(const std::vector<Binary>& binaries) {
  std::vector<std::string> missing;
  for (const Machine& machine : machines) {
    if (std::ranges::find(binaries, machine.platform, &Binary::platform) == binaries.end()) {
      missing.emplace_back(machine.preset);
    }
  }
  return missing;
}

std::string folder_in_fmu(const Binary& binary, Version version) {
  const auto* const machine = std::ranges::find(machines, binary.platform, &Machine::platform);
  return version == Version::fmi3 && machine != machines.end() ? std::string(machine->tuple) : binary.platform;
}

void write_fmu(const std::filesystem::path& file, const firmware::RigDescription& rig,
               const std::vector<Binary>& binaries, Version version) {
  if (binaries.empty()) {
    throw firmware::InputError("lib/rigtwin/fmu", 0, "holds no library for an FMU",
                               "the target rigtwin_fmu built, or the package rigtwin");
  }
  const std::string description = description_in_fmu(rig);
  const std::string xml = model_description(rig, file.stem().string(), firmware::sha256(description), version);
  std::vector<std::string> libraries;
  for (const Binary& binary : binaries) libraries.push_back(read_binary(binary.file));

  Archive archive(file);
  archive.add("modelDescription.xml", xml);
  for (std::size_t i = 0; i < binaries.size(); ++i) {
    archive.add("binaries/" + folder_in_fmu(binaries[i], version) + "/" + binaries[i].file.filename().string(),
                libraries[i]);
  }
  archive.add(std::string("resources/") + description_resource, description);
  firmware::write_file(file, archive.finish());
}

}  // namespace host_sim::fmu
