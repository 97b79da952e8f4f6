#include <cstdio>
#include <chrono>
#include "host_sim/diagnose/diagnosis.hpp"
using namespace host_sim; using namespace host_sim::diagnose;
int main(int c, char** v) { if (c < 3) return 2;
  const RigDescription d = read_rig(v[1]);
  std::vector<Record> recs;
  for (int i = 2; i < c; ++i) recs.push_back({read_recording(v[i], d.channels, d.sample_rate), Use::shared});
  const auto t0 = std::chrono::steady_clock::now();
  const Diagnosis f = host_sim::diagnose::diagnose(d, std::move(recs));
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  std::printf("%s%s  chi %.4f %.4f %.4f  (%.2f s, %zu sims) %s\n", std::string(name(f.verdict)).c_str(), f.unexplained ? " +unexplained" : "", f.chi_squared_before, f.chi_squared_refit, f.chi_squared_after, s, f.simulations, f.rest.c_str());
  for (auto& e : f.effects) { std::printf("  %s %s conf %.4f", std::string(e.effect.entry->name).c_str(), e.effect.channel ? std::string(model::name(*e.effect.channel)).c_str() : "", e.confidence);
    for (auto& p : e.parameters) std::printf("  %.6g [%.6g %.6g]", p.value, p.lower, p.upper);
    std::printf("\n");
    for (auto& a : e.alternatives) std::printf("     vs %s %s %.3g %s\n", std::string(a.effect.entry->name).c_str(), a.effect.channel ? std::string(model::name(*a.effect.channel)).c_str() : "", a.odds_against, a.separate_by.c_str()); }
  for (auto& w : f.where) std::printf("  where %s %.3g-%.3g %s %.3f\n", std::string(model::name(w.channel)).c_str(), w.lowest, w.highest, w.subsystem.c_str(), w.share);
  for (auto& [ch, g] : f.gap) std::printf("  gap %s %.5f %.5f %.5f floor %.5f\n", std::string(model::name(ch)).c_str(), g.before, g.refit, g.after, g.noise_floor);
  for (auto& [p, g] : f.parameters) std::printf("  %s %.6g [%.6g %.6g]\n", p.c_str(), g.value, g.lower, g.upper);
}
