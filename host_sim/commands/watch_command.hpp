// rigtwin watch: a rig while it runs, as a page on this machine.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace host_sim {

struct WatchOptions {
  int port = 8080;
  std::string address = "127.0.0.1";
  std::string receive = "localhost:9870";
  std::string socket, rig, json;
  bool diagnose = false;
};

void add_watch(CLI::App& app, WatchOptions& options);

}  // namespace host_sim
