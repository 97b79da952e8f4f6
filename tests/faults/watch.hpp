// What the watches of a campaign have in common: the first invariant that is violated stays.
#pragma once

#include <cstdio>
#include <string>

#include "tests/faults/scenario.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"

namespace faults {

class Watch {
 public:
  [[nodiscard]] const std::string& violated() const { return violated_; }  ///< in words; empty: nothing

 protected:
  /// `who` watches, which the words begin with.
  Watch(const char* who, const Scenario& scenario, const rig_under_test::Journey& journey)
      : scenario_(scenario), journey_(journey), who_(who) {}

  void violate(const char* what, double value, double limit) {
    if (!violated_.empty()) return;
    char text[200];
    std::snprintf(text, sizeof text, "%s: %s: %.6g, limit %.6g, at %.3f s in %s after %s", who_, what, value, limit,
                  journey_.rig.now().seconds(), std::string(name(journey_.loop.mode())).c_str(),
                  std::string(name(journey_.loop.trip().reason)).c_str());
    violated_ = text;
  }

  const Scenario& scenario_;
  const rig_under_test::Journey& journey_;

 private:
  const char* who_;
  std::string violated_;
};

}  // namespace faults
