// An FMU as an importer meets it: a file, unpacked, its library loaded, its functions called.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/fmu/fmi2.hpp"
#include "tests/support/program.hpp"

namespace support {

/// An FMU that `rigtwin fmu` made, unpacked in a folder whose name an URI must escape.
class FmuFile {
 public:
  explicit FmuFile(const std::filesystem::path& rig, int version = 2) : version_(version) {
    const Ended ended = rigtwin({"fmu", "--rig", rig, "--out", folder_ / "rig.fmu", "--fmi", std::to_string(version)});
    if (ended.status != 0) throw std::runtime_error(ended.errors);
    unpack();
    xml_ = TemporaryFolder::read(root() / "modelDescription.xml");
    library_ = ::dlopen(library().c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    const std::regex variable("name=\"([^\"]*)\" valueReference=\"([0-9]+)\"");
    for (auto i = std::sregex_iterator(xml_.begin(), xml_.end(), variable); i != std::sregex_iterator(); ++i) {
      references_[(*i)[1]] = static_cast<unsigned>(std::stoul((*i)[2]));
    }
  }
  ~FmuFile() { ::dlclose(library_); }
  FmuFile(const FmuFile&) = delete;
  FmuFile& operator=(const FmuFile&) = delete;

  [[nodiscard]] std::filesystem::path root() const { return folder_ / "un packed"; }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "rig.fmu"; }
  [[nodiscard]] std::filesystem::path library() const {
    return root() / "binaries" / (version_ == 2 ? "linux64" : "x86_64-linux") / "rigtwin.so";
  }
  [[nodiscard]] std::string resources() const { return "file://" + folder_.path().string() + "/un%20packed/resources"; }
  [[nodiscard]] const std::string& xml() const { return xml_; }
  [[nodiscard]] std::string guid() const {
    const std::string name = version_ == 2 ? " guid=\"" : " instantiationToken=\"";
    const std::size_t at = xml_.find(name) + name.size();
    return xml_.substr(at, xml_.find('"', at) - at);
  }
  [[nodiscard]] unsigned reference(const std::string& name) const {
    const auto found = references_.find(name);
    if (found == references_.end()) throw std::runtime_error("no variable " + name);
    return found->second;
  }

  /// A function of the library, of the type that its declaration has.
  template <class Function>
  [[nodiscard]] Function* function(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }

 private:
  void unpack() const {
    zip_t* const archive = ::zip_open(file().c_str(), ZIP_RDONLY, nullptr);
    if (archive == nullptr) throw std::runtime_error("no ZIP archive");
    for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
      const std::filesystem::path out = root() / zip_get_name(archive, static_cast<zip_uint64_t>(i), 0);
      std::filesystem::create_directories(out.parent_path());
      zip_file_t* const entry = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
      std::ofstream stream(out, std::ios::binary);
      std::vector<char> bytes(65536);
      for (zip_int64_t got = 0; (got = zip_fread(entry, bytes.data(), bytes.size())) > 0;) {
        stream.write(bytes.data(), static_cast<std::streamsize>(got));
      }
      zip_fclose(entry);
    }
    zip_discard(archive);
  }

  int version_;
  TemporaryFolder folder_;
  std::string xml_;
  void* library_ = nullptr;
  std::map<std::string, unsigned> references_;
};

#define RIGTWIN_FMU_CALL(name) fmu_.function<decltype(::name)>(#name)

/// An instance in that FMU.
class FmuInstance {
 public:
  explicit FmuInstance(const FmuFile& fmu) : FmuInstance(fmu, fmu.guid()) {}
  FmuInstance(const FmuFile& fmu, const std::string& guid, fmi2Type type = fmi2CoSimulation) : fmu_(fmu) {
    const fmi2CallbackFunctions callbacks{&FmuInstance::log, nullptr, nullptr, nullptr, this};
    component_ =
        RIGTWIN_FMU_CALL(fmi2Instantiate)("one", type, guid.c_str(), fmu.resources().c_str(), &callbacks, 0, 0);
  }
  ~FmuInstance() { RIGTWIN_FMU_CALL(fmi2FreeInstance)(component_); }
  FmuInstance(const FmuInstance&) = delete;
  FmuInstance& operator=(const FmuInstance&) = delete;

  [[nodiscard]] fmi2Component component() const { return component_; }
  [[nodiscard]] const std::string& logged() const { return logged_; }
  [[nodiscard]] const std::string& unformatted() const { return unformatted_; }

  fmi2Status set_up(double start = 0.0) {
    return RIGTWIN_FMU_CALL(fmi2SetupExperiment)(component_, 0, 0.0, start, 0, 0.0);
  }
  fmi2Status enter() { return RIGTWIN_FMU_CALL(fmi2EnterInitializationMode)(component_); }
  fmi2Status exit() { return RIGTWIN_FMU_CALL(fmi2ExitInitializationMode)(component_); }
  fmi2Status terminate() { return RIGTWIN_FMU_CALL(fmi2Terminate)(component_); }
  fmi2Status reset() { return RIGTWIN_FMU_CALL(fmi2Reset)(component_); }
  fmi2Status step(double from, double size) { return RIGTWIN_FMU_CALL(fmi2DoStep)(component_, from, size, 1); }
  void begin(double start = 0.0) {
    EXPECT_EQ(set_up(start), fmi2OK);
    EXPECT_EQ(enter(), fmi2OK);
    EXPECT_EQ(exit(), fmi2OK) << logged_;
  }

  fmi2Status set(const std::string& name, double value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi2SetReal)(component_, &reference, 1, &value);
  }
  fmi2Status set(const std::string& name, int value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi2SetInteger)(component_, &reference, 1, &value);
  }
  fmi2Status set(const std::string& name, bool value) {
    const unsigned reference = fmu_.reference(name);
    const fmi2Boolean given = value ? 1 : 0;
    return RIGTWIN_FMU_CALL(fmi2SetBoolean)(component_, &reference, 1, &given);
  }
  fmi2Status set(const std::string& name, const char* value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi2SetString)(component_, &reference, 1, &value);
  }
  fmi2Status get(const std::string& name, double& value) {
    const unsigned reference = fmu_.reference(name);
    return RIGTWIN_FMU_CALL(fmi2GetReal)(component_, &reference, 1, &value);
  }
  [[nodiscard]] double real(const std::string& name) {
    double value = 0.0;
    EXPECT_EQ(get(name, value), fmi2OK) << name << ": " << logged_;
    return value;
  }
  [[nodiscard]] int integer(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    int value = -1;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2GetInteger)(component_, &reference, 1, &value), fmi2OK);
    return value;
  }
  [[nodiscard]] bool boolean(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    int value = -1;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2GetBoolean)(component_, &reference, 1, &value), fmi2OK);
    return value != 0;
  }
  [[nodiscard]] std::string text(const std::string& name) {
    const unsigned reference = fmu_.reference(name);
    fmi2String value = nullptr;
    EXPECT_EQ(RIGTWIN_FMU_CALL(fmi2GetString)(component_, &reference, 1, &value), fmi2OK);
    return value == nullptr ? "" : value;
  }

 private:
  /// The text as an importer shows it that formats, and as one does that does not.
  static void log(fmi2ComponentEnvironment self, fmi2String, fmi2Status, fmi2String, fmi2String message, ...) {
    std::va_list arguments;
    va_start(arguments, message);
    char text[1024];
    std::vsnprintf(text, sizeof text, message, arguments);
    va_end(arguments);
    static_cast<FmuInstance*>(self)->logged_ = text;
    static_cast<FmuInstance*>(self)->unformatted_ = message;
  }

  const FmuFile& fmu_;
  fmi2Component component_ = nullptr;
  std::string logged_, unformatted_;
};

}  // namespace support
