#include "host_sim/report/report.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

#include "firmware/description/version.hpp"
#include "host_sim/report/embedded_files.hpp"
#include "tests/support/report_page.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace host_sim::report;

Figure small_figure() {
  Figure figure{"a curve", "its note", {"time", "s"}};
  Panel panel{{"force", "N"}};
  panel.curves.push_back({"measured", {0.0, 1.0, 2.0}, {1.0, 4.0, 2.0}});
  figure.panels = {panel};
  return figure;
}

// Law. A report opens alone: program, figures, style and version are in it, and nothing is asked for from elsewhere.
TEST(Report, IsOneFileWithEverythingInIt) {
  Report page("a title", "a lead");
  page.add_section("first");
  page.add_figure(small_figure());
  page.add_figure(small_figure());
  const std::string html = page.html();
  support::expect_sound(html, 2);
  EXPECT_NE(html.find("plotly.js (cartesian - minified)"), std::string::npos);
  EXPECT_NE(html.find("Permission is hereby granted, free of charge"), std::string::npos);  // Plotly's licence
  EXPECT_NE(html.find("rigtwin " + std::string(firmware::version)), std::string::npos);
  EXPECT_NE(html.find("href=\"#section-1\""), std::string::npos);
  EXPECT_NE(html.find("<h2 id=\"section-1\">first</h2>"), std::string::npos);
}

// Law. A page without figures carries no megabyte that draws none.
TEST(Report, IsSmallWithoutFigures) {
  Report page("a title");
  page.add_text("some words");
  EXPECT_LT(page.html().size(), 10'000U);
}

// Law. The same parts give the same bytes: no date, no address in memory.
TEST(Report, IsTheSameEachTime) {
  const auto make = [] {
    Report page("a title", "a lead");
    page.add_figure(small_figure());
    page.add_table({"numbers", {"name", "value"}, {{"mass", "290"}}});
    return page.html();
  };
  EXPECT_EQ(make(), make());
}

// A page says how it was made, in its footer and once; what a user typed is shown, never obeyed.
TEST(Report, SaysHowItWasMade) {
  Report page("a title");
  page.add_text("some words");
  const std::string html = with_origin(page.html(), {"rigtwin plan --rig '<b>.toml'", {{"<b>.toml", "0123abcd"}}});
  EXPECT_NE(html.find("<h2>How this page was made</h2>"), std::string::npos);
  EXPECT_NE(html.find("$ rigtwin plan --rig &#39;&lt;b&gt;.toml&#39;\n\n0123abcd  &lt;b&gt;.toml"), std::string::npos)
      << html;
  EXPECT_NE(html.find("rigtwin " + std::string(firmware::version) + "\n$ "), std::string::npos);
  EXPECT_GT(html.find("How this page was made"), html.find("<footer>"));
  EXPECT_THROW((void)with_origin(html, {"again"}), std::logic_error);
  EXPECT_THROW((void)with_origin("no page", {"rigtwin"}), std::logic_error);
}

// Fault. Whatever stands in a file name or a rig description is shown, never obeyed.
TEST(Report, EscapesEverything) {
  const std::string evil = "</script><script>alert('x')</script><!-- & \" <b>";
  Report page(evil, evil);
  page.add_section(evil);
  page.add_text(evil);
  page.add_verdict(Verdict::bad, evil);
  page.add_table({evil, {evil, evil}, {{evil, evil}}});
  page.add_appendix(evil, evil);
  Figure figure = small_figure();
  figure.title = figure.note = figure.x.quantity = evil;
  figure.panels[0].curves[0].name = evil;
  figure.panels[0].guides.push_back({Guide::Along::x, 1.0, evil});
  page.add_figure(figure);
  const std::string html = page.html();
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
  EXPECT_NE(html.find("&lt;/script&gt;&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;&lt;!-- &amp; &quot; &lt;b&gt;"),
            std::string::npos);
  const auto figures = support::figures_of(html);  // the script elements end where they should
  ASSERT_EQ(figures.size(), 1U);
  const std::string name = figures[0]["data"][0]["name"];
  EXPECT_EQ(name, escaped(evil));  // Plotly reads tags in texts, too
  EXPECT_EQ(figures[0]["layout"]["annotations"][0]["text"], escaped(evil));
}

// Fault. What cannot be right is a mistake of the programmer, told when the part is added.
TEST(Report, RefusesWhatCannotBeRight) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(Figure&)>>> mistakes{
      {"has no unit", [](Figure& f) { f.x.unit = ""; }},
      {"has no unit", [](Figure& f) { f.panels[0].y.unit = ""; }},
      {"does not say what it shows", [](Figure& f) { f.panels[0].y.quantity = ""; }},
      {"has no title", [](Figure& f) { f.title = ""; }},
      {"nothing in it", [](Figure& f) { f.panels.clear(); }},
      {"nothing to see", [](Figure& f) { f.panels[0].curves.clear(); }},
      {"not as many x as y", [](Figure& f) { f.panels[0].curves[0].y.pop_back(); }},
      {"not as many further values", [](Figure& f) { f.panels[0].curves[0].along = {1.0}; }},
      {"no name or no unit",
       [](Figure& f) {
         f.panels[0].curves[0].along = {1.0, 2.0, 3.0};
       }},
      {"a curve has no name", [](Figure& f) { f.panels[0].curves[0].name = ""; }},
      {"coloured along nothing", [](Figure& f) { f.panels[0].curves[0].coloured_along = true; }},
      {"runs backwards",
       [](Figure& f) {
         f.x.range = {{2.0, 1.0}};
       }},
      {"runs backwards",
       [nan](Figure& f) {
         f.x.range = {{0.0, nan}};
       }},
      {"at or below zero",
       [](Figure& f) {
         f.x.logarithmic = true;
         f.x.range = {{0.0, 1.0}};
       }},
      {"not of names",
       [](Figure& f) {
         f.panels[0].bars.push_back({"", {"a"}, {1.0}});
       }},
      {"do not fill its plane",
       [](Figure& f) {
         f.panels[0].heat_map.push_back({"z", "1", {0, 1}, {0, 1}, {1, 2, 3}});
       }},
      {"without quantity or unit",
       [](Figure& f) {
         f.panels[0].heat_map.push_back({"z", "", {0}, {0}, {1}});
       }},
  };
  for (const auto& [says, mistake] : mistakes) {
    Figure figure = small_figure();
    mistake(figure);
    Report page("a title");
    try {
      page.add_figure(figure);
      ADD_FAILURE() << says;
    } catch (const std::logic_error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
    EXPECT_EQ(page.figures(), 0U);
  }
  Report page("a title");
  EXPECT_THROW(page.add_table({"", {"one", "two"}, {{"alone"}}}), std::logic_error);
  EXPECT_THROW(Report(""), std::logic_error);
}

// Point. What Plotly is told: panels above each other on one x axis, logarithms as exponents, gaps as null.
TEST(Report, TellsPlotlyWhatIsMeant) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  Figure figure{"Bode", {}, {"frequency", "Hz", true, false, {{0.1, 100.0}}}};
  figure.panels = {{{"magnitude", "N/m", true}, {{"G", {0.1, 1.0, 10.0}, {1.0, gap, 1.0 / 3.0}}}},
                   {{"phase", "°"}, {{"G", {1.0}, {-90.0}}}}};
  figure.panels[0].guides = {{Guide::Along::x, 10.0, "ten"}};
  Report page("a title");
  page.add_figure(figure);
  const auto json = support::figures_of(page.html()).at(0);
  EXPECT_EQ(json["layout"]["xaxis"]["type"], "log");
  EXPECT_EQ(json["layout"]["xaxis"]["range"], nlohmann::json({-1.0, 2.0}));
  EXPECT_EQ(json["layout"]["xaxis"]["title"]["text"], "frequency [Hz]");
  EXPECT_EQ(json["layout"]["yaxis"]["type"], "log");
  EXPECT_EQ(json["layout"]["yaxis2"]["type"], "linear");
  EXPECT_EQ(json["data"][1]["yaxis"], "y2");
  EXPECT_GT(json["layout"]["yaxis"]["domain"][0].get<double>(), json["layout"]["yaxis2"]["domain"][1].get<double>());
  EXPECT_EQ(json["layout"]["yaxis"]["domain"][1], 1.0);
  EXPECT_NEAR(json["layout"]["yaxis2"]["domain"][0].get<double>(), 0.0, 1e-12);
  EXPECT_TRUE(json["data"][0]["y"][1].is_null());
  EXPECT_NEAR(json["data"][0]["y"][2].get<double>(), 1.0 / 3.0, 0.5e-6);  // six digits
  EXPECT_EQ(json["layout"]["shapes"][0]["x0"], 10.0);                     // shapes in values, annotations in exponents
  EXPECT_EQ(json["layout"]["annotations"][0]["x"], 1.0);
}

// Point. Equal axes: a circle is round.
TEST(Report, KeepsEqualAxesEqual) {
  Figure figure = small_figure();
  EXPECT_FALSE(support::figures_of([&] {
                 Report page("t");
                 page.add_figure(figure);
                 return page.html();
               }())[0]["layout"]["yaxis"]
                   .contains("scaleanchor"));
  figure.equal_axes = true;
  Report page("t");
  page.add_figure(figure);
  const auto layout = support::figures_of(page.html()).at(0)["layout"];
  EXPECT_EQ(layout["yaxis"]["scaleanchor"], "x");
  EXPECT_EQ(layout["yaxis"]["scaleratio"], 1);
}

// Law. Who sees no colours tells the first four curves apart by their dashes, and the next by colour and dash together.
TEST(Report, TellsCurvesApartByMoreThanColour) {
  Figure figure = small_figure();
  figure.panels[0].curves.resize(7, figure.panels[0].curves[0]);
  Report page("t");
  page.add_figure(figure);
  const auto data = support::figures_of(page.html()).at(0)["data"];
  std::set<std::string> dashes, colours_seen;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i < 4) dashes.insert(data[i]["line"]["dash"].get<std::string>());
    colours_seen.insert(data[i]["line"]["color"].get<std::string>());
  }
  EXPECT_EQ(dashes.size(), 4U);
  EXPECT_EQ(colours_seen.size(), 7U);
}

// Law. Two curves that would have one colour and one dash get different ones: nobody could tell them apart.
TEST(Report, GivesNoTwoCurvesOneLook) {
  Figure figure = small_figure();
  figure.panels[0].curves.resize(10, figure.panels[0].curves[0]);
  for (std::size_t i = 0; i < 10; ++i) {
    Curve& curve = figure.panels[0].curves[i];
    curve.name = "channel " + std::to_string(i);
    curve.colour = static_cast<int>(i);
    curve.dash = Dash::solid;
  }
  Report page("t");
  page.add_figure(figure);
  std::set<std::pair<std::string, std::string>> looks;
  const auto data = support::figures_of(page.html()).at(0)["data"];
  for (const auto& trace : data) {
    looks.insert({trace["line"]["color"].get<std::string>(), trace["line"]["dash"].get<std::string>()});
  }
  EXPECT_EQ(looks.size(), 10U);
}

// Point. The title of a low panel stands in two lines, that of a high one in one; the frame of each panel is closed.
TEST(Report, KeepsAxisTitlesInTheirPanels) {
  Figure figure = small_figure();
  figure.panels[0].y.quantity = "power of the residual in terms of its noise";
  figure.panels.resize(4, figure.panels[0]);
  Report page("t");
  page.add_figure(figure);
  figure.height = 3000;
  page.add_figure(figure);
  const auto figures = support::figures_of(page.html());
  const auto title = [](const auto& f) { return f["layout"]["yaxis2"]["title"]["text"].template get<std::string>(); };
  EXPECT_NE(title(figures.at(0)).find("<br>"), std::string::npos);
  EXPECT_EQ(title(figures.at(1)).find("<br>"), std::string::npos);
  EXPECT_EQ(figures.at(0)["layout"]["xaxis"]["mirror"], "all");
}

// Point. A channel's name says what it is when it is pointed at; a path that holds the letters does not.
TEST(Report, SaysWhatChannelsAre) {
  Report page("t");
  page.add_text("The error of F_w & of noise.F_w in F_w.csv");
  page.add_table({"", {"channel"}, {{"F"}, {"F of x"}}});
  const std::string html = page.html();
  EXPECT_NE(html.find("of <abbr title=\"dynamic wheel load, without (m_b + m_w) g [N], positive more load\">F_w</abbr> "
                      "&amp; of noise.F_w in F_w.csv"),
            std::string::npos);
  EXPECT_NE(html.find(">F</abbr></td>"), std::string::npos);
  EXPECT_NE(html.find(">F of x</td>"), std::string::npos);
}

// A folded table is in the page, and a heading unfolds it.
TEST(Report, FoldsTables) {
  Report page("t");
  page.add_folded_table({"All rows", {"a"}, {{"1"}}});
  EXPECT_NE(page.html().find("<details><summary>All rows</summary>"), std::string::npos);
}

// Point. Zero is white: the sign of a value is seen even where the values reach much further on one side.
TEST(Report, KeepsZeroInTheMiddleOfAHeatMap) {
  Figure figure{"map", {}, {"delay", "ms"}};
  Panel panel{{"damping", "N s/m"}};
  panel.heat_map = {{"root", "1/s", {0.0, 1.0}, {0.0, 1.0, 2.0}, {-1.0, 0.0, 1.0, 2.0, 3.0, 40.0}}};
  figure.panels = {panel};
  Report page("t");
  page.add_figure(figure);
  const auto map = support::figures_of(page.html()).at(0)["data"][0];
  EXPECT_EQ(map["zmin"], -40.0);
  EXPECT_EQ(map["zmax"], 40.0);
  EXPECT_EQ(map["z"], nlohmann::json({{-1.0, 0.0}, {1.0, 2.0}, {3.0, 40.0}}));
  EXPECT_EQ(map["colorbar"]["title"]["text"], "root [1/s]");
}

TEST(Report, WritesNumbersAsAPersonDoes) {
  EXPECT_EQ(figure_text(15.2536, 6), "15.2536");
  EXPECT_EQ(figure_text(-0.5), "−0.5");
  EXPECT_EQ(figure_text(-0.0), "0");
  EXPECT_EQ(figure_text(0.00031), "0.00031");
  EXPECT_EQ(figure_text(908.0402), "908");
}

// Golden. The program carries the files of the tree, to the byte.
TEST(EmbeddedFiles, AreThoseOfTheTree) {
  for (const char* name :
       {"paper_linear.toml", "paper_hil_fdva.toml", "paper_rig_fdva.toml", "paper_bench_fdva.toml"}) {
    EXPECT_EQ(host_sim::embedded_file(name),
              support::TemporaryFolder::read(std::string(RIGTWIN_SOURCE_DIR "/host_sim/rigs/") + name));
  }
  EXPECT_THROW(static_cast<void>(host_sim::embedded_file("no_such_file")), std::logic_error);
}

}  // namespace
