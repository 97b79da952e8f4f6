// The functions of FMI 2.0 for co-simulation that an FMU's library exports.
#include <cstddef>
#include <optional>
#include <string>

#include "host_sim/fmu/fmi2.hpp"
#include "host_sim/fmu/instance.hpp"

namespace {

namespace fmu = host_sim::fmu;

fmi2Status status(bool right) { return right ? fmi2OK : fmi2Error; }

/// The message is a format: a % is doubled, and so is a # (2.1.5: it would name a variable). It has no arguments, since
/// an importer that does not format shows it as it is.
std::string as_format(const std::string& text) {
  std::string format;
  for (const char c : text) {
    if (c == '%' || c == '#') format += c;
    format += c;
  }
  return format;
}

fmu::Logger logger_of(const fmi2CallbackFunctions* functions, const std::string& name) {
  const fmi2CallbackFunctions callbacks = functions != nullptr ? *functions : fmi2CallbackFunctions{};
  return [callbacks, name](fmu::Severity severity, const std::string& text) {
    if (callbacks.logger == nullptr) return;
    callbacks.logger(callbacks.componentEnvironment, name.c_str(),
                     severity == fmu::Severity::end ? fmi2Discard : fmi2Error, "logStatusError",
                     as_format(text).c_str());
  };
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

/// Errors are always logged; there is nothing else to log.
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean /*on*/, std::size_t count, const fmi2String categories[]) {
  return status(fmu::carry_out(c, [&](fmu::Instance&) { fmu::demand_pointers(count, categories, categories); }));
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/,
                              fmi2Boolean /*logging*/) {
  const char* objection = type != fmi2CoSimulation ? "this FMU is for co-simulation only"
                          : resources == nullptr   ? "a null pointer, expected the resource location"
                                                   : "";
  return fmu::make_instance(
      logger_of(functions, name != nullptr ? name : ""), name, guid, [&] { return fmu::folder_of_uri(resources); },
      objection);
}

void fmi2FreeInstance(fmi2Component c) { delete static_cast<fmu::Instance*>(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean /*tolerance_defined*/, fmi2Real /*tolerance*/,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
  return status(fmu::carry_out(c, [&](fmu::Instance& instance) {
    instance.slave->set_up(start, stop_defined != 0 ? std::optional(stop) : std::nullopt);
  }));
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->enter_initialisation(); }));
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->exit_initialisation(); }));
}
fmi2Status fmi2Terminate(fmi2Component c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->terminate(); }));
}
fmi2Status fmi2Reset(fmi2Component c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->reset(); }));
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Real values[]) {
  return status(fmu::get_values<double>(c, vr, n, values));
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Integer values[]) {
  return status(fmu::get_values<int>(c, vr, n, values));
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2Boolean values[]) {
  return status(fmu::get_values<bool>(c, vr, n, values));
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, fmi2String values[]) {
  return status(fmu::get_texts(c, vr, n, values));
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Real values[]) {
  return status(fmu::set_values<double>(c, vr, n, values));
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Integer values[]) {
  return status(fmu::set_values<int>(c, vr, n, values));
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2Boolean values[]) {
  return status(fmu::set_values<bool>(c, vr, n, values));
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], std::size_t n, const fmi2String values[]) {
  return status(fmu::set_values<std::string>(c, vr, n, values));
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) { return status(fmu::get_state(c, state)); }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) { return status(fmu::set_state(c, state)); }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) { return status(fmu::free_state(c, state)); }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, std::size_t* size) {
  return status(fmu::serialised_size(c, state, size));
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  return status(fmu::serialise_state(c, state, bytes, size));
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], std::size_t size, fmi2FMUstate* state) {
  return status(fmu::deserialise_state(c, bytes, size, state));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return status(fmu::refuse(c, "this FMU has no directional derivatives"));
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                       const fmi2Real[]) {
  return status(
      fmu::refuse(c, "this FMU does not interpolate its inputs; velocity and acceleration are inputs of their own"));
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                        fmi2Real[]) {
  return status(fmu::refuse(c, "this FMU has no derivatives of outputs"));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real current, fmi2Real step, fmi2Boolean /*no_return*/) {
  const fmu::Step ended = fmu::do_step(c, current, step);
  return ended == fmu::Step::ended ? fmi2Discard : status(ended == fmu::Step::done);
}
fmi2Status fmi2CancelStep(fmi2Component c) {
  return status(fmu::refuse(c, "no step is under way: steps are not asynchronous"));
}

fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind, fmi2Status*) {
  return c == nullptr ? fmi2Error : fmi2Discard;  // nothing is pending, ever
}
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (c == nullptr || value == nullptr) return fmi2Error;
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = static_cast<const fmu::Instance*>(c)->slave->time();
  return fmi2OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind, fmi2Integer*) {
  return c == nullptr ? fmi2Error : fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  if (c == nullptr || value == nullptr) return fmi2Error;
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = static_cast<const fmu::Instance*>(c)->slave->ended() ? 1 : 0;
  return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind, fmi2String*) {
  return c == nullptr ? fmi2Error : fmi2Discard;
}

}  // extern "C"
