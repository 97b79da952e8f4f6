// The library inside an FMU: the functions of FMI 2.0 for co-simulation, each a call of Slave.
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "host_sim/fmu/fmi2.hpp"
#include "host_sim/fmu/slave.hpp"

namespace {

using host_sim::fmu::CallError;
using host_sim::fmu::Slave;

/// What fmi2Component points to.
struct Instance {
  std::string name;
  fmi2CallbackFunctions callbacks{};
  std::unique_ptr<Slave> slave{};
  std::vector<std::string> shown{};  ///< what fmi2GetString gave, until the next call
};

void log(const Instance& instance, fmi2Status status, const std::string& text) {
  if (instance.callbacks.logger == nullptr) return;
  instance.callbacks.logger(instance.callbacks.componentEnvironment, instance.name.c_str(), status, "logStatusError",
                            "%s", text.c_str());
}

/// Carries out a call on an instance: fmi2Error and a line in the log if it fails. Nothing is thrown through C.
template <class Call>
fmi2Status carry_out(fmi2Component component, const Call& call) {
  if (component == nullptr) return fmi2Error;
  Instance& instance = *static_cast<Instance*>(component);
  try {
    call(instance);
    return fmi2OK;
  } catch (const std::exception& error) {
    log(instance, fmi2Error, error.what());
    return fmi2Error;
  }
}

void demand_pointers(std::size_t count, const void* references, const void* values) {
  if (count > 0 && (references == nullptr || values == nullptr)) throw CallError("a null pointer, expected an array");
}

template <class T, class Out>
fmi2Status get(fmi2Component component, const fmi2ValueReference references[], std::size_t count, Out values[]) {
  return carry_out(component, [&](Instance& instance) {
    demand_pointers(count, references, values);
    for (std::size_t i = 0; i < count; ++i) values[i] = instance.slave->get<T>(references[i]);
  });
}

template <class T, class In>
fmi2Status set(fmi2Component component, const fmi2ValueReference references[], std::size_t count, const In values[]) {
  return carry_out(component, [&](Instance& instance) {
    demand_pointers(count, references, values);
    std::vector<T> taken;
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (std::is_same_v<T, std::string>) {
        if (values[i] == nullptr) throw CallError("a null pointer, expected a text");
        taken.emplace_back(values[i]);
      } else if constexpr (std::is_same_v<T, bool>) {
        taken.push_back(values[i] != 0);
      } else {
        taken.push_back(values[i]);
      }
    }
    instance.slave->set<T>({references, count}, taken);
  });
}

int digit_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The folder of a "file:" URI, RFC 3986: file:/x, file:///x, file://localhost/x, with %20 and the like.
std::filesystem::path folder_of(std::string_view uri) {
  if (!uri.starts_with("file:")) throw CallError("fmuResourceLocation is no file: URI, expected file:///…/resources");
  uri.remove_prefix(5);
  if (uri.starts_with("//")) {
    uri.remove_prefix(2);
    const std::size_t slash = uri.find('/');
    if (slash == std::string_view::npos) throw CallError("fmuResourceLocation names no folder");
    uri.remove_prefix(slash);
  }
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() + 0U ? digit_of(uri[i + 1]) : -1;
    const int low = high >= 0 ? digit_of(uri[i + 2]) : -1;
    if (low >= 0) {
      path += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

std::string read_description(std::string_view uri) {
  const std::filesystem::path file = folder_of(uri) / host_sim::fmu::description_resource;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw CallError(file.string() + " cannot be read, expected the rig description of this FMU");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

fmi2Status refuse(fmi2Component component, const char* what) {
  return carry_out(component, [what](Instance&) { throw CallError(what); });
}

struct HeldState {
  Slave::State state;
  std::string bytes{};
};

const HeldState& held(fmi2FMUstate state) {
  if (state == nullptr) throw CallError("no FMU state, expected one of fmi2GetFMUstate");
  return *static_cast<const HeldState*>(state);
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

/// Errors are always logged; there is nothing else to log.
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean /*on*/, std::size_t count, const fmi2String categories[]) {
  return carry_out(c, [&](Instance&) { demand_pointers(count, categories, categories); });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/,
                              fmi2Boolean /*logging*/) {
  auto instance = std::make_unique<Instance>();
  if (functions != nullptr) instance->callbacks = *functions;
  instance->name = name != nullptr ? name : "";
  try {
    if (instance->name.empty()) throw CallError("an instance without name, expected a name");
    if (type != fmi2CoSimulation) throw CallError("this FMU is for co-simulation only");
    if (guid == nullptr || resources == nullptr) throw CallError("a null pointer, expected GUID and resource location");
    instance->slave = std::make_unique<Slave>(read_description(resources));
    if (instance->slave->guid() != guid) {
      throw CallError("the GUID is " + std::string(guid) + ", expected " + instance->slave->guid() +
                      ", the SHA-256 of " + host_sim::fmu::description_resource);
    }
    return instance.release();
  } catch (const std::exception& error) {
    log(*instance, fmi2Error, error.what());
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component c) { delete static_cast<Instance*>(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean /*tolerance_defined*/, fmi2Real /*tolerance*/,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
  return carry_out(c, [&](Instance& instance) {
    if (stop_defined != 0 && !(stop >= start)) throw CallError("stopTime is before startTime");
    instance.slave->set_up(start);
  });
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return carry_out(c, [](Instance& instance) { instance.slave->enter_initialisation(); });
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return carry_out(c, [](Instance& instance) { instance.slave->exit_initialisation(); });
}
fmi2Status fmi2Terminate(fmi2Component c) {
  return carry_out(c, [](Instance& instance) { instance.slave->terminate(); });
}
fmi2Status fmi2Reset(fmi2Component c) {
  return carry_out(c, [](Instance& instance) { instance.slave->reset(); });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Real values[]) {
  return get<double>(c, vr, n, values);
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Integer values[]) {
  return get<int>(c, vr, n, values);
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Boolean values[]) {
  return get<bool>(c, vr, n, values);
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2String values[]) {
  return carry_out(c, [&](Instance& instance) {
    demand_pointers(n, vr, values);
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < n; ++i) shown.push_back(instance.slave->get<std::string>(vr[i]));
    instance.shown = std::move(shown);
    for (std::size_t i = 0; i < n; ++i) values[i] = instance.shown[i].c_str();
  });
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Real values[]) {
  return set<double>(c, vr, n, values);
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Integer values[]) {
  return set<int>(c, vr, n, values);
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Boolean values[]) {
  return set<bool>(c, vr, n, values);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2String values[]) {
  return set<std::string>(c, vr, n, values);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return carry_out(c, [&](Instance& instance) {
    demand_pointers(1, state, state);
    auto made = std::make_unique<HeldState>(HeldState{instance.slave->state()});
    delete static_cast<HeldState*>(*state);  // an old one is renewed
    *state = made.release();
  });
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return carry_out(c, [&](Instance& instance) { instance.slave->set_state(held(state).state); });
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return carry_out(c, [&](Instance&) {
    if (state == nullptr) return;
    delete static_cast<HeldState*>(*state);
    *state = nullptr;
  });
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, std::size_t* size) {
  return carry_out(c, [&](Instance& instance) {
    demand_pointers(1, size, size);
    *size = instance.slave->serialise(held(state).state).size();
  });
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  return carry_out(c, [&](Instance& instance) {
    demand_pointers(1, bytes, bytes);
    const std::string made = instance.slave->serialise(held(state).state);
    if (size < made.size())
      throw CallError("too few bytes for the state, expected what fmi2SerializedFMUstateSize says");
    made.copy(bytes, made.size());
  });
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], std::size_t size, fmi2FMUstate* state) {
  return carry_out(c, [&](Instance& instance) {
    demand_pointers(1, bytes, state);
    auto made = std::make_unique<HeldState>(HeldState{instance.slave->deserialise({bytes, size})});
    delete static_cast<HeldState*>(*state);
    *state = made.release();
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return refuse(c, "this FMU has no directional derivatives");
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                       const fmi2Real[]) {
  return refuse(c, "this FMU does not interpolate its inputs; velocity and acceleration are inputs of their own");
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                        fmi2Real[]) {
  return refuse(c, "this FMU has no derivatives of outputs");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real current, fmi2Real step, fmi2Boolean /*no_return*/) {
  bool goes_on = true;
  const fmi2Status status = carry_out(c, [&](Instance& instance) { goes_on = instance.slave->step(current, step); });
  if (status != fmi2OK || goes_on) return status;
  const Instance& instance = *static_cast<Instance*>(c);
  log(instance, fmi2Discard, "the firmware ended the run: " + instance.slave->why_ended());
  return fmi2Discard;
}
fmi2Status fmi2CancelStep(fmi2Component c) { return refuse(c, "no step is under way: steps are not asynchronous"); }

fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind, fmi2Status*) {
  return c == nullptr ? fmi2Error : fmi2Discard;  // nothing is pending, ever
}
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (c == nullptr || value == nullptr) return fmi2Error;
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = static_cast<const Instance*>(c)->slave->time();
  return fmi2OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind, fmi2Integer*) {
  return c == nullptr ? fmi2Error : fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  if (c == nullptr || value == nullptr) return fmi2Error;
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = static_cast<const Instance*>(c)->slave->ended() ? 1 : 0;
  return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind, fmi2String*) {
  return c == nullptr ? fmi2Error : fmi2Discard;
}

}  // extern "C"
