// The page that shows a rig while it runs.
#pragma once

#include <string>
#include <string_view>

namespace host_sim::watch {

/// The whole page, with style and script in it; it fetches nothing but the events of its own server. `nonce`: of the
/// Content-Security-Policy that comes with it.
[[nodiscard]] std::string watch_page(std::string_view nonce);

/// Content-Security-Policy for that page: its own style and script, connections to its own server, nothing else.
[[nodiscard]] std::string watch_page_policy(std::string_view nonce);

}  // namespace host_sim::watch
