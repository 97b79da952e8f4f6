#include "host_sim/report/channel_glossary.hpp"

#include <algorithm>
#include <array>

#include "host_sim/report/report.hpp"

namespace host_sim::report {
namespace {

using model::Channel;

constexpr std::array<ChannelMeaning, model::channel_count> glossary{{
    {Channel::z_r, "foot point displacement (road, cylinder)", "up", true, true, false},
    {Channel::z_w, "wheel displacement", "up", true, true, false},
    {Channel::z_b, "body displacement", "up", true, true, false},
    {Channel::zdd_r, "foot point acceleration", "up", true, true, false},
    {Channel::zdd_w, "wheel acceleration", "up", true, true, false},
    {Channel::zdd_b, "body acceleration; driven by force: of the mass", "up; along F", true, true, false},
    {Channel::dz_w, "tyre deflection z_r - z_w", "compressed", true, true, false},
    {Channel::dz_b, "suspension deflection z_w - z_b", "compressed", true, true, false},
    {Channel::F_w, "dynamic wheel load, without (m_b + m_w) g", "more load", true, true, false},
    {Channel::x_cmd, "deflection commanded to the test machine", "compressed", false, true, true},
    {Channel::x_act, "deflection reached by the machine or the driven mass", "compressed", false, true, true},
    {Channel::F, "force of the component; driven by force: on the mass", "in compression", false, true, true},
    {Channel::F_act, "known extra force of an actuator between wheel and body", "in compression", true, false, false},
    {Channel::z_cmd, "foot point displacement commanded to the machine", "up", true, false, false},
}};

constexpr bool in_order() {
  for (std::size_t c = 0; c < glossary.size(); ++c) {
    if (index(glossary[c].channel) != c) return false;
  }
  return true;
}
static_assert(in_order());

constexpr std::string_view picture =
    R"(  quarter_car, hil                          component_bench (and the machine of a hil rig)

     [  body m_b  ]   z_b, zdd_b  ^ up
       |       |
     spring  F_act    dz_b = z_w - z_b           [ load cell ]  F > 0 in compression
     damper    |      compressed > 0                   |
       |       |                                  ( component )
     [  wheel m_w ]   z_w, zdd_w  ^ up                 |
       |                                          [  machine  ] ^ x_cmd commanded, x_act reached,
     tyre  F_w        dz_w = z_r - z_w                             compressed > 0
       |              compressed > 0
     foot point       z_r, zdd_r  ^ up            Displacements count from the static equilibrium.

  component_bench with driven_by = "force"

     F pushes the mass [ m ], which compresses the component: x_act > 0 along F, zdd_b = d2(x_act)/dt2
)";

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

}  // namespace

bool ChannelMeaning::of(model::RigKind kind) const {
  if (kind == model::RigKind::quarter_car) return quarter_car;
  if (kind == model::RigKind::driven_mass) {
    return channel == Channel::F || channel == Channel::x_act || channel == Channel::zdd_b;
  }
  return kind == model::RigKind::hil ? hil : component_bench;
}

std::span<const ChannelMeaning> channel_glossary() { return glossary; }

const ChannelMeaning& meaning_of(Channel channel) { return glossary[index(channel)]; }

std::string in_words(Channel channel) {
  const ChannelMeaning& meaning = meaning_of(channel);
  return std::string(meaning.meaning) + " [" + std::string(model::unit(channel)) + "], positive " +
         std::string(meaning.positive);
}

std::string_view channel_picture() { return picture; }

std::string with_meanings(std::string_view text) {
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    std::size_t end = at;
    while (end < text.size() && is_letter(text[end])) ++end;
    const std::string_view word = text.substr(at, end - at);
    const auto channel = word.empty() ? std::nullopt : model::find_channel(word);
    // A path such as noise.F_w or a file such as F_w.csv names no channel.
    const bool in_path = (at > 0 && (text[at - 1] == '.' || text[at - 1] == '/')) ||
                         (end + 1 < text.size() && text[end] == '.' && is_letter(text[end + 1]));
    if (channel && !in_path && (word.size() > 1 || word.size() == text.size())) {
      result += "<abbr title=\"" + escaped(in_words(*channel)) + "\">" + std::string(word) + "</abbr>";
    } else {
      result += word;
    }
    if (end < text.size()) result += text[end++];
    at = end;
  }
  return result;
}

}  // namespace host_sim::report
