// What this machine takes for as much work as a period of the control loop is, after as long a sleep: the floor that
// the loop's own time is held against (real_time.bash).
//
//   rigtwin_rival SECONDS PRIORITY NANOSECONDS        priority 0: as an ordinary program
//
// Every millisecond the program sleeps and then goes once through 48 pieces of code, each of four cache lines and three
// more of data, spread over as many pages as the loop's data: 201 lines of code, 144 of data, 2400 instructions, hardly
// a branch among them. (A period of the hil loop on x86-64, simulated rig included, with all its branches: 197 lines of
// code, 144 of data, 2380 instructions; counted with valgrind's lackey.) In every third period it does so before, too,
// over and over while it waits awake for its instant, as rig_controller does; and in every third it does nothing at all
// after such a wait but read the clock until NANOSECONDS have passed: how often that takes longer than 5 µs is the
// machine's doing alone.
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include "firmware/controller/real_time/wake_lead.hpp"
#include "firmware/controller/recording/spans.hpp"
#include "hal/linux/clock.hpp"

namespace {

constexpr std::size_t pieces = 48;
constexpr std::size_t pages = 18;
constexpr std::size_t page = 4096 / sizeof(double);
constexpr std::size_t line = 64 / sizeof(double);

struct Data {
  double *a, *b, *c;
};

template <std::size_t I>
[[gnu::noinline, gnu::aligned(256)]] void piece(const Data& d) {
  constexpr double some = 1.0 / static_cast<double>(I + 2), more = 0.5 + some;
  d.a[0] = d.a[0] * some + d.b[0];
  d.a[1] = d.a[1] * more + d.b[1];
  d.a[2] = d.a[2] * some - d.b[2];
  d.b[3] = d.b[3] * more + d.c[3];
  d.b[4] = d.b[4] * some + d.c[4];
  d.b[5] = d.b[5] * more - d.c[5];
  d.c[6] = d.c[6] * some + d.a[6];
  d.c[7] = d.c[7] * more - d.a[7];
  d.a[6] = d.b[1] * some + d.c[0];
  d.b[7] = d.c[2] * more + d.a[4];
  d.c[3] = d.a[3] * some - d.b[6];
}

/// In an order that does not follow the addresses, as calls do not.
template <std::size_t... I>
[[gnu::noinline]] void go_through(const std::array<Data, pieces>& data, std::index_sequence<I...>) {
  (piece<(I * 23) % pieces>(data[I]), ...);
}

}  // namespace

int main(int argc, char** argv) {
  const long seconds = argc == 4 ? std::atol(argv[1]) : 0;
  const int priority = argc == 4 ? std::atoi(argv[2]) : 0;
  const hal::Time window = hal::nanoseconds(argc == 4 ? std::atol(argv[3]) : 0);
  if (seconds < 1 || window <= hal::Time{}) {
    std::fputs("usage: rigtwin_rival SECONDS PRIORITY NANOSECONDS\n", stderr);
    return 2;
  }
  auto memory = std::make_unique<std::array<double, pages * page>>();
  memory->fill(1e-3);
  std::array<Data, pieces> data{};
  std::size_t next = 0;
  const auto take = [&] {
    double* taken = memory->data() + next * 7 % pages * page + next / pages * line;
    ++next;
    return taken;
  };
  for (Data& d : data) d = {take(), take(), take()};
  ::mlockall(MCL_CURRENT | MCL_FUTURE);
  if (priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) std::puts("  SCHED_FIFO refused");
  }

  const auto work = [&] { go_through(data, std::make_index_sequence<pieces>{}); };
  hal::linux::MonotonicClock clock;
  firmware::controller::WakeLead wake(hal::microseconds(200));
  enum Kind : std::size_t { plain, warmed, nothing };
  const auto histograms = std::make_unique<std::array<firmware::controller::Histogram, 3>>();
  hal::Time due = clock.now() + hal::milliseconds(1);
  for (std::size_t k = 0; k < static_cast<std::size_t>(seconds) * 1000; ++k, due += hal::milliseconds(1)) {
    const auto kind = static_cast<Kind>(k % 3);
    clock.sleep_until(kind == plain ? due : due - wake.early());
    if (kind == warmed) wake.use([&] { return due - clock.now(); }, work);
    while (clock.now() < due) {
    }
    const hal::Time begin = clock.now();
    hal::Time end = begin;
    if (kind == nothing) {
      while (end < begin + window) end = clock.now();
    } else {
      work();
      end = clock.now();
    }
    (*histograms)[kind].add((end - begin).ns);
    if (end > due + hal::milliseconds(1)) due = end;
  }
  for (const auto& [what, kind] : {std::pair{"rival", plain}, {"rival, warmed", warmed}, {"nothing", nothing}}) {
    std::fputs(firmware::controller::line(what, (*histograms)[kind]).c_str(), stdout);
  }
  std::uint64_t beyond = 0;
  (*histograms)[nothing].for_each_class([&](std::uint64_t longest, std::uint64_t spans) {
    if (longest >= 5000) beyond += spans;
  });
  std::printf("  nothing took 5 us or longer: %llu of %llu\n", static_cast<unsigned long long>(beyond),
              static_cast<unsigned long long>((*histograms)[nothing].count()));
  return (*memory)[0] == 42.0 ? 1 : 0;  // the work has a result
}
