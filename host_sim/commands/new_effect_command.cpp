#include "host_sim/commands/new_effect_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/new_effect/new_effect.hpp"

namespace host_sim {
namespace {

void begin_effect(const NewEffectOptions& options) {
  const new_effect::NewEffect added = new_effect::prepare(options.name, options.tree);
  // Each under a temporary name first; the list last, so that it never names a file that is not there.
  firmware::OutputFile effect(added.effect.path), test(added.test.path), catalogue(added.catalogue.path);
  effect.write(added.effect.text);
  test.write(added.test.text);
  catalogue.write(added.catalogue.text);
  effect.commit();
  test.commit();
  catalogue.commit();
  const nlohmann::ordered_json json{{"name", options.name},
                                    {"type", added.type},
                                    {"effect", added.effect.path.string()},
                                    {"test", added.test.path.string()},
                                    {"catalogue", added.catalogue.path.string()}};
  if (write_json(options.json, json)) return;
  std::printf(
      "%s: equation, card and law of %s, to be replaced by yours\n%s: its test\n%s: its entry in the list\n"
      "then: cmake --preset host && cmake --build build/host && ctest --preset tests -R %s\n",
      added.effect.path.c_str(), added.type.c_str(), added.test.path.c_str(), added.catalogue.path.c_str(),
      added.type.c_str());
}

}  // namespace

void add_new_effect(CLI::App& app, NewEffectOptions& options) {
  CLI::App* command =
      app.add_subcommand("new-effect", "Begin a new effect in a source tree: its file with card, its test, its entry");
  command->add_option("name", options.name, "Name of the effect, as in rig descriptions: helper_spring")->required();
  command->add_option("--tree", options.tree, "Root of the source tree")->capture_default_str();
  add_json_option(*command, options.json, "what was written");
  command->callback([&options] { begin_effect(options); });
}

}  // namespace host_sim
