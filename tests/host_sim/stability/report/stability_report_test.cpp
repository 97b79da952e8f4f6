// The page of rigtwin stability --report.
#include "host_sim/stability/report/stability_report.hpp"

#include <optional>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/commands/command_line.hpp"
#include "host_sim/stability/report/figures.hpp"
#include "tests/host_sim/stability/rigs.hpp"
#include "tests/support/program.hpp"
#include "tests/support/report_page.hpp"

namespace {

using namespace host_sim::stability;
using firmware::RigDescription;
using stability_tests::described;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;

std::string page_of(const RigDescription& description) {
  const StabilityAnalysis analysis = analyse(description);
  const std::vector<PoleSweep> sweeps;
  const std::optional<StabilityMap> map;
  return stability_report({description, analysis, sweeps, map}).html();
}

// Journey. From the shell to the page: the verdict before everything else, the rig description behind it.
TEST(StabilityReport, SaysTheVerdictFirst) {
  const support::TemporaryFolder folder;
  const std::string rig = RIGTWIN_SOURCE_DIR "/host_sim/rigs/paper_hil_fdva.toml",
                    file = (folder / "page.html").string();
  const auto ended =
      support::rigtwin({"stability", "--rig", rig, "--report", file, "--sweep", "virtual_damping=0:2000:21", "--map",
                        "tau=0:0.03:20,virtual_damping=0:2000:20", "--amplitude", "0.02"});
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const std::string html = support::TemporaryFolder::read(file);
  support::expect_sound(html, 13);
  const auto verdict = html.find(
      "<div class=\"verdict good\"><b>✓</b>The loop is stable, 2.249 ms of delay left as sampled at 1000 Hz "
      "(2.746 ms without sampling and hold).</div>");
  EXPECT_LT(verdict, html.find("<h2"));
  EXPECT_LT(html.find("critical delay 12.7455 ms at 12.99 Hz"), html.find("<h2"));
  EXPECT_LT(html.find("critical virtual damping 908.04 N s/m at 13.4 Hz"), html.find("<h2"));
  EXPECT_NE(html.find("virtual_damping = 1140.0"), std::string::npos);
  EXPECT_EQ(folder.count(), 1U);
}

// Point. What is unstable says so, and at which frequency.
TEST(StabilityReport, CallsAnUnstableLoopUnstable) {
  const std::string html = page_of(described(fdva_rig(0.010, 700.0)));
  EXPECT_NE(html.find("<div class=\"verdict bad\"><b>✗</b>The loop is unstable at 13."), std::string::npos);
  EXPECT_NE(html.find("doubles in 0.32 s"), std::string::npos);  // ln 2/2.1685
  EXPECT_NE(html.find("so unstable roots of the closed loop: 2."), std::string::npos);
  EXPECT_EQ(html.find("verdict good"), std::string::npos);  // the sampled loop is unstable, too
}

// Law. Whatever hil rig: every figure is whole. Rigs without delay, with lags, with a locked piston, with a delay that
// the model's line cannot hold are among them.
TEST(StabilityReport, IsWholeForAnyRig) {
  const auto sound = [](const RigDescription& description) { support::expect_sound(page_of(description)); };
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    sound(described(stability_tests::random_rig(seed, true)));
  }
  sound(described(linear_rig(0.0)));
  sound(described(linear_rig(0.0, 5000.0)));
  auto locked = fdva_rig();
  locked.fdva.open_ducts = 0;
  sound(described(locked));
  RigDescription budget = described(linear_rig());
  budget.delay_budget.transport = 0.5;
  const std::string html = page_of(budget);
  support::expect_sound(html);
  EXPECT_NE(html.find("exceeds the model&#39;s delay line"), std::string::npos);
}

// Point. The border in the map is the exact one: it passes the critical damping at the rig's delay.
TEST(StabilityReport, DrawsTheExactBorder) {
  const RigDescription description = described(fdva_rig());
  const StabilityMap map =
      stability_map(LoopFamily(description.rig, 0.0), {"tau", 0.0, 0.03, 13}, {"virtual_damping", 0.0, 2000.0, 13}, 1);
  const auto figure = map_figure(map, description, 0.010);
  const auto& border = figure.panels.at(0).curves.at(0);
  EXPECT_EQ(border.name, "stability border, exact");
  std::optional<double> at_10_ms;
  for (std::size_t i = 1; i < border.x.size(); ++i) {
    const double x0 = border.x[i - 1], x1 = border.x[i];
    if (!((x0 - 10.0) * (x1 - 10.0) <= 0.0) || x0 == x1) continue;
    at_10_ms = border.y[i - 1] + (10.0 - x0) / (x1 - x0) * (border.y[i] - border.y[i - 1]);
  }
  ASSERT_TRUE(at_10_ms);
  EXPECT_NEAR(*at_10_ms, 908.04, 2.0);  // straight between points of the curve, which are some 10 N s/m apart
  const auto& here = figure.panels.at(0).curves.back();
  EXPECT_EQ(here.x.at(0), 10.0);
  EXPECT_EQ(here.y.at(0), 1140.0);
}

// Point. Bode in degrees; Nyquist with its mirror image, −1 and the unit circle in sight.
TEST(StabilityReport, DrawsTheLoop) {
  const StabilityAnalysis a = analyse(described(fdva_rig()));
  const BodeData data = bode(a.rig, a.delay, a.machine_delay, {1.0, 10.0});
  const auto figure = bode_figure("Bode", "L", data.frequency_hz, std::vector<NamedResponse>{{"L", &data.loop, 0}});
  EXPECT_EQ(figure.panels[0].curves[0].y, data.loop.magnitude);
  EXPECT_NEAR(figure.panels[1].curves[0].y[1], data.loop.phase[1] * 57.29577951308232, 1e-9);

  const NyquistData plane = nyquist(a.equation(), a.roots.roots);
  const auto nyquist_plot = nyquist_figure("Nyquist", std::vector<NamedLoop>{{"L", &plane}});
  EXPECT_TRUE(nyquist_plot.equal_axes);
  const auto& curves = nyquist_plot.panels[0].curves;
  ASSERT_EQ(curves.size(), 4U);
  for (std::size_t i = 0; i < curves[0].x.size(); ++i)
    EXPECT_NEAR(std::hypot(curves[0].x[i], curves[0].y[i]), 1.0, 1e-12);
  for (std::size_t i = 0; i < curves[1].y.size(); ++i) EXPECT_EQ(curves[1].y[i], -curves[2].y[i]);
  EXPECT_EQ(curves[3].x, std::vector<double>{-1.0});
  EXPECT_LT(nyquist_plot.x.range->first, -1.0);
  EXPECT_GT(nyquist_plot.x.range->second, 1.0);
  // Fine enough to be drawn: from point to point L turns by a hundredth of a turn at most, but for its ends.
  for (std::size_t i = 2; i + 1 < plane.loop.size(); ++i) {
    EXPECT_LT(std::abs(std::arg(plane.loop[i] * std::conj(plane.loop[i - 1]))), 0.063);
  }
}

// Law. A path followed through a sweep is one root: it moves little from value to value and passes the known poles.
TEST(StabilityReport, FollowsOneRoot) {
  const PoleSweep sweep = pole_sweep(LoopFamily(linear_rig(), 0.0), {"virtual_damping", 0.0, 700.0, 71}, -80.0);
  const auto path = followed(sweep, 0, {-9.3847, 87.3599});
  EXPECT_NEAR(path.front().real(), -9.3847, 1e-4);
  EXPECT_NEAR(path.back().real(), -22.3409, 1e-4);
  EXPECT_NEAR(path.back().imag(), 86.8166, 1e-4);
  const auto back = followed(sweep, 70, path.back());
  EXPECT_EQ(back, path);
}

// Fault. A page that cannot be written is an OutputError, and nothing is left behind.
TEST(StabilityReport, TellsWhenThePageCannotBeWritten) {
  const support::TemporaryFolder folder;
  const std::string rig = RIGTWIN_SOURCE_DIR "/host_sim/rigs/paper_linear.toml";
  for (const std::string& file : {(folder / "no/such/page.html").string(), std::string("/dev/full")}) {
    const auto ended = support::rigtwin({"stability", "--rig", rig, "--report", file});
    EXPECT_EQ(ended.status, static_cast<int>(firmware::ExitStatus::cannot_write)) << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_EQ(ended.output, "");
  }
  const std::string same = (folder / "same").string();
  const auto ended = support::rigtwin({"stability", "--rig", rig, "--report", same, "--json", same});
  EXPECT_EQ(ended.status, static_cast<int>(firmware::ExitStatus::wrong_usage)) << ended.errors;
  EXPECT_EQ(folder.count(), 0U);
}

}  // namespace
