// rigtwin channels: the glossary of channels.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace host_sim {

struct ChannelsOptions {
  std::string kind;  ///< of rig; empty: all
  std::string json;
};

/// Prints each channel with its sign, unit and rigs, and a picture. UsageError for a kind that there is not.
void list_channels(const ChannelsOptions& options);

void add_channels(CLI::App& app, ChannelsOptions& options);

}  // namespace host_sim
