#include <cstdio>
#include <exception>
#include <string>

#include "firmware/controller/control_socket.hpp"
#include "firmware/controller/run.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/version.hpp"

namespace {

/// The program of a rig whose description is given listens where that says.
int ask(const firmware::controller::Options& options) {
  using namespace firmware::controller;
  const std::string described = options.rig.empty() || !options.socket.empty()
                                    ? std::string()
                                    : firmware::read_rig(options.rig).hardware.schedule.socket;
  return ask_controller(clients_path(options.socket, described, options.rig), options.request);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace firmware::controller;
  std::string trouble;
  const Options options = read_options(argc, argv, trouble);
  const auto end = [](Status status, const char* line) {
    std::fprintf(stderr, "rig_controller: %s\n", line);
    return static_cast<int>(status);
  };
  if (!trouble.empty()) return end(Status::wrong_usage, trouble.c_str());
  if (options.task == Options::Task::help) {
    std::fputs(usage, stdout);
    return 0;
  }
  if (options.task == Options::Task::version) {
    std::printf("rig_controller %s\n", firmware::version.data());
    return 0;
  }
  try {
    if (options.task == Options::Task::ask) return ask(options);
    return static_cast<int>(run(options));
  } catch (const firmware::UsageError& error) {
    return end(Status::wrong_usage, error.what());
  } catch (const firmware::OutputError& error) {
    return end(Status::cannot_write, error.what());
  } catch (const firmware::InputError& error) {
    return end(Status::unfit_input, error.what());
  } catch (const std::exception& error) {
    return end(Status::internal, error.what());
  }
}
