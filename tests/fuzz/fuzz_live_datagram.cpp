// Any bytes as a datagram of rig_controller --publish: none, or one within its bounds; and the feed makes a frame of it
// that can be sent.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "host_sim/watch/datagram.hpp"
#include "host_sim/watch/feed.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto datagram = host_sim::watch::parse_datagram(text);
  if (datagram) {
    require(std::isfinite(datagram->timestamp));
    require(datagram->values.size() <= 96);
    for (const auto& [name, value] : datagram->values) require(name.size() <= 40 && std::isfinite(value));
  }
  host_sim::watch::Feed feed;
  host_sim::watch::Feed::Cursor cursor;
  feed.take(R"({"timestamp":1,"sequence":1,"state":"idle","setup":{"units":{"F":"N"}},"F":1})", "a", 0.0, 0);
  feed.take(text, "a", 0.0, 0);
  // A number that is none would come back as null, and bytes that are no text do not leave at all.
  const auto frame = feed.frame(cursor, 0.0);
  require(decltype(frame)::parse(frame.dump()) == frame);
  return 0;
}
