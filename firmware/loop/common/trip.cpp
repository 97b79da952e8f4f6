#include "firmware/loop/common/trip.hpp"

#include "model/numerics/inline.hpp"

namespace firmware {

RIGTWIN_NOINLINE std::optional<Trip> hazard_of(Reason reason, model::Channel channel, double value, double limit,
                                               hal::Time now) {
  return Trip{reason, channel, value, limit, now};
}

}  // namespace firmware
