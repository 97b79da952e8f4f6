// The commit that the program was built from.
#pragma once

#include <string_view>

namespace host_sim {

/// Its first digits, "+" behind them where the sources had been changed; empty: the sources were in no repository.
extern const std::string_view commit;

}  // namespace host_sim
