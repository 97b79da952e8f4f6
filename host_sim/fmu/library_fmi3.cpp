// The functions of FMI 3.0 for co-simulation that an FMU's library exports.
#include <cstddef>
#include <optional>
#include <string>

#include "host_sim/fmu/fmi3.hpp"
#include "host_sim/fmu/instance.hpp"

namespace {

namespace fmu = host_sim::fmu;

fmi3Status status(bool right) { return right ? fmi3OK : fmi3Error; }

fmu::Logger logger_of(fmi3InstanceEnvironment environment, fmi3LogMessageCallback callback) {
  return [environment, callback](fmu::Severity severity, const std::string& text) {
    if (callback == nullptr) return;
    callback(environment, severity == fmu::Severity::end ? fmi3Discard : fmi3Error, "logStatusError", text.c_str());
  };
}

/// All variables are scalars, so there is one value for each reference.
bool one_each(fmi3Instance c, std::size_t references, std::size_t values) {
  if (c == nullptr || references == values) return c != nullptr;
  return fmu::refuse(c, "there are not as many values as references, expected one for each: no variable is an array");
}

fmi3Status no_such_type(fmi3Instance c, std::size_t count) {
  return count == 0 ? status(c != nullptr)
                    : status(fmu::refuse(c, "no variable has this type, expected Float64, Int32, Boolean or String"));
}

fmi3Status no_clocks(fmi3Instance c) { return status(fmu::refuse(c, "this FMU has no clocks")); }
fmi3Status no_event_mode(fmi3Instance c) {
  return status(fmu::refuse(c, "this FMU has no event mode: its samples are its events"));
}
fmi3Status no_model_exchange(fmi3Instance c) {
  return status(fmu::refuse(c, "this FMU is for co-simulation, not for model exchange"));
}
fmi3Status no_derivatives(fmi3Instance c) { return status(fmu::refuse(c, "this FMU has no derivatives")); }

}  // namespace

extern "C" {

const char* fmi3GetVersion() { return "3.0"; }

/// Errors are always logged; there is nothing else to log.
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean /*on*/, std::size_t count, const fmi3String categories[]) {
  return status(fmu::carry_out(c, [&](fmu::Instance&) { fmu::demand_pointers(count, categories, categories); }));
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean /*visible*/, fmi3Boolean /*logging*/, fmi3Boolean event_mode,
                                         fmi3Boolean early_return, const fmi3ValueReference /*intermediate*/[],
                                         std::size_t intermediate_count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback /*update*/) {
  const char* objection = event_mode               ? "this FMU has no event mode, expected eventModeUsed = false"
                          : intermediate_count > 0 ? "this FMU shows no values within a step"
                          : resources == nullptr   ? "a null pointer, expected the resource path"
                                                   : "";
  void* const made = fmu::make_instance(
      logger_of(environment, log), name, token, [&] { return std::filesystem::path(resources); }, objection);
  if (made != nullptr) static_cast<fmu::Instance*>(made)->may_return_early = early_return;
  return made;
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  logger_of(environment, log)(fmu::Severity::error, "this FMU is for co-simulation only");
  return nullptr;
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback,
                                               fmi3UnlockPreemptionCallback) {
  return fmi3InstantiateModelExchange(nullptr, nullptr, nullptr, false, false, environment, log);
}
void fmi3FreeInstance(fmi3Instance c) { delete static_cast<fmu::Instance*>(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean /*tolerance_defined*/, fmi3Float64 /*tolerance*/,
                                       fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop) {
  return status(fmu::carry_out(c, [&](fmu::Instance& instance) {
    instance.slave->set_up(start, stop_defined ? std::optional(stop) : std::nullopt);
    instance.slave->enter_initialisation();
  }));
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->exit_initialisation(); }));
}
fmi3Status fmi3Terminate(fmi3Instance c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->terminate(); }));
}
fmi3Status fmi3Reset(fmi3Instance c) {
  return status(fmu::carry_out(c, [](fmu::Instance& instance) { instance.slave->reset(); }));
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, fmi3Float64 values[],
                          std::size_t count) {
  return status(one_each(c, n, count) && fmu::carry_out(c, [&](fmu::Instance& instance) {
                  fmu::demand_pointers(n, vr, values);
                  fmu::Slave& slave = *instance.slave;
                  for (std::size_t i = 0; i < n; ++i) {
                    values[i] = vr[i] == slave.variables().time() ? slave.time() : slave.get<double>(vr[i]);
                  }
                }));
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, fmi3Int32 values[],
                        std::size_t count) {
  return status(one_each(c, n, count) && fmu::get_values<int>(c, vr, n, values));
}
fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, fmi3Boolean values[],
                          std::size_t count) {
  return status(one_each(c, n, count) && fmu::get_values<bool>(c, vr, n, values));
}
fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, fmi3String values[],
                         std::size_t count) {
  return status(one_each(c, n, count) && fmu::get_texts(c, vr, n, values));
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, const fmi3Float64 values[],
                          std::size_t count) {
  return status(one_each(c, n, count) && fmu::set_values<double>(c, vr, n, values));
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, const fmi3Int32 values[],
                        std::size_t count) {
  return status(one_each(c, n, count) && fmu::set_values<int>(c, vr, n, values));
}
fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, const fmi3Boolean values[],
                          std::size_t count) {
  return status(one_each(c, n, count) && fmu::set_values<bool>(c, vr, n, values));
}
fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], std::size_t n, const fmi3String values[],
                         std::size_t count) {
  return status(one_each(c, n, count) && fmu::set_values<std::string>(c, vr, n, values));
}

#define RIGTWIN_FMI3_NO_VALUES(Type)                                                                               \
  fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference[], std::size_t n, fmi3##Type[], std::size_t) { \
    return no_such_type(c, n);                                                                                     \
  }                                                                                                                \
  fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference[], std::size_t n, const fmi3##Type[],          \
                           std::size_t) {                                                                          \
    return no_such_type(c, n);                                                                                     \
  }
RIGTWIN_FMI3_NO_VALUES(Float32)
RIGTWIN_FMI3_NO_VALUES(Int8)
RIGTWIN_FMI3_NO_VALUES(UInt8)
RIGTWIN_FMI3_NO_VALUES(Int16)
RIGTWIN_FMI3_NO_VALUES(UInt16)
RIGTWIN_FMI3_NO_VALUES(UInt32)
RIGTWIN_FMI3_NO_VALUES(Int64)
RIGTWIN_FMI3_NO_VALUES(UInt64)
#undef RIGTWIN_FMI3_NO_VALUES
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference[], std::size_t n, std::size_t[], fmi3Binary[],
                         std::size_t) {
  return no_such_type(c, n);
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference[], std::size_t n, const std::size_t[],
                         const fmi3Binary[], std::size_t) {
  return no_such_type(c, n);
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) { return status(fmu::get_state(c, state)); }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) { return status(fmu::set_state(c, state)); }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState* state) { return status(fmu::free_state(c, state)); }
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, std::size_t* size) {
  return status(fmu::serialised_size(c, state, size));
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], std::size_t size) {
  return status(fmu::serialise_state(c, state, reinterpret_cast<char*>(bytes), size));
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], std::size_t size, fmi3FMUState* state) {
  return status(fmu::deserialise_state(c, reinterpret_cast<const char*>(bytes), size, state));
}

/// Where the firmware ends the run within a step: the importer is asked to terminate. The step counts as one that
/// returned early if the importer allows that, else as one of which only a part could be done.
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 current, fmi3Float64 step, fmi3Boolean /*no_return*/,
                      fmi3Boolean* event_handling_needed, fmi3Boolean* terminate, fmi3Boolean* early_return,
                      fmi3Float64* last_successful_time) {
  if (!fmu::carry_out(c, [&](fmu::Instance&) {
        fmu::demand_pointers(1, event_handling_needed, terminate);
        fmu::demand_pointers(1, early_return, last_successful_time);
      })) {
    return fmi3Error;
  }
  const fmu::Step ended = fmu::do_step(c, current, step);
  const fmu::Instance& instance = *static_cast<fmu::Instance*>(c);
  *event_handling_needed = false;
  *terminate = ended == fmu::Step::ended;
  *early_return = *terminate && instance.may_return_early;
  *last_successful_time = instance.slave->time();
  if (ended == fmu::Step::ended && !instance.may_return_early) return fmi3Discard;
  return status(ended != fmu::Step::failed);
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference, std::size_t*) {
  return status(fmu::refuse(c, "this FMU states no dependencies of single elements"));
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference, std::size_t[], fmi3ValueReference[],
                                       std::size_t[], fmi3DependencyKind[], std::size_t) {
  return status(fmu::refuse(c, "this FMU states no dependencies of single elements"));
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference[], std::size_t,
                                        const fmi3ValueReference[], std::size_t, const fmi3Float64[], std::size_t,
                                        fmi3Float64[], std::size_t) {
  return no_derivatives(c);
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3ValueReference[],
                                    std::size_t, const fmi3Float64[], std::size_t, fmi3Float64[], std::size_t) {
  return no_derivatives(c);
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3Int32[],
                                    fmi3Float64[], std::size_t) {
  return no_derivatives(c);
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
  return status(fmu::refuse(c, "this FMU has no structural parameters"));
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
  return status(fmu::refuse(c, "this FMU has no structural parameters"));
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) { return no_event_mode(c); }
fmi3Status fmi3EnterStepMode(fmi3Instance c) { return no_event_mode(c); }
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) { return no_event_mode(c); }
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*,
                                    fmi3Boolean*, fmi3Float64*) {
  return no_event_mode(c);
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference[], std::size_t, fmi3Clock[]) { return no_clocks(c); }
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3Clock[]) {
  return no_clocks(c);
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], std::size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
  return no_clocks(c);
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], std::size_t, fmi3UInt64[], fmi3UInt64[],
                                   fmi3IntervalQualifier[]) {
  return no_clocks(c);
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], std::size_t, fmi3Float64[]) {
  return no_clocks(c);
}
fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference[], std::size_t, fmi3UInt64[], fmi3UInt64[]) {
  return no_clocks(c);
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return no_clocks(c);
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
  return no_clocks(c);
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return no_clocks(c);
}
fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
  return no_clocks(c);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { return no_model_exchange(c); }
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean, fmi3Boolean*, fmi3Boolean*) {
  return no_model_exchange(c);
}
fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64) { return no_model_exchange(c); }
fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64[], std::size_t) { return no_model_exchange(c); }
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64[], std::size_t) {
  return no_model_exchange(c);
}
fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64[], std::size_t) { return no_model_exchange(c); }
fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64[], std::size_t) { return no_model_exchange(c); }
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64[], std::size_t) {
  return no_model_exchange(c);
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, std::size_t*) { return no_model_exchange(c); }
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, std::size_t*) { return no_model_exchange(c); }
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference, fmi3Float64) { return no_clocks(c); }

}  // extern "C"
