// Walks the state machine of an unpacked FMU, on Linux and on Windows, and compares its outputs with the rows of
// `rigtwin simulate`, bit for bit.
//
//   rigtwin_fmu_walk FOLDER LIBRARY RUN.csv 2|3       LIBRARY: below FOLDER/binaries; status 1: something differs
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/fmu/fmi2.hpp"
#include "host_sim/fmu/fmi3.hpp"
#include "tests/host_sim/fmu/function_names.hpp"

#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }
void demand(bool right, const std::string& what) {
  if (!right) fail(what);
}

std::string logged;  ///< the FMU's last message

class Library {
 public:
#ifdef _WIN32
  explicit Library(const fs::path& file) : handle_(::LoadLibraryW(file.c_str())) {
    demand(handle_ != nullptr, file.string() + " cannot be loaded: error " + std::to_string(::GetLastError()));
  }
  ~Library() { ::FreeLibrary(handle_); }
  [[nodiscard]] void* find(const char* name) const { return reinterpret_cast<void*>(::GetProcAddress(handle_, name)); }
#else
  explicit Library(const fs::path& file) : handle_(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (handle_ == nullptr) fail(::dlerror());
  }
  ~Library() { ::dlclose(handle_); }
  [[nodiscard]] void* find(const char* name) const { return ::dlsym(handle_, name); }
#endif
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  template <class Function>
  [[nodiscard]] Function* function(const char* name) const {
    void* const found = find(name);
    if (found == nullptr) fail(std::string("no function ") + name);
    return reinterpret_cast<Function*>(found);
  }

 private:
#ifdef _WIN32
  HMODULE handle_;
#else
  void* handle_;
#endif
};

#define RIGTWIN_CALL(name) library_.function<decltype(::name)>(#name)

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  demand(stream.good(), file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string attribute(const std::string& xml, const std::string& name, std::size_t from = 0) {
  const std::string begin = " " + name + "=\"";
  const std::size_t at = xml.find(begin, from);
  demand(at != std::string::npos, "modelDescription.xml has no " + name);
  const std::size_t value = at + begin.size();
  return xml.substr(value, xml.find('"', value) - value);
}

unsigned reference_of(const std::string& xml, const std::string& variable) {
  const std::size_t at = xml.find(" name=\"" + variable + "\"");
  demand(at != std::string::npos, "no variable " + variable);
  return static_cast<unsigned>(std::stoul(attribute(xml, "valueReference", at)));
}

/// The same calls in both versions; true: the FMU says OK.
class Fmu2 {
 public:
  Fmu2(const Library& library, const fs::path& resources, const std::string& guid) : library_(library) {
    const std::string path = resources.generic_string();
    std::string uri = path.front() == '/' ? "file://" : "file:///";
    for (const char c : path) uri += c == ' ' ? std::string("%20") : std::string(1, c);
    const fmi2CallbackFunctions callbacks{&log, nullptr, nullptr, nullptr, nullptr};
    demand(RIGTWIN_CALL(fmi2GetVersion)() == std::string("2.0"), "another version");
    handle_ = RIGTWIN_CALL(fmi2Instantiate)("walk", fmi2CoSimulation, guid.c_str(), uri.c_str(), &callbacks, 0, 0);
    demand(handle_ != nullptr, "no instance: " + logged);
  }
  ~Fmu2() { RIGTWIN_CALL(fmi2FreeInstance)(handle_); }
  Fmu2(const Fmu2&) = delete;
  Fmu2& operator=(const Fmu2&) = delete;

  bool enter() {
    return RIGTWIN_CALL(fmi2SetupExperiment)(handle_, 0, 0.0, 0.0, 0, 0.0) == fmi2OK &&
           RIGTWIN_CALL(fmi2EnterInitializationMode)(handle_) == fmi2OK;
  }
  bool exit() { return RIGTWIN_CALL(fmi2ExitInitializationMode)(handle_) == fmi2OK; }
  bool step(double from, double size) { return RIGTWIN_CALL(fmi2DoStep)(handle_, from, size, 1) == fmi2OK; }
  bool get(const std::vector<unsigned>& references, std::vector<double>& values) {
    return RIGTWIN_CALL(fmi2GetReal)(handle_, references.data(), references.size(), values.data()) == fmi2OK;
  }
  bool terminate() { return RIGTWIN_CALL(fmi2Terminate)(handle_) == fmi2OK; }
  bool reset() { return RIGTWIN_CALL(fmi2Reset)(handle_) == fmi2OK; }

 private:
  static void log(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String message, ...) {
    logged = message;
  }
  const Library& library_;
  fmi2Component handle_ = nullptr;
};

class Fmu3 {
 public:
  Fmu3(const Library& library, const fs::path& resources, const std::string& token) : library_(library) {
    const std::string path = resources.string() + "/";
    demand(RIGTWIN_CALL(fmi3GetVersion)() == std::string("3.0"), "another version");
    handle_ = RIGTWIN_CALL(fmi3InstantiateCoSimulation)("walk", token.c_str(), path.c_str(), false, false, false, false,
                                                        nullptr, 0, nullptr, &log, nullptr);
    demand(handle_ != nullptr, "no instance: " + logged);
  }
  ~Fmu3() { RIGTWIN_CALL(fmi3FreeInstance)(handle_); }
  Fmu3(const Fmu3&) = delete;
  Fmu3& operator=(const Fmu3&) = delete;

  bool enter() { return RIGTWIN_CALL(fmi3EnterInitializationMode)(handle_, false, 0.0, 0.0, false, 0.0) == fmi3OK; }
  bool exit() { return RIGTWIN_CALL(fmi3ExitInitializationMode)(handle_) == fmi3OK; }
  bool step(double from, double size) {
    bool events = true, ended = true, early = true;
    double last = 0.0;
    return RIGTWIN_CALL(fmi3DoStep)(handle_, from, size, true, &events, &ended, &early, &last) == fmi3OK && !events &&
           !ended && !early;
  }
  bool get(const std::vector<unsigned>& references, std::vector<double>& values) {
    return RIGTWIN_CALL(fmi3GetFloat64)(handle_, references.data(), references.size(), values.data(), values.size()) ==
           fmi3OK;
  }
  bool terminate() { return RIGTWIN_CALL(fmi3Terminate)(handle_) == fmi3OK; }
  bool reset() { return RIGTWIN_CALL(fmi3Reset)(handle_) == fmi3OK; }

 private:
  static void log(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String message) { logged = message; }
  const Library& library_;
  fmi3Instance handle_ = nullptr;
};

/// A recording of `rigtwin simulate`.
struct Run {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
};

Run read_run(const fs::path& file) {
  std::istringstream text(read(file));
  Run run;
  std::string line;
  while (std::getline(text, line)) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (run.names.empty()) {
      for (const std::string& cell : cells) run.names.push_back(cell.substr(0, cell.find(' ')));
      continue;
    }
    demand(cells.size() == run.names.size(), "a row of another length in " + file.string());
    std::vector<double> row(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), row[i]);
    }
    run.rows.push_back(row);
  }
  demand(!run.rows.empty(), file.string() + " has no rows");
  return run;
}

template <class Fmu>
void walk(Fmu& fmu, const Run& run, const std::string& xml) {
  std::vector<unsigned> references;
  for (std::size_t i = 1; i < run.names.size(); ++i) references.push_back(reference_of(xml, run.names[i]));
  std::vector<double> values(references.size());

  demand(!fmu.step(0.0, 0.001), "a step before initialisation is taken");
  demand(logged == "a step is not allowed before initialisation", "the log says: " + logged);
  demand(!fmu.exit(), "initialisation mode is left before it is entered");
  demand(fmu.enter(), logged);
  demand(!fmu.step(0.0, 0.001), "a step in initialisation mode is taken");
  demand(fmu.exit(), logged);
  for (std::size_t k = 0; k < run.rows.size(); ++k) {
    demand(fmu.get(references, values), logged);
    for (std::size_t i = 0; i < values.size(); ++i) {
      // In its last row the run of simulate has ended: its valves are safe already.
      if (k + 1 == run.rows.size() && run.names[i + 1].starts_with("duct_")) continue;
      if (values[i] == run.rows[k][i + 1]) continue;
      std::array<char, 128> text{};
      std::snprintf(text.data(), text.size(), "%a, expected %a", values[i], run.rows[k][i + 1]);
      fail(run.names[i + 1] + " of row " + std::to_string(k) + " is " + text.data());
    }
    demand(fmu.step(static_cast<double>(k) * 0.001, 0.001), logged);
  }
  demand(fmu.terminate(), logged);
  demand(!fmu.step(static_cast<double>(run.rows.size()) * 0.001, 0.001), "a step after termination is taken");
  demand(fmu.reset(), logged);
  demand(fmu.enter() && fmu.exit() && fmu.get(references, values), logged);
  demand(values[0] == run.rows[0][1], "after a reset the run begins elsewhere");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) {
    std::fputs("rigtwin_fmu_walk FOLDER LIBRARY RUN.csv 2|3\n", stderr);
    return 2;
  }
  try {
    const fs::path folder = fs::absolute(arguments[1]).lexically_normal();
    const bool three = arguments[4] == std::string("3");
    const std::string xml = read(folder / "modelDescription.xml");
    const Run run = read_run(arguments[3]);
    const Library library(folder / "binaries" / arguments[2]);
    for (const char* name : support::fmi2_functions) demand(library.find(name) != nullptr, name);
    for (const char* name : support::fmi3_functions) demand(library.find(name) != nullptr, name);
    if (three) {
      Fmu3 fmu(library, folder / "resources", attribute(xml, "instantiationToken"));
      walk(fmu, run, xml);
    } else {
      Fmu2 fmu(library, folder / "resources", attribute(xml, "guid"));
      walk(fmu, run, xml);
    }
    std::printf("%s, FMI %s: %zu rows of %zu outputs, bit for bit\n", arguments[2], arguments[4], run.rows.size(),
                run.names.size() - 1);
  } catch (const std::exception& error) {
    std::printf("%s, FMI %s: %s\n", arguments[2], arguments[4], error.what());
    return 1;
  }
  return 0;
}
