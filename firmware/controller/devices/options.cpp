#include "firmware/controller/devices/options.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include "firmware/controller/devices/publish_address.hpp"

namespace firmware::controller {

const char* const usage =
    R"(rig_controller drives a rig by the program that `rigtwin simulate` runs, on real lines and converters, in real time.

  rig_controller --rig RIG.toml --out RUN.csv [--road iso8608:B | --road FILE.csv] [--speed 27.78]
                 [--duration 60] [--seed 1] [--bandwidth HZ] [--cut-off HZ]
  rig_controller --rig RIG.toml --check     lines, converters, rights, limits: everything but motion
  rig_controller [--rig RIG.toml] COMMAND   to the program that drives the rig, see below
  rig_controller --rig RIG.toml --unit-times  a drop-in for the systemd unit: its times for this rig
  rig_controller --list                     GPIO chips and lines, converters and triggers that are there

  --start           arm and start at once: I stand beside the rig. Without it the program waits for arm and start
  --socket PATH     of the operator's commands, in place of [controller] socket (/run/rigtwin/control.sock, of a service
                    /run/rigtwin/NAME/control.sock)
  --wait            with --simulated: wait for the operator there too
  --overwrite       an earlier recording or histogram of that name; without it the run is refused. What the run reads
                    is never replaced
  --part-minutes M  a new file every M minutes: RUN.csv, RUN-0002.csv, …; at least two periods of the loop
  --cycles N        the road N times, with a joint without a jump; 0: until it is stopped
  --programme FILE.toml  in place of a road: [[blocks]], each with road, speed, duration, seed, level, repetitions, pause
  --publish [HOST:PORT]  each period as a UDP datagram of JSON for PlotJuggler and `rigtwin watch` (localhost:9870). Never
                    waits: what is not sent is counted
  --publish-every N one period of N
  --publish-remote  HOST may be another machine
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

using Task = Options::Task;

constexpr std::array<std::pair<std::string_view, Task>, 6> task_options{{{"--check", Task::check},
                                                                         {"--unit-times", Task::unit_times},
                                                                         {"--list", Task::list},
                                                                         {"--help", Task::help},
                                                                         {"-h", Task::help},
                                                                         {"--version", Task::version}}};

constexpr std::array<std::pair<std::string_view, bool Options::*>, 6> flag_options{
    {{"--simulated", &Options::simulated},
     {"--publish-remote", &Options::publish_remote},
     {"--start", &Options::start},
     {"--wait", &Options::wait},
     {"--overwrite", &Options::overwrite},
     {"--virtual-time", &Options::virtual_time}}};

constexpr std::array<std::pair<std::string_view, std::string Options::*>, 7> text_options{
    {{"--rig", &Options::rig},
     {"--out", &Options::out},
     {"--histogram", &Options::histogram},
     {"--road", &Options::road},
     {"--replay", &Options::replay},
     {"--socket", &Options::socket},
     {"--programme", &Options::programme}}};

template <class Number>
bool read(std::string_view text, Number& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

/// A number above 0 and below a limit.
bool read_positive(std::string_view text, double& number, double below) {
  return read(text, number) && number > 0.0 && number < below;
}

/// The field of that name in a table of options; null: the table has none.
template <class Table>
auto find(const Table& table, std::string_view word) -> decltype(&table.front().second) {
  for (const auto& [name, field] : table) {
    if (name == word) return &field;
  }
  return nullptr;
}

/// An option without a value. false: `word` is none.
bool take_flag(std::string_view word, Options& options) {
  if (const auto* task = find(task_options, word)) {
    options.task = *task;
  } else if (const auto* flag = find(flag_options, word)) {
    options.*(*flag) = true;
  } else if (word == "--no-realtime") {
    options.realtime = false;
  } else {
    return false;
  }
  return true;
}

/// An option with a number. true: the number fits; no value: `word` is no such option.
std::optional<bool> take_number(std::string_view word, std::string_view value, Options& options) {
  constexpr double any = std::numeric_limits<double>::infinity();
  if (word == "--speed") return read_positive(value, options.speed, 1e3);
  if (word == "--duration") return read_positive(value, options.duration, 1e6);
  if (word == "--part-minutes") return read_positive(value, options.part_minutes, any);
  if (word == "--bandwidth") return read_positive(value, options.bandwidth.emplace(), any);
  if (word == "--cut-off") return read_positive(value, options.cut_off.emplace(), any);
  if (word == "--cycles") return read(value, options.cycles);
  if (word == "--seed") return read(value, options.seed);
  if (word == "--publish-every") return read(value, options.publish_every) && options.publish_every > 0;
  return std::nullopt;
}

/// True if an option describes the one road of a run.
bool of_a_road(std::string_view word) {
  return word == "--road" || word == "--speed" || word == "--duration" || word == "--cycles" || word == "--bandwidth" ||
         word == "--cut-off";
}

/// What is wrong with publishing. Empty: nothing.
std::string publish_conflict(const Options& options) {
  if (!options.publish.empty()) return publish_objection(options.publish, options.publish_remote);
  if (options.publish_remote) return "--publish-remote needs --publish";
  return options.publish_every > 1 ? "--publish-every needs --publish" : "";
}

/// The options that exclude each other, or are missing. Empty: they fit together.
std::string conflict(const Options& options, const std::string& road_option) {
  if (options.rig.empty()) return "--rig is missing, expected a rig description";
  if (options.task == Task::run && options.out.empty()) return "--out is missing, expected the recording's name";
  if (!options.histogram.empty() && options.histogram == options.out) {
    return "--histogram and --out name one file, expected two";
  }
  if (!options.programme.empty() && !road_option.empty()) {
    return "--programme and " + road_option + ": expected one of them, the blocks of a programme say their roads";
  }
  if (options.wait && options.start) return "--wait and --start: expected one of them";
  if (options.wait && (options.virtual_time || !options.replay.empty())) {
    return "--wait needs a rig in real time: nobody waits in virtual time";
  }
  if (options.virtual_time && !options.simulated) return "--virtual-time needs --simulated: a rig has its own time";
  if (const std::string trouble = publish_conflict(options); !trouble.empty()) return trouble;
  if (options.replay.empty()) return {};
  if (options.simulated) return "--replay and --simulated: expected one of them";
  if (options.replay == options.out) return "--replay and --out name one file, expected two";
  return {};
}

}  // namespace

Options read_options(int argc, char** argv, std::string& trouble) {
  Options options;
  std::string road_option;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with('-')) {
      options.task = Task::ask;
      options.request += (options.request.empty() ? "" : " ") + std::string(word);
      continue;
    }
    if (take_flag(word, options)) continue;
    if (word == "--publish") {
      const bool told = i + 1 < argc && argv[i + 1][0] != '-';
      options.publish = told ? std::string_view(argv[++i]) : usual_publish_address;
      continue;
    }
    const auto* text = find(text_options, word);
    Options unused;
    if (text == nullptr && !take_number(word, {}, unused)) {
      trouble = "unknown option " + std::string(word) + ", see rig_controller --help";
      return options;
    }
    if (i + 1 == argc) {
      trouble = std::string(word) + " needs a value";
      return options;
    }
    const std::string_view value = argv[++i];
    if (of_a_road(word)) road_option = word;
    if (text != nullptr) {
      options.*(*text) = value;
    } else if (!*take_number(word, value, options)) {
      trouble = std::string(word) + " " + std::string(value) + " does not fit, expected a number above 0";
    }
  }
  const bool of_a_rig = options.task == Task::run || options.task == Task::check || options.task == Task::unit_times;
  if (!trouble.empty() || !of_a_rig) return options;
  trouble = conflict(options, road_option);
  if (!options.replay.empty()) options.virtual_time = true;
  return options;
}

}  // namespace firmware::controller
