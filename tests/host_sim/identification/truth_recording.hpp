// Recordings of tests/truth, read as a user's files are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "tests/truth/truth.hpp"

namespace sample {

struct Given {
  firmware::RigDescription description;
  firmware::Recording recording;
};

/// A recording of a group, as read from its files; `beside`: more effects than the group's.
inline Given given(const std::string& group, std::uint64_t seed = 1, const std::vector<truth::Effect>& beside = {},
                   double seconds = 12.0) {
  truth::Wanted wanted;
  wanted.duration = seconds;
  truth::Truth truth = truth::draw(group, seed, wanted);
  truth.records.resize(1);
  truth.effects.insert(truth.effects.end(), beside.begin(), beside.end());
  Given result{firmware::parse_rig(truth::rig_toml(truth), "rig.toml"), {}};
  result.recording = firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth).front()), "rec.csv");
  return result;
}

}  // namespace sample
