// Recordings of tests/truth, read as a user's files are.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "tests/truth/truth.hpp"

namespace sample {

struct Given {
  firmware::RigDescription description;
  firmware::Recording recording;
};

/// 12 s of a group, as read from its files.
inline Given given(const std::string& group, std::uint64_t seed = 1) {
  truth::Wanted wanted;
  wanted.duration = 12.0;
  truth::Truth truth = truth::draw(group, seed, wanted);
  truth.records.resize(1);
  Given result{firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  result.recording = firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv");
  return result;
}

}  // namespace sample
