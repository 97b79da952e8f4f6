// Hours of healthy rigs, and faults of many sizes: how often a diagnosis while the rig runs names what is not there, how
// soon it names what is, and what it costs.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#include "host_sim/live/thresholds.hpp"
#include "tests/live/changing_rig.hpp"

namespace {

using host_sim::live::Finding;
using Rig = model::RigParameters<double>;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void print(const std::vector<Finding>& findings) {
  for (const Finding& f : findings) {
    std::printf("    %6.2f s (%.2f s later, share %.2f) %s\n", f.named_at, f.named_at - f.since, f.share,
                sentence(f).c_str());
  }
}

struct Rigs {
  const char* name;
  firmware::RigDescription (*rig)();
};
constexpr Rigs rigs[] = {{"quarter_car", sample::quarter_car},
                         {"hil", sample::hil},
                         {"bench", sample::component_bench},
                         {"quarter_car_fdva", sample::quarter_car_fdva},
                         {"hil_fdva", sample::hil_fdva}};
constexpr std::size_t rig_count = sizeof rigs / sizeof rigs[0];

/// What a real rig has: a model that is a little wrong all the time.
void a_little_wrong(Rig& rig) {
  rig.suspension.stiffness *= 1.02;
  rig.effects.add<model::CoulombFriction>({10.0});
}

struct Fault {
  const char* text;
  bool car, machine;
  void (*change)(Rig&);
};
const Fault faults[] = {
    {"friction 60 N", true, true, [](Rig& r) { r.effects.add<model::CoulombFriction>({60.0}); }},
    {"friction 20 N", true, true, [](Rig& r) { r.effects.add<model::CoulombFriction>({20.0}); }},
    {"delay +3 ms", false, true,
     [](Rig& r) {
       const auto& slot = r.effects.get<model::ActuatorDelay>();
       r.effects.add<model::ActuatorDelay>({(slot.active ? slot.effect.delay : 0.0) + 0.003});
     }},
    {"damping -20 %", true, false, [](Rig& r) { r.suspension.damping *= 0.8; }},
    {"gain zdd_b 1.1", true, false, [](Rig& r) { r.effects.add<model::SensorGain>(model::Channel::zdd_b, {1.1}); }},
    {"offset zdd_b 0.3", true, false, [](Rig& r) { r.effects.add<model::SensorOffset>(model::Channel::zdd_b, {0.3}); }},
    {"gain z_r 1.1", true, false, [](Rig& r) { r.effects.add<model::SensorGain>(model::Channel::z_r, {1.1}); }},
    {"delay F_w 3 ms", true, false, [](Rig& r) { r.effects.add<model::SensorDelay>(model::Channel::F_w, {0.003}); }},
    {"gain F 1.1", false, true, [](Rig& r) { r.effects.add<model::SensorGain>(model::Channel::F, {1.1}); }},
    {"offset F 60 N", false, true, [](Rig& r) { r.effects.add<model::SensorOffset>(model::Channel::F, {60.0}); }},
    {"delay x_act 3 ms", false, true,
     [](Rig& r) { r.effects.add<model::SensorDelay>(model::Channel::x_act, {0.003}); }},
};

void show_faults(std::uint64_t seed) {
  for (const Rigs& one : rigs) {
    const firmware::RigDescription rig = one.rig();
    const bool car = rig.rig.kind == model::RigKind::quarter_car;
    for (const Fault& fault : faults) {
      if (!(car ? fault.car : fault.machine)) continue;
      std::printf("%s, %s from 45 s on\n", one.name, fault.text);
      sample::Run run;
      run.seed = seed;
      run.duration = 55.0;
      run.change = fault.change;
      print(sample::diagnosed(rig, run));
    }
  }
}

/// Sensors that fail in the samples themselves.
void show_readings(std::uint64_t seed) {
  using model::Channel;
  for (const Rigs& one : rigs) {
    const firmware::RigDescription rig = one.rig();
    const bool car = rig.rig.kind == model::RigKind::quarter_car;
    for (const bool stuck : {true, false}) {
      for (const Channel channel : car ? std::vector{Channel::zdd_b, Channel::z_r} : std::vector{Channel::F}) {
        std::printf("%s, %s %s from 45 s on\n", one.name, stuck ? "stuck" : "lost",
                    std::string(model::name(channel)).c_str());
        sample::Run run;
        run.seed = seed;
        run.duration = 55.0;
        run.reader = [=, value = std::nan("")](host_sim::live::LiveSample& sample) mutable {
          double& shown = sample.values[index(channel)];
          if (stuck && std::isnan(value)) value = shown;
          shown = value;
        };
        print(sample::diagnosed(rig, run));
      }
    }
  }
}

void count_false_names(double cpu_limit, std::uint64_t first_seed) {
  double watched = 0.0, driven = 0.0, in_engine = 0.0;
  std::size_t named = 0, unexplained = 0, passed = 0;
  const double begun = cpu_seconds();
  for (std::uint64_t seed = first_seed; cpu_seconds() - begun < cpu_limit; ++seed) {
    const Rigs& one = rigs[seed % rig_count];
    const firmware::RigDescription rig = one.rig();
    host_sim::live::LiveDiagnosis diagnosis(rig);
    sample::Run run;
    run.seed = seed;
    run.duration = 600.0;
    run.speed = 10.0 + 5.0 * static_cast<double>(seed % 7);
    const std::uint64_t variant = seed / rig_count % 3;  // right, right on a road that changes, wrong on such a road
    const double levels[] = {2.0, 0.5};
    if (variant > 0) run.level = levels[seed / (3 * rig_count) % 2];
    if (variant == 2) run.from_the_beginning = a_little_wrong;
    double cost = 0.0;
    double largest = 0.0, level = 0.0;
    sample::drive(rig, run, [&](const host_sim::live::LiveSample& s) {
      const auto at = std::chrono::steady_clock::now();
      static_cast<void>(diagnosis.push(s));
      cost += std::chrono::duration<double>(std::chrono::steady_clock::now() - at).count();
      const auto p = diagnosis.progress();
      largest = std::max(largest, p.largest);
      level = p.level;
    });
    watched += diagnosis.progress().watched;
    passed += diagnosis.progress().passed;
    driven += run.duration;
    in_engine += cost;
    for (const Finding& f : diagnosis.findings()) {
      if (f.kind == Finding::Kind::unexplained)
        ++unexplained;
      else
        ++named;
    }
    std::printf(
        "%s seed %lu variant %d: %.2f %% of a core, %zu candidates, largest %.2f of %.2f, in all %.2f h watched, %zu "
        "named, %zu unexplained, %zu passed\n",
        one.name, static_cast<unsigned long>(seed), static_cast<int>(variant), 100.0 * cost / run.duration,
        diagnosis.progress().candidates, largest, level, watched / 3600.0, named, unexplained, passed);
    print(diagnosis.findings());
    std::fflush(stdout);
  }
  std::printf("%.2f h watched, %zu false names; %.2f %% of a core\n", watched / 3600.0, named,
              100.0 * in_engine / driven);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "faults") == 0) {
    show_faults(std::strtoul(argv[2], nullptr, 10));
    show_readings(std::strtoul(argv[2], nullptr, 10));
    return 0;
  }
  if (argc == 4 && std::strcmp(argv[1], "healthy") == 0) {
    count_false_names(std::strtod(argv[2], nullptr), std::strtoul(argv[3], nullptr, 10));
    return 0;
  }
  std::fprintf(stderr, "rigtwin_live faults SEED | healthy CPU_SECONDS FIRST_SEED\n");
  return 2;
}
