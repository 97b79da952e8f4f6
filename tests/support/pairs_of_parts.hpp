// Rigs of every kind with two parts each: what is right alone must be right together.
#pragma once

#include <array>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace support {

struct PartOfRig {
  std::string_view name, text;  ///< tables of a rig description
};

inline constexpr std::array parts_of_rigs{
    PartOfRig{"lever", "[lever]\nat = [-0.08, 0.0, 0.08]\nratio = [0.75, 0.8, 0.85]\n"},
    PartOfRig{"lever with a kink at rest", "[lever]\nat = [-0.08, 0.0, 0.08]\nratio = [0.68, 0.8, 0.8]\n"},
    PartOfRig{"air spring",
              "[suspension]\nstiffness = 0.0\n[air_spring]\npressure = 7e5\narea = 40.64e-4\nvolume = 0.588e-3\n"},
    PartOfRig{"air spring for a lever",
              "[suspension]\nstiffness = 0.0\n[air_spring]\npressure = 7e5\narea = 50.8e-4\nvolume = 0.735e-3\n"},
    PartOfRig{"air spring with skyhook",
              "[suspension]\nstiffness = 0.0\n[air_spring]\npressure = 7e5\narea = 40.64e-4\nvolume = "
              "0.588e-3\nskyhook = 1000.0\nactuator_damping = 0.7\n"},
    PartOfRig{"levelled air spring beside a spring",
              "[air_spring]\npressure = 7e5\narea = 10e-4\nvolume = 0.3e-3\nlevelling_rate = 0.1\n"},
    PartOfRig{"absorber",
              "[fdva]\npiston_area = 30e-4\nduct_diameter = 12e-3\nduct_length = 0.6361571127\noil_density = 860.0\n"
              "oil_viscosity = 32e-6\nminor_loss = 1.5\ncoupling_stiffness = 55e3\nducts = 6\nopen_ducts = 2\n"},
    PartOfRig{"locked absorber",
              "[fdva]\npiston_area = 30e-4\nduct_diameter = 12e-3\nduct_length = 0.6361571127\noil_density = 860.0\n"
              "oil_viscosity = 32e-6\nminor_loss = 1.5\ncoupling_stiffness = 55e3\nducts = 6\nopen_ducts = 0\n"},
    PartOfRig{"plan of ducts", "[valves]\nplan = [{ t = 0.5, open = 1 }, { t = 1.5, open = 4 }]\n"},
    PartOfRig{"rollout of ducts", "[estimator]\nkind = \"kalman\"\n[valves]\npolicy = \"rollout\"\n"},
    PartOfRig{"ducts by force and velocity", "[estimator]\nkind = \"kalman\"\n[valves]\npolicy = \"force_velocity\"\n"},
    PartOfRig{"filter", "[estimator]\nkind = \"kalman\"\n"},
    PartOfRig{"filter of late samples with a bias",
              "[estimator]\nkind = \"kalman\"\nsensors = [\"z_r\", \"zdd_w\", \"zdd_b\", \"dz_b\"]\nbias = "
              "[\"zdd_b\"]\nage = { dz_b = 0.005 }\n"},
    PartOfRig{"curve",
              "[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, -0.2, 0.0, 0.2, 1.0]\nvalue = "
              "[-500.0, -300.0, 0.0, 150.0, 250.0]\n"},
    PartOfRig{"gas damper",
              "[laws.gas]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 1.0]\nvalue = [-100.0, "
              "200.0, 350.0]\npreload = 200.0\n"},
    PartOfRig{"curve behind a mount",
              "[laws.soft]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 1.0]\nvalue = [-400.0, 0.0, "
              "400.0]\nbehind = 4.3e5\n"},
    PartOfRig{"stop",
              "[laws.stop]\nplace = \"suspension\"\nover = \"deflection\"\nat = [-0.04, -0.02, 0.0, 0.02, 0.04]\nvalue "
              "= [-900.0, 0.0, 0.0, 0.0, 900.0]\n"},
    PartOfRig{"surface",
              "[laws.surface]\nplace = \"suspension\"\nover = [\"deflection\", \"velocity\"]\nat = [-0.1, 0.1]\nat_2 = "
              "[-1.0, 0.0, 1.0]\nvalue = [[-200.0, 0.0, 300.0], [-400.0, 0.0, 500.0]]\n"},
    PartOfRig{"stack",
              "[laws.bush]\nplace = \"suspension\"\nbranches = [{ stiffness = 8e3, slip_force = 12.0 }, { stiffness = "
              "6e3, time_constant = 0.02 }]\n"},
    PartOfRig{"two Maxwell branches",
              "[laws.rubber]\nplace = \"suspension\"\nbranches = [{ stiffness = 8e3, time_constant = 0.2 }, { "
              "stiffness = 6e3, time_constant = 0.02 }]\n"},
    PartOfRig{"tyre law",
              "[laws.tread]\nplace = \"tyre\"\nover = \"deflection\"\nat = [-0.02, 0.0, 0.02]\nvalue = [-100.0, 0.0, "
              "180.0]\n"},
    PartOfRig{"curve of a sensor",
              "[laws.shown]\nplace = \"sensor F\"\nat = [-5000.0, 0.0, 5000.0]\nvalue = [-4900.0, 0.0, 5050.0]\n"},
    PartOfRig{"polynomial", "[compensation]\nkind = \"polynomial\"\n"},
    PartOfRig{"adaptive time series", "[compensation]\nkind = \"adaptive_time_series\"\n"},
    PartOfRig{"smith", "[compensation]\nkind = \"smith\"\n"},
    PartOfRig{"feedforward and feedback", "[compensation]\nkind = \"feedforward_feedback\"\n"},
    PartOfRig{"adaptive virtual damping", "[compensation]\nkind = \"adaptive_virtual_damping\"\n"},
    PartOfRig{"delay", "[effects.actuator_delay]\ndelay = 0.006\n"},
    PartOfRig{"delay that varies", "[machine]\ndelay_swing = 1e-3\ndelay_jitter = 2e-4\n"},
    PartOfRig{"lag", "[effects.actuator_lag]\ntime_constant = 0.003\n"},
    PartOfRig{"resonance", "[effects.actuator_resonance]\nfrequency = 60.0\ndamping_ratio = 0.7\n"},
    PartOfRig{"rate limit", "[effects.actuator_rate_limit]\nvelocity = 0.8\n"},
    PartOfRig{"delay budget", "[delay_budget]\nsensor_age = 0.0005\ntransport = 0.0005\n"},
    PartOfRig{"friction", "[effects.coulomb_friction]\nforce = 30.0\n"},
    PartOfRig{"two slopes", "[effects.asymmetric_damper]\ndifference = 300.0\n"},
    PartOfRig{"quadratic damping", "[effects.quadratic_damping]\ncoefficient = 200.0\n"},
    PartOfRig{"hysteresis", "[effects.bouc_wen]\nstiffness = 8e3\nforce = 20.0\nunloading = 0.5\n"},
    PartOfRig{"free play", "[effects.backlash]\ngap = 5e-4\n"},
    PartOfRig{"top mount", "[effects.top_mount]\nstiffness = 4e5\n"},
    PartOfRig{"relaxation", "[effects.relaxation]\nstiffness = 8e3\ntime_constant = 0.02\n"},
    PartOfRig{"bump stop", "[effects.bump_stop]\nclearance = 0.02\nstiffness = 1e5\n"},
    PartOfRig{"seal friction", "[effects.seal_friction]\nforce = 10.0\n"},
    PartOfRig{"guide", "[effects.body_guide_friction]\nforce = 10.0\n[effects.wheel_guide_damping]\ndamping = 50.0\n"},
    PartOfRig{"tyre", "[effects.tyre_lift_off]\n[effects.progressive_tyre]\ncubic_stiffness = 1e9\n"},
    PartOfRig{"mass at a sensor", "[effects.force_sensor_inertia]\nmass = 3.0\n"},
    PartOfRig{"moving mass", "[effects.moving_mass]\nmass = 2.0\n"},
    PartOfRig{"lag and gain of F",
              "[effects.sensor_lag.F]\ntime_constant = 0.001\n[effects.sensor_gain.F]\ngain = 1.02\n"},
    PartOfRig{"delay of F", "[effects.sensor_delay.F]\ndelay = 0.0012\n"},
    PartOfRig{"hold", "[effects.sensor_hold.dz_b]\nperiod = 0.004\n"},
    PartOfRig{"filter of the recorder",
              "[recording]\ncommon_filter = [{ channels = [\"F\", \"x_act\"], corner_hz = 150.0, order = 2 }]\n"},
};

/// One rig, and how it is called where a test fails.
struct RigOfParts {
  std::string kind, name, text;
};

/// The tables of several texts as one: a key that stands twice in a table is that of the last text.
class Tables {
 public:
  void add(std::string_view text) {
    std::string table;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('[')) {
        table = line;
        static_cast<void>(tables_[table]);
      } else if (!line.empty()) {
        tables_[table][line.substr(0, line.find(' '))] = line;
      }
    }
  }
  [[nodiscard]] std::string text() const {  // the lines before any table come first, because "" is least
    std::string all;
    for (const auto& [table, keys] : tables_) {
      if (!table.empty()) all += table + '\n';
      for (const auto& [key, line] : keys) all += line + '\n';
    }
    return all;
  }

 private:
  std::map<std::string, std::map<std::string, std::string>> tables_;
};

/// `kind`: as in a description, or "driven mass".
inline RigOfParts rig_of_parts(std::string_view kind, std::size_t a, std::size_t b) {
  const bool driven = kind == "driven mass", car = kind == "quarter_car" || kind == "hil";
  Tables tables;
  tables.add("kind = \"" + std::string(driven ? "component_bench" : kind) + "\"\nsample_rate = 1000.0\n" +
             (driven ? "driven_by = \"force\"\n" : "") +
             "[suspension]\nstiffness = 31500.0\ndamping = 1140.0\n[limits]\nspeed = 1.5\n");
  if (car || driven) tables.add("[body]\nmass = 290.0\n");
  if (car) tables.add("[wheel]\nmass = 40.0\n[tyre]\nstiffness = 200e3\ndamping = 100.0\n");
  if (kind == "quarter_car") {
    tables.add("[noise]\nz_r = 2e-5\nzdd_r = 0.05\nzdd_w = 0.05\nzdd_b = 0.05\nF_w = 10.0\ndz_w = 5e-5\ndz_b = 5e-5\n");
  } else {
    tables.add(driven ? "[noise]\nx_act = 2e-5\nzdd_b = 0.05\n" : "[noise]\nF = 10.0\nx_act = 2e-5\n");
  }
  if (kind == "hil") tables.add("[machine]\nvirtual_damping = 1140.0\n");
  RigOfParts rig{std::string(kind), std::string(kind), ""};
  for (const std::size_t i : {a, b}) {
    tables.add(parts_of_rigs[i].text);
    rig.name += " + " + std::string(parts_of_rigs[i].name);
  }
  rig.text = tables.text();
  return rig;
}

/// All pairs of parts in all kinds of rig, in an order that looks drawn.
inline std::vector<RigOfParts> all_rigs_of_parts(unsigned seed) {
  std::vector<RigOfParts> rigs;
  for (const std::string_view kind : {"quarter_car", "hil", "component_bench", "driven mass"}) {
    for (std::size_t a = 0; a < parts_of_rigs.size(); ++a) {
      for (std::size_t b = a + 1; b < parts_of_rigs.size(); ++b) rigs.push_back(rig_of_parts(kind, a, b));
    }
  }
  std::mt19937 random(seed);
  for (std::size_t i = rigs.size(); i > 1; --i) std::swap(rigs[i - 1], rigs[random() % i]);
  return rigs;
}

}  // namespace support
