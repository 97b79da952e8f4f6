// Long recordings through the program: speed by processor time, and the most memory that it held.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path& folder() {
  static const fs::path made = [] {
    std::string name = (fs::temp_directory_path() / "rigtwin-bench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    std::atexit([] { fs::remove_all(folder()); });
    return fs::path(name);
  }();
  return made;
}

// Ten columns of another program, 90 bytes a row at 1 kHz.
fs::path text_file(std::size_t rows) {
  const fs::path file = folder() / ("text" + std::to_string(rows) + ".csv");
  if (fs::exists(file)) return file;
  std::FILE* const to = std::fopen(file.c_str(), "w");
  std::fputs("Time [s],Displ [mm],Force [N],Acc [g],Temp [C],U1 [V],U2 [V],P1 [bar],P2 [bar],Flow [l/min]\n", to);
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = 1e-3 * static_cast<double>(k);
    const double wave = std::sin(19.0 * t);
    std::fprintf(to, "%.3f,%.5f,%.3f,%.5f,%.3f,%.6f,%.6f,%.5f,%.5f,%.4f\n", t, 10.0 * wave, 500.0 * wave, wave,
                 20.0 + wave, wave, -wave, 100.0 + wave, 50.0 - wave, 12.0 + wave);
  }
  std::fclose(to);
  return file;
}

struct Use {
  double seconds = 0.0;  // of the processor
  double peak = 0.0;     // [MiB]
  bool well = false;
};

Use run(std::vector<std::string> arguments) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "rigtwin";
  arguments.insert(arguments.begin(), program.string());
  const pid_t child = ::fork();
  if (child == 0) {
    const int null = ::open("/dev/null", O_WRONLY);
    ::dup2(null, STDOUT_FILENO);
    std::vector<char*> words;
    for (std::string& word : arguments) words.push_back(word.data());
    words.push_back(nullptr);
    ::execv(program.c_str(), words.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024.0,
          WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

// Argument: thousands of rows. The peak must not grow with them beyond 300 MiB.
void import_text(benchmark::State& state, const std::string& ending) {
  const fs::path file = text_file(1000 * static_cast<std::size_t>(state.range(0)));
  const auto size = static_cast<double>(fs::file_size(file));
  for (auto _ : state) {
    const Use use = run({"import", file.string(), "--out", (folder() / ("out" + ending)).string()});
    if (!use.well) state.SkipWithError("rigtwin import failed: is the program built?");
    state.SetIterationTime(use.seconds);
    state.counters["MB/s"] = 1e-6 * size / use.seconds;
    state.counters["peak_MiB"] = use.peak;
  }
}
void import_csv(benchmark::State& state) { import_text(state, ".csv"); }
void import_mat(benchmark::State& state) { import_text(state, ".mat"); }
void import_rsp(benchmark::State& state) { import_text(state, ".rsp"); }
BENCHMARK(import_csv)
    ->Name("files/import_csv")
    ->Arg(500)
    ->Arg(4000)
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK(import_mat)->Name("files/import_mat")->Arg(4000)->UseManualTime()->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK(import_rsp)->Name("files/import_rsp")->Arg(4000)->UseManualTime()->Iterations(1)->Unit(benchmark::kSecond);

void simulate_minutes(benchmark::State& state) {
  const fs::path rig = folder() / "rig.toml";
  if (!fs::exists(rig)) {
    std::FILE* const to = std::fopen(rig.c_str(), "w");
    std::fputs(
        "kind = \"quarter_car\"\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\n"
        "stiffness = 200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n",
        to);
    std::fclose(to);
  }
  for (auto _ : state) {
    const Use use = run({"simulate", "--rig", rig.string(), "--road", "iso8608:B", "--speed", "20", "--duration",
                         std::to_string(60 * state.range(0)), "--out", (folder() / "run.csv").string()});
    if (!use.well) state.SkipWithError("rigtwin simulate failed: is the program built?");
    state.SetIterationTime(use.seconds);
    state.counters["peak_MiB"] = use.peak;
  }
}
BENCHMARK(simulate_minutes)
    ->Name("files/simulate_minutes")
    ->Arg(60)
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
