#include "host_sim/commands/watch_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/internet_address.hpp"
#include "host_sim/commands/common/ending_signals.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/diagnose_live.hpp"
#include "host_sim/live/live_watch.hpp"
#include "host_sim/watch/access.hpp"
#include "host_sim/watch/receiver.hpp"
#include "host_sim/watch/watch_server.hpp"

namespace host_sim {
namespace {

/// One address of this machine, in numbers: a server that listened at all of them could not know its own name.
std::string own_address(const std::string& text) {
  if (const auto address = firmware::parse_host(text)) return address->host();
  throw firmware::UsageError("--address " + firmware::in_quotes(text) +
                             " does not fit, expected localhost or one address of this machine in numbers");
}

void watch_rig(const WatchOptions& options) {
  if (options.diagnose && options.rig.empty()) throw firmware::UsageError("watch --diagnose: --rig is needed");
  const std::string address = own_address(options.address);
  std::optional<firmware::RigDescription> rig;
  if (!options.rig.empty()) rig = firmware::read_rig(options.rig);
  const std::string socket = operators_socket(options.socket, rig ? rig->hardware.schedule.socket : "");
  const firmware::InternetAddress from =
      firmware::parse_host_port("--receive", options.receive, {.port_alone = true, .any_port = true});
  const sigset_t ending = block_ending_signals();
  watch::Feed feed;
  std::optional<live::LiveWatch> diagnosis;
  if (options.diagnose) diagnosis.emplace(*rig, socket, feed, [](const std::string&) {});
  const watch::Receiver receiver(from, feed);
  const watch::WatchServer server({address, options.port, socket}, feed);
  const nlohmann::ordered_json started{
      {"url", server.url()}, {"values_from", receiver.address().text()}, {"requests_to", socket}};
  if (!write_json(options.json, started)) {
    std::printf("%s\n", server.url().c_str());
    std::printf("  values     from UDP %s (rig_controller --publish)\n", receiver.address().text().c_str());
    std::printf("  requests   to %s\n", socket.c_str());
    if (!watch::is_loopback(address)) {
      std::printf("  NOTE: not encrypted. Whoever reads along on this network learns the token and can ask the rig.\n");
    }
  }
  std::fflush(stdout);
  int signal = 0;
  ::sigwait(&ending, &signal);
}

}  // namespace

void add_watch(CLI::App& app, WatchOptions& options) {
  CLI::App* command = app.add_subcommand("watch", "A rig while it runs: a page with traces, states and margins");
  command->add_option("--port", options.port, "Of the page; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option(
          "--address", options.address,
          "Of this machine, where the page is served; another than 127.0.0.1 lets others in the network see it")
      ->capture_default_str();
  command
      ->add_option("--receive", options.receive, "Where the datagrams of rig_controller --publish come in: HOST:PORT")
      ->capture_default_str();
  command->add_option("--socket", options.socket, "Of the controller, for requests (/run/rigtwin/control.sock)");
  command->add_option("--rig", options.rig, "Rig description (TOML) that names that socket ([controller] socket)");
  command->add_flag(
      "--diagnose", options.diagnose,
      "Name on the page what begins to be wrong with the rig of --rig, and stop the run if its description says so "
      "([controller] model_watch)");
  add_json_option(*command, options.json, "the page's address with its token, as soon as it is served,");
  command->callback([&options] { watch_rig(options); });
}

}  // namespace host_sim
