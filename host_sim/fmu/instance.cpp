#include "host_sim/fmu/instance.hpp"

#include <fstream>
#include <iterator>

namespace host_sim::fmu {
namespace {

int digit_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string read_description(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / description_resource;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw CallError(file.string() + " cannot be read, expected the rig description of this FMU");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

const Slave::State& held(void* state) {
  if (state == nullptr) throw CallError("no FMU state, expected one that this library gave");
  return static_cast<const HeldState*>(state)->state;
}

// Puts a state behind the importer's handle; an old one is renewed.
void hold(Slave::State state, void** handle) {
  demand_pointers(1, handle, handle);
  auto made = std::make_unique<HeldState>(HeldState{std::move(state)});
  delete static_cast<HeldState*>(*handle);
  *handle = made.release();
}

}  // namespace

std::filesystem::path folder_of_uri(std::string_view uri) {
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
#ifdef _WIN32  // file:///C:/x is C:/x
  if (path.size() > 2 && path[0] == '/' && path[2] == ':') path.erase(0, 1);
#endif
  return path;
}

void* make_instance(Logger log, const char* name, const char* token,
                    const std::function<std::filesystem::path()>& folder, const std::string& objection) {
  try {
    auto instance = std::make_unique<Instance>();
    instance->log = std::move(log);
    try {
      if (name == nullptr || *name == '\0') throw CallError("an instance without name, expected a name");
      if (!objection.empty()) throw CallError(objection);
      if (token == nullptr) throw CallError("a null pointer, expected the identifier of the FMU");
      instance->slave = std::make_unique<Slave>(read_description(folder()));
      if (instance->slave->guid() != token) {
        throw CallError("the GUID is " + std::string(token) + ", expected " + instance->slave->guid() +
                        ", the SHA-256 of " + description_resource);
      }
      return instance.release();
    } catch (const std::exception& error) {
      instance->log(Severity::error, error.what());
    }
  } catch (const std::exception&) {  // no memory: nothing can be said
  }
  return nullptr;
}

bool get_texts(void* handle, const unsigned references[], std::size_t count, const char* values[]) {
  return carry_out(handle, [&](Instance& instance) {
    demand_pointers(count, references, values);
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < count; ++i) shown.push_back(instance.slave->get<std::string>(references[i]));
    instance.shown = std::move(shown);
    for (std::size_t i = 0; i < count; ++i) values[i] = instance.shown[i].c_str();
  });
}

bool get_state(void* handle, void** state) {
  return carry_out(handle, [&](Instance& instance) { hold(instance.slave->state(), state); });
}

bool set_state(void* handle, void* state) {
  return carry_out(handle, [&](Instance& instance) { instance.slave->set_state(held(state)); });
}

bool free_state(void* handle, void** state) {
  return carry_out(handle, [&](Instance&) {
    if (state == nullptr) return;
    delete static_cast<HeldState*>(*state);
    *state = nullptr;
  });
}

bool serialised_size(void* handle, void* state, std::size_t* size) {
  return carry_out(handle, [&](Instance& instance) {
    demand_pointers(1, size, size);
    *size = instance.slave->serialise(held(state)).size();
  });
}

bool serialise_state(void* handle, void* state, char bytes[], std::size_t size) {
  return carry_out(handle, [&](Instance& instance) {
    demand_pointers(1, bytes, bytes);
    const std::string made = instance.slave->serialise(held(state));
    if (size < made.size()) throw CallError("too few bytes for the state, expected as many as its serialised size");
    made.copy(bytes, made.size());
  });
}

bool deserialise_state(void* handle, const char bytes[], std::size_t size, void** state) {
  return carry_out(handle, [&](Instance& instance) {
    demand_pointers(1, bytes, state);
    hold(instance.slave->deserialise({bytes, size}), state);
  });
}

Step do_step(void* handle, double current, double size) {
  bool goes_on = true;
  const bool right = carry_out(handle, [&](Instance& instance) {
    goes_on = instance.slave->step(current, size);
    if (!goes_on) instance.log(Severity::end, "the firmware ended the run: " + instance.slave->why_ended());
  });
  return !right ? Step::failed : goes_on ? Step::done : Step::ended;
}

}  // namespace host_sim::fmu
