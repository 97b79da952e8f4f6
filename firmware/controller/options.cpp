#include "firmware/controller/options.hpp"

#include <charconv>
#include <cmath>
#include <string_view>

namespace firmware::controller {

const char* const usage =
    R"(rig_controller drives a rig by the program that `rigtwin simulate` runs, on real lines and converters, in real time.

  rig_controller --rig RIG.toml --out RUN.csv [--road iso8608:B | --road FILE.csv] [--speed 27.78]
                 [--duration 60] [--seed 1] [--bandwidth HZ] [--cut-off HZ]
  rig_controller --rig RIG.toml --check     lines, converters, rights, limits: everything but motion
  rig_controller COMMAND                    to the program that drives the rig, see below
  rig_controller --rig RIG.toml --unit-times  a drop-in for the systemd unit: its times for this rig
  rig_controller --list                     GPIO chips and lines, converters and triggers that are there

  --start           arm and start at once: I stand beside the rig. Without it the program waits for arm and start
  --socket PATH     of the operator's commands (/run/rigtwin/control.sock)
  --wait            with --simulated: wait for the operator there too
  --overwrite       an earlier recording of that name; without it the run is refused
  --part-minutes M  a new file every M minutes: RUN.csv, RUN-0002.csv, …
  --cycles N        the road N times, with a joint without a jump; 0: until it is stopped
  --programme FILE.toml  in place of a road: [[blocks]], each with road, speed, duration, seed, level, repetitions, pause
  --histogram FILE  wake-up latency, step time and sample age as `cyclictest -h` writes them
  --no-realtime     run without real-time rights; the recording says so
  --simulated       the rig's model in place of its devices, in real time
  --virtual-time    with --simulated: nobody sleeps, the same bits on every machine
  --replay FILE.csv what a recording's sensors said in place of devices, in its own time; nobody sleeps. With the road of
                    that run: the same bits as then

Roads are those of `rigtwin simulate`: ISO 8608 classes A … H, or z_r [m] over t [s] or s [m] in a CSV file.

Commands of the operator, each answered by one line of JSON: state, arm, disarm, start, hold, resume, stop, acknowledge
(after the reason for the safe state is gone), rest (from where a stop has left the rig), level 0.8 (0 to 1.5), mark TEXT
(a line in the recording).

Signals that end a program stop the run in good order; USR1 prints the histograms.
Exit status: 0 done, 2 wrong usage, 3 unfit rig description, 4 cannot write, 5 internal, 6 devices or rights are missing,
7 safe stop: the last line says why.
)";

namespace {

template <class Number>
bool read(std::string_view text, Number& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

}  // namespace

Options read_options(int argc, char** argv, std::string& trouble) {
  Options options;
  std::string road_option;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with('-')) {
      options.task = Options::Task::ask;
      options.request += (options.request.empty() ? "" : " ") + std::string(word);
    } else if (word == "--check") {
      options.task = Options::Task::check;
    } else if (word == "--unit-times") {
      options.task = Options::Task::unit_times;
    } else if (word == "--list") {
      options.task = Options::Task::list;
    } else if (word == "--help" || word == "-h") {
      options.task = Options::Task::help;
    } else if (word == "--version") {
      options.task = Options::Task::version;
    } else if (word == "--no-realtime") {
      options.realtime = false;
    } else if (word == "--simulated") {
      options.simulated = true;
    } else if (word == "--start") {
      options.start = true;
    } else if (word == "--wait") {
      options.wait = true;
    } else if (word == "--overwrite") {
      options.overwrite = true;
    } else if (word == "--virtual-time") {
      options.virtual_time = true;
    } else {
      const bool known = word == "--rig" || word == "--out" || word == "--road" || word == "--speed" ||
                         word == "--duration" || word == "--histogram" || word == "--seed" || word == "--replay" ||
                         word == "--bandwidth" || word == "--cut-off" || word == "--part-minutes" ||
                         word == "--cycles" || word == "--socket" || word == "--programme";
      if (!known) {
        trouble = "unknown option " + std::string(word) + ", see rig_controller --help";
        return options;
      }
      if (i + 1 == argc) {
        trouble = std::string(word) + " needs a value";
        return options;
      }
      const std::string_view value = argv[++i];
      bool fits = true;
      if (word == "--rig") options.rig = value;
      if (word == "--out") options.out = value;
      if (word == "--histogram") options.histogram = value;
      if (word == "--road") options.road = value;
      if (word == "--speed") fits = read(value, options.speed) && options.speed > 0.0 && options.speed < 1e3;
      if (word == "--duration")
        fits = read(value, options.duration) && options.duration > 0.0 && options.duration < 1e6;
      if (word == "--replay") options.replay = value;
      for (auto [name, frequency] : {std::pair{"--bandwidth", &options.bandwidth}, {"--cut-off", &options.cut_off}}) {
        double number = 0.0;
        if (word != name) continue;
        fits = read(value, number) && number > 0.0;
        *frequency = number;
      }
      if (word == "--part-minutes") fits = read(value, options.part_minutes) && options.part_minutes > 0.0;
      if (word == "--socket") options.socket = value;
      if (word == "--programme") options.programme = value;
      const bool of_a_road = word == "--road" || word == "--speed" || word == "--duration" || word == "--cycles" ||
                             word == "--bandwidth" || word == "--cut-off";
      if (of_a_road) road_option = word;
      if (word == "--cycles") fits = read(value, options.cycles);
      if (word == "--seed") fits = read(value, options.seed);
      if (!fits) trouble = std::string(word) + " " + std::string(value) + " does not fit, expected a number above 0";
    }
  }
  using Task = Options::Task;
  const bool of_a_rig = options.task == Task::run || options.task == Task::check || options.task == Task::unit_times;
  if (!trouble.empty() || !of_a_rig) return options;
  if (options.rig.empty()) trouble = "--rig is missing, expected a rig description";
  if (options.task == Task::run && options.out.empty()) trouble = "--out is missing, expected the recording's name";
  if (!options.histogram.empty() && options.histogram == options.out) {
    trouble = "--histogram and --out name one file, expected two";
  }
  if (!options.programme.empty() && !road_option.empty()) {
    trouble = "--programme and " + road_option + ": expected one of them, the blocks of a programme say their roads";
  }
  if (options.wait && options.start) trouble = "--wait and --start: expected one of them";
  if (options.wait && (options.virtual_time || !options.replay.empty())) {
    trouble = "--wait needs a rig in real time: nobody waits in virtual time";
  }
  if (options.virtual_time && !options.simulated) trouble = "--virtual-time needs --simulated: a rig has its own time";
  if (!options.replay.empty()) {
    if (options.simulated) trouble = "--replay and --simulated: expected one of them";
    if (options.replay == options.out) trouble = "--replay and --out name one file, expected two";
    options.virtual_time = true;
  }
  return options;
}

}  // namespace firmware::controller
