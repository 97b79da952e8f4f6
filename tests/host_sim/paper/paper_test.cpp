// rigtwin paper: experiments, statements, page, command.
#include <algorithm>
#include <numbers>
#include <random>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/paper/paper_report.hpp"
#include "tests/support/program.hpp"
#include "tests/support/report_page.hpp"

namespace {

using namespace host_sim::paper;

constexpr double turn = 2.0 * std::numbers::pi;

const Experiments& experiments() {
  static const Experiments made = experiment();
  return made;
}

Statement find(const Experiments& e, const std::string& id) {
  for (const Statement& s : statements(e)) {
    if (s.id == id) return s;
  }
  ADD_FAILURE() << id;
  return {};
}

bool mentions(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

// Point, (1) and (2). Half the input, three samples late: H = ½ e^{−3jω/f_s}. A segment of N misses 3 of its N samples
// of the other, which is a relative error of the order 3/N.
TEST(TransferEstimate, FindsAGainAndADelay) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> input(40'000), output(40'000);
  for (double& v : input) v = normal(random);
  for (std::size_t i = 3; i < output.size(); ++i) output[i] = 0.5 * input[i - 3];
  const TransferEstimate h = transfer_estimate(input, output, 1000.0, 2000, 1.0, 100.0, 30);
  ASSERT_GT(h.frequency.size(), 20U);
  EXPECT_EQ(h.averages, 39U);
  for (std::size_t i = 0; i < h.frequency.size(); ++i) {
    const auto expected = std::polar(0.5, -turn * h.frequency[i] * 0.003);
    EXPECT_NEAR(std::abs(h.response[i] - expected), 0.0, 0.5 * 3.0 / 2000.0 * 5.0) << h.frequency[i];
    EXPECT_NEAR(h.coherence[i], 1.0, 0.01);
  }
}

// Point. Noise that the input does not know takes coherence away: equal powers leave one half.
TEST(TransferEstimate, SeesWhatDoesNotBelongTogether) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  std::vector<double> input(200'000), output(200'000);
  for (std::size_t i = 0; i < input.size(); ++i) {
    input[i] = normal(random);
    output[i] = input[i] + normal(random);
  }
  const TransferEstimate h = transfer_estimate(input, output, 1000.0, 500, 10.0, 400.0, 40);
  double mean = 0.0;
  for (const double c : h.coherence) mean += c / static_cast<double>(h.coherence.size());
  EXPECT_NEAR(mean, 0.5, 0.02);  // some 600 averages: each ± 0.03, their mean ± 0.005
}

// Point. e^{σt} sin ωt with windows of whole periods grows with σ.
TEST(GrowthRate, IsThatOfAnExponential) {
  for (const double sigma : {-8.0, 2.5}) {
    std::vector<double> signal(1000);
    for (std::size_t i = 0; i < signal.size(); ++i) {
      const double t = static_cast<double>(i) / 1000.0;
      signal[i] = std::exp(sigma * t) * std::sin(turn * 10.0 * t);
    }
    EXPECT_NEAR(growth_rate(signal, 1000.0, 200), sigma, 1e-9);
  }
}

// Golden. The numbers of the references, in the sentences of the page.
TEST(Paper, SaysTheNumbersOfTheReferences) {
  const Experiments& e = experiments();
  const Statement table_1 = find(e, "table_1_unstable");
  EXPECT_FALSE(table_1.agrees);
  EXPECT_TRUE(mentions(table_1.finding, "Stable at 10 ms")) << table_1.finding;
  EXPECT_TRUE(mentions(table_1.finding, "critical delay 15.2536 ms")) << table_1.finding;
  EXPECT_TRUE(mentions(table_1.finding, "−9.3847 ± 87.36j")) << table_1.finding;
  const Statement at_1140 = find(e, "absorber_stable_at_1140");
  EXPECT_TRUE(at_1140.agrees);
  EXPECT_TRUE(mentions(at_1140.finding, "−2.3945 ± 83.902j 1/s (13.35 Hz)")) << at_1140.finding;
  const Statement at_700 = find(e, "absorber_unstable_at_700");
  EXPECT_TRUE(at_700.agrees);
  EXPECT_TRUE(mentions(at_700.finding, "2.1685 ± 84.375j 1/s (13.43 Hz)")) << at_700.finding;
  const Statement between = find(e, "critical_damping_between");
  EXPECT_TRUE(between.agrees);
  EXPECT_NEAR(between.computed, 908.04, 0.005);
  const Statement load = find(e, "wheel_load_400_percent");
  EXPECT_TRUE(load.agrees);
  EXPECT_TRUE(mentions(load.finding, "it is 4.73 times")) << load.finding;
  EXPECT_TRUE(find(e, "at_13_hz").agrees);
  EXPECT_NEAR(find(e, "two_ducts_8_hz").computed, 8.0, 1e-6);
  EXPECT_TRUE(find(e, "force_sensor_wrong").agrees);
  EXPECT_TRUE(find(e, "soft_sensor_right").agrees);
}

// Law. Agreement is decided by the number, whatever the number is.
TEST(Paper, DecidesByTheNumbers) {
  Experiments e = experiments();
  e.growth.ratio_at_peak = 4.9;
  e.growth.peak_hz = 14.0;
  e.absorber_hz = 8.6;
  e.absorber.analysis.critical_damping->value = 1200.0;
  e.linear.analysis.stable = false;
  e.absorber.analysis.stable = false;
  e.absorber_at_700.analysis.stable = true;
  e.rig_run.second = e.rig_run.wheel_load;
  for (const Statement& s : statements(e)) {
    EXPECT_EQ(s.agrees, s.id == "table_1_unstable" || s.id == "force_sensor_wrong") << s.id;
  }
  e.rig_run.wheel_load = e.simulated_run.wheel_load;
  EXPECT_FALSE(find(e, "force_sensor_wrong").agrees);
  e.absorber.analysis.critical_damping.reset();
  EXPECT_FALSE(find(e, "critical_damping_between").agrees);
  EXPECT_TRUE(
      mentions(paper_report(e, statements(e)).html(), "Does not agree. The paper: That difference lies at 13 Hz."));
}

// Journey. The nonlinear loop in time says what the linear one does: signs of all three, and the rate of the sampled
// loop's wheel root. The kick is small, but the ducts' square losses are not nothing: 5 %.
TEST(Paper, TimeSimulationsConfirmTheVerdicts) {
  const auto& kicks = experiments().kicks;
  ASSERT_EQ(kicks.size(), 3U);
  for (const KickedRun& run : kicks) EXPECT_NEAR(run.measured / run.predicted, 1.0, 0.05) << run.name;
  EXPECT_LT(kicks[0].measured, 0.0);
  EXPECT_LT(kicks[1].measured, 0.0);
  EXPECT_GT(kicks[2].measured, 0.0);
  EXPECT_EQ(kicks[0].trip.reason, firmware::Reason::reference_ended);
  EXPECT_EQ(kicks[1].trip.reason, firmware::Reason::reference_ended);
  EXPECT_TRUE(firmware::is_fault(kicks[2].trip.reason));  // it grows into a limit of the test machine
  EXPECT_TRUE(mentions(in_words(kicks[2]), "until the firmware stops it"));
}

// Golden. The runs over a road lie on the linear responses where the absorber hardly moves; the force sensor's error is
// that of its mass: measured ÷ true = |1 − mω² z_r/F_w|.
TEST(Paper, EstimatesAgreeWithTheLinearResponses) {
  const Experiments& e = experiments();
  const auto linear = [&](const host_sim::stability::BodeData& data, double hz) {
    const auto curve =
        std::find_if(data.outputs.begin(), data.outputs.end(), [](const auto& c) { return c.name == "F_w"; });
    const auto above =
        std::lower_bound(data.frequency_hz.begin(), data.frequency_hz.end(), hz) - data.frequency_hz.begin();
    return std::polar(curve->magnitude[static_cast<std::size_t>(above)], curve->phase[static_cast<std::size_t>(above)]);
  };
  const auto& h = e.late_run.wheel_load;
  for (std::size_t i = 0; i < h.frequency.size(); ++i) {
    if (h.frequency[i] < 18.0) continue;  // neighbours in the grid of 500 are 1 % apart
    EXPECT_NEAR(std::abs(h.response[i]) / std::abs(linear(e.late, h.frequency[i])), 1.0, 0.03) << h.frequency[i];
    const double omega = turn * h.frequency[i];
    const double ratio = std::abs(e.rig_run.wheel_load.response[i] / e.simulated_run.wheel_load.response[i]);
    EXPECT_NEAR(ratio, std::abs(1.0 - 5.0 * omega * omega / linear(e.quarter_car_true, h.frequency[i])), 0.03);
  }
}

// Law. The page is whole, says first how much agrees, and holds the rigs it was made from.
TEST(Paper, PageIsWhole) {
  const Experiments& e = experiments();
  const std::string html = paper_report(e, statements(e)).html();
  support::expect_sound(html, 10);
  EXPECT_LT(html.find("8 of the 9 checked statements of the paper"), html.find("<h2"));
  for (const char* figure :
       {"Fig. 2 — ", "Fig. 3a — ", "Fig. 3b — ", "Fig. 4 — Bode", "Fig. 4 — Nyquist", "Fig. 6 — "}) {
    EXPECT_NE(html.find(figure), std::string::npos) << figure;
  }
  for (const char* words :
       {"force sensor that carries 5 kg", "Equations (1)-(3) of the paper", "Stable at this virtual damping"}) {
    EXPECT_NE(html.find(words), std::string::npos) << words;
  }
  for (const KickedRun& run : e.kicks) EXPECT_NE(html.find(in_words(run)), std::string::npos);
}

// Law. In Fig. 6 the dotted line, computed, passes through the points, measured: above 12 Hz within 3 %.
TEST(Paper, ShowsWhyTheForceSensorIsWrong) {
  const Experiments& e = experiments();
  const auto figures = support::figures_of(paper_report(e, statements(e)).html());
  const auto& data = figures.back()["data"];
  const auto trace = [&](const std::string& name, const std::string& axis) {
    return *std::find_if(data.begin(), data.end(), [&](const auto& t) {
      return t["name"].template get<std::string>().starts_with(name) && t["yaxis"] == axis;
    });
  };
  const auto points = trace("force sensor", "y2"), line = trace("expected", "y2");
  const auto hz = line["x"].get<std::vector<double>>();
  int compared = 0;
  for (std::size_t i = 0; i < points["x"].size(); ++i) {
    const double f = points["x"][i];
    if (f < 12.0) continue;
    const auto above = static_cast<std::size_t>(std::lower_bound(hz.begin(), hz.end(), f) - hz.begin());
    EXPECT_NEAR(points["y"][i].get<double>(), line["y"][above].get<double>(), 0.03) << f;
    ++compared;
  }
  EXPECT_GT(compared, 8);
}

// Journey. A folder that is not there yet is made; what stands in one stays.
TEST(PaperCommand, WritesItsFilesBesideOthers) {
  const support::TemporaryFolder folder;
  const auto out = folder / "new/results";
  ASSERT_EQ(support::rigtwin({"paper", "--out", out.string()}).status, 0);
  const std::string first = support::TemporaryFolder::read(out / "report.html");
  const auto json = nlohmann::json::parse(support::TemporaryFolder::read(out / "paper.json"));
  EXPECT_EQ(json["agreeing"], 8);
  EXPECT_EQ(json["statements"].size(), 9U);
  EXPECT_EQ(json["kicks"][2]["ended"], "speed");
  folder.write("new/results/notes.txt", "mine");
  const auto again = support::rigtwin({"paper", "--out", out.string()});
  EXPECT_EQ(again.status, 0) << again.errors;
  EXPECT_TRUE(mentions(again.output, "does not agree Eqs. (1)–(3) with Table 1 are unstable")) << again.output;
  EXPECT_EQ(support::TemporaryFolder::read(out / "notes.txt"), "mine");
  EXPECT_EQ(support::TemporaryFolder::read(out / "report.html"), first);  // the same bytes each time
}

// Fault. One line, the right exit status, before the work begins where that can be known.
TEST(PaperCommand, RefusesInOneLine) {
  const support::TemporaryFolder folder;
  const std::string file = folder.write("file", "mine").string();
  std::filesystem::create_directory(folder / "full");
  std::filesystem::create_symlink("/dev/full", folder / "full/report.html");
  struct Case {
    std::vector<std::string> arguments;
    firmware::ExitStatus status;
    std::string says;
  };
  using firmware::ExitStatus;
  const std::vector<Case> cases{{{}, ExitStatus::wrong_usage, "--out is required"},
                                {{"--out", ""}, ExitStatus::cannot_write, "a folder"},
                                {{"--out", file}, ExitStatus::cannot_write, "is a file"},
                                {{"--out", file + "/below"}, ExitStatus::cannot_write, "cannot be created"},
                                {{"--out", "/proc/rigtwin"}, ExitStatus::cannot_write, "cannot be created"},
                                {{"--out", (folder / "full").string()}, ExitStatus::cannot_write, "No space left"}};
  for (const Case& c : cases) {
    std::vector<std::string> arguments{"paper"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const auto ended = support::rigtwin(arguments);
    EXPECT_EQ(ended.status, static_cast<int>(c.status)) << ended.errors;
    EXPECT_TRUE(mentions(ended.errors, c.says)) << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_EQ(ended.output, "");
  }
  EXPECT_EQ(support::TemporaryFolder::read(file), "mine");
}

}  // namespace
