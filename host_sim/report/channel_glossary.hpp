// What the channels of a recording are: the one glossary that commands, pages and the manual show.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "model/components/channel.hpp"

namespace host_sim::report {

struct ChannelMeaning {
  model::Channel channel;
  std::string_view meaning;   ///< "foot point displacement"
  std::string_view positive;  ///< "up": where it is above zero
  bool quarter_car, hil, component_bench;

  [[nodiscard]] bool of(model::RigKind kind) const;
};

/// All channels, in the order of model::Channel.
[[nodiscard]] std::span<const ChannelMeaning> channel_glossary();
[[nodiscard]] const ChannelMeaning& meaning_of(model::Channel channel);

/// "foot point displacement [m], positive up"
[[nodiscard]] std::string in_words(model::Channel channel);

/// Where the channels are on the rig, drawn with letters.
[[nodiscard]] std::string_view channel_picture();

/// HTML text in which each name of a channel shows its meaning when pointed at. `escaped`: HTML text without elements;
/// "F" counts where it is the whole text.
[[nodiscard]] std::string with_meanings(std::string_view escaped);

}  // namespace host_sim::report
