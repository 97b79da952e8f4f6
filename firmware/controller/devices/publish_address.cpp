#include "firmware/controller/devices/publish_address.hpp"

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/internet_address.hpp"

namespace firmware::controller {

std::string publish_objection(const std::string& address, bool remote) {
  try {
    if (parse_host_port("--publish", address).loopback || remote) return {};
  } catch (const UsageError& error) {
    return error.what();
  }
  return "--publish " + address +
         " is another machine: the values would leave this one unprotected, and a busy network takes time from the "
         "loop; expected an address of this machine, or --publish-remote as well";
}

}  // namespace firmware::controller
