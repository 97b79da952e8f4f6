// What the libraries of all versions of FMI have in common: each of their functions is a call of Slave.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host_sim/fmu/slave.hpp"

namespace host_sim::fmu {

enum class Severity : unsigned char {
  error,  ///< a call was wrong
  end,    ///< the firmware has ended the run
};
/// To the importer; never empty. Nothing but errors is logged.
using Logger = std::function<void(Severity, const std::string& text)>;

/// What an importer's handle of an instance points to.
struct Instance {
  Logger log;
  std::unique_ptr<Slave> slave{};
  std::vector<std::string> shown{};  ///< the texts that a function gave last, until the next call
  bool may_return_early = false;     ///< FMI 3.0: within a step
};

/// What an importer's handle of a kept state points to.
struct HeldState {
  Slave::State state;
};

/// Makes an instance of the description in `folder`; nullptr, and a line in the log, if that cannot be. `token`: the
/// GUID of FMI 2.0, the instantiation token of FMI 3.0; `objection`: what else is wrong, empty: nothing.
[[nodiscard]] void* make_instance(Logger log, const char* name, const char* token,
                                  const std::function<std::filesystem::path()>& folder, const std::string& objection);

/// The folder of a "file:" URI, RFC 3986: file:/x, file:///x, file://localhost/x, with %20 and the like. CallError.
[[nodiscard]] std::filesystem::path folder_of_uri(std::string_view uri);

/// Carries out a call on an instance. False, and a line in the log: it fails. Nothing is thrown through C.
template <class Call>
bool carry_out(void* handle, const Call& call) {
  if (handle == nullptr) return false;
  Instance& instance = *static_cast<Instance*>(handle);
  try {
    call(instance);
    return true;
  } catch (const std::exception& error) {
    instance.log(Severity::error, error.what());
    return false;
  }
}

inline bool refuse(void* handle, const char* what) {
  return carry_out(handle, [what](Instance&) { throw CallError(what); });
}

inline void demand_pointers(std::size_t count, const void* references, const void* values) {
  if (count > 0 && (references == nullptr || values == nullptr)) throw CallError("a null pointer, expected an array");
}

template <class T, class Out>
bool get_values(void* handle, const unsigned references[], std::size_t count, Out values[]) {
  return carry_out(handle, [&](Instance& instance) {
    demand_pointers(count, references, values);
    for (std::size_t i = 0; i < count; ++i) values[i] = instance.slave->get<T>(references[i]);
  });
}
bool get_texts(void* handle, const unsigned references[], std::size_t count, const char* values[]);

template <class T, class In>
bool set_values(void* handle, const unsigned references[], std::size_t count, const In values[]) {
  return carry_out(handle, [&](Instance& instance) {
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

/// States: `state` is the importer's handle of one.
bool get_state(void* handle, void** state);
bool set_state(void* handle, void* state);
bool free_state(void* handle, void** state);
bool serialised_size(void* handle, void* state, std::size_t* size);
bool serialise_state(void* handle, void* state, char bytes[], std::size_t size);
bool deserialise_state(void* handle, const char bytes[], std::size_t size, void** state);

/// How a step ended.
enum class Step : unsigned char {
  failed,  ///< the call was wrong; the log says why
  done,
  ended,  ///< the firmware has ended the run; the log says why, Slave::time() where
};
[[nodiscard]] Step do_step(void* handle, double current, double size);

}  // namespace host_sim::fmu
