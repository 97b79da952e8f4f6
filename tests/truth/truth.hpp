#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// Recordings with a known answer, made without the product: nothing here includes or links a file of model/.
///
///   draw a group and a seed → Truth (what hides in the rig)  →  simulate → Record  →  csv, rig_toml, truth_json
///
/// Equations, signs, units and order of effects: the contract's catalogue. Everything SI.
namespace truth {

enum class Kind { quarter_car, hil, component_bench };

/// One entry of the contract's catalogue; `channel` only for sensor effects.
struct Effect {
  std::string name;
  std::string channel;
  std::map<std::string, double> parameters;
};

/// One run on the rig.
struct RecordPlan {
  double duration = 30.0;           ///< [s]
  double level = 1.0;               ///< factor on the road, or rms of x_cmd [m] on a bench
  std::uint64_t road_seed = 1;      ///< road or command
  std::uint64_t noise_seed = 2;     ///< noise, phases of holds
  double warm = 0.0;                ///< [s] run before the first sample; 0: from rest, with a ramp of 1 s
  double start = 0.0;               ///< t of the first sample [s]
  double corner = 0.0;              ///< [Hz] below which the spectrum falls (road), is flat (command); 0: 0.35, 2
  double cut = 0.0;                 ///< [Hz] above which there is nothing; 0: 40 (road), 25 (command)
  double modulation_depth = 0.0;    ///< bench only: amplitude 1 + depth sin(2π t / period + phase)
  double modulation_period = 15.0;  ///< [s]
  double modulation_phase = 0.0;    ///< [rad]
  std::string form;                 ///< "sweep", "steps", "stepped_sines", "multisine"; empty: noise
};

/// Steps of a recorder on a channel behind its sensor, in this order; 0 is "not there".
struct Recorder {
  double corner = 0.0;   ///< [Hz] of a low-pass on signal and noise
  int order = 1;         ///< 1 … 4 (Butterworth)
  bool digital = false;  ///< computed from the samples; else before they are taken
  double late = 0.0;     ///< [s] by which a clock of its own is late at the first sample, ≥ 0
  double drift = 0.0;    ///< [s/s] by which it gets later, ≥ 0
  double hum = 0.0;      ///< amplitude of a sine
  double hum_hz = 50.0;  ///< [Hz]
  double step = 0.0;     ///< rounding
  int outliers = 0;      ///< single samples far off, per record
  double outlier = 0.0;  ///< by how much
};

/// Something that acts on the rig from outside: a half sine of force.
struct Event {
  std::string where;  ///< "body" or "wheel"; on a bench "F", the load cell
  double from = 0.0;  ///< [s] since the first sample
  double to = 0.0;
  double force = 0.0;  ///< [N]
};

/// A fault of the recording as a verdict's `recording` would say it.
struct Fault {
  std::vector<std::string> names;  ///< any of these is right
  std::vector<std::string> channels;
  std::map<std::string, double> parameters;
};

/// Everything that differs from the description beside the effects. All off: the truths that draw() makes of its
/// groups.
struct Rough {
  std::string condition;
  std::map<std::string, double> declared;    ///< by channel: factor on the noise that rig.toml declares
  bool noise_absent = false;                 ///< rig.toml has no [noise]
  bool tolerance_absent = false;             ///< rig.toml has no [tolerance]
  std::vector<std::string> off;              ///< paths of parameters outside their tolerance
  std::vector<std::string> missing;          ///< channels that are not recorded
  double described_rate = 0.0;               ///< [Hz] sample_rate of rig.toml; 0: the recording's
  int stamp_decimals = -1;                   ///< of t; −1: enough
  double not_a_number = 0.0;                 ///< share of rows with one cell that is none
  double lost = 0.0;                         ///< share of rows that are lost one by one
  int gaps = 0;                              ///< stretches of rows that are lost
  double gap_share = 0.0;                    ///< of all rows, in those stretches
  std::map<std::string, Recorder> recorder;  ///< by channel
  std::map<std::string, double> drift;       ///< by path: relative change from the first sample to the last
  std::vector<Event> events;
  std::vector<Fault> faults;  ///< what the verdict shall say of the recording
};

/// A rig, what its description says, and what hides in it.
struct Truth {
  std::string id;
  std::string group;
  Kind kind = Kind::quarter_car;
  bool fdva = false;                                       ///< an FDVA beside the spring-damper
  double sample_rate = 1000.0;                             ///< [Hz]; divides 20 kHz
  std::map<std::string, double> nominal;                   ///< by path, "body.mass"; what rig.toml says
  std::map<std::string, double> actual;                    ///< by path; inside the tolerances
  std::map<std::string, double> tolerance;                 ///< by path, relative
  std::map<std::string, double> noise;                     ///< rms by channel
  std::map<std::string, std::pair<double, double>> range;  ///< by channel
  std::vector<Effect> effects;                             ///< 0 … 3
  std::string unknown;                                     ///< words for what is outside the catalogue; or empty
  std::map<std::string, double> unknown_parameters;        ///< what `unknown` is made of
  std::string unknown_channel;                             ///< where it acts, if in a sensor
  double size = 0.0;             ///< largest rms change of a channel ÷ its noise, found when drawing; see draw
  bool lag_takes_noise = false;  ///< sensor_lag filters signal plus noise (contract) or the signal alone (sample_b)
  bool units_in_header = false;  ///< style of the file: "z_r [m]"
  std::vector<RecordPlan> records;
  Rough rough;
};

/// Columns by name, all of one length; `time` in s.
struct Record {
  std::vector<double> time;
  std::map<std::string, std::vector<double>> channels;
};

/// How fine simulate works; the tests halve the step.
struct Fineness {
  int steps_per_millisecond = 20;  ///< ≥ 1
  bool noise = true;               ///< false: noise left out, sensor effects kept
};

/// How large the drawn effect is.
struct Wanted {
  bool weak = false;         ///< 30 … 100 σ in all instead of 3 … 300 times the noise of a channel
  double duration = 30.0;    ///< [s] of a single record; of two, each has two thirds
  bool varied = false;       ///< other rigs, roads, noise and sample rates than those of the samples
  double sample_rate = 0.0;  ///< [Hz]; 0: drawn
  double level = 1.0;        ///< factor on road or command
  std::string form{};        ///< of road or command, see RecordPlan
};

/// "quarter_car", "hil", "component_bench".
[[nodiscard]] std::string name_of(Kind kind);

/// Channels of a recording in the order of its columns.
[[nodiscard]] const std::vector<std::string>& channels_of(Kind kind);

/// Every group draw knows: "single:<kind>:<effect>[:<channel>]", "pair:<kind>", "none:<kind>", "unknown:<kind>:<what>".
[[nodiscard]] std::vector<std::string> groups();

/// Draws a rig with what the group asks for. Same group, seed and wish: same truth, to the bit.
///
/// The first size of an effect comes from a range; it is then scaled, within limits a rig can have, until leaving the
/// effect out changes some channel by 3 … 300 times its noise (rms over 4 s of the first record, same road, no noise).
/// Weak: until the changes of all channels over all records sum up to 30 … 100 σ. `group` may also be
/// "single:<effect>[:<channel>]", "pair", "none", "unknown": the kind is drawn too. Also "quadruple", "quintuple"
/// (four and five effects) and "neighbour", "neighbour_beside" (a law near one of the catalogue, alone and beside an
/// effect).
/// @throws std::invalid_argument for a group there is not
[[nodiscard]] Truth draw(const std::string& group, std::uint64_t seed, const Wanted& wanted = {});

/// Conditions under which a description does not say everything, or not rightly: see README.
[[nodiscard]] const std::vector<std::string>& conditions();

/// A rig under such a condition, of 20 s if nothing else is wanted of its duration. Seeds in a row take turns with the
/// number of hidden effects. @throws std::invalid_argument for a condition there is not
[[nodiscard]] Truth draw_rough(const std::string& condition, std::uint64_t seed);

/// Channels that the truth's recordings hold, in the order of their columns.
[[nodiscard]] std::vector<std::string> recorded_channels(const Truth& truth);

/// The measured channels of every record. @throws std::invalid_argument if an effect does not exist on this kind of rig
[[nodiscard]] std::vector<Record> simulate(const Truth& truth, const Fineness& fineness = {});

/// The rig description `rigtwin` gets: nominal values, tolerances, noise, ranges, no effect.
[[nodiscard]] std::string rig_toml(const Truth& truth);

/// One record as a recording's text: 9 digits, as the samples have.
[[nodiscard]] std::string csv(const Truth& truth, const Record& record);

/// What is hidden, in the form of the samples' truth.json.
[[nodiscard]] std::string truth_json(const Truth& truth);

}  // namespace truth
