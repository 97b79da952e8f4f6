// The manual shows what its commands print: a block that fails stops it, and every output stands in the page.
// manual.chromium makes the manual itself.
#include "host_sim/manual/manual.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/manual/small_plot.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

using namespace host_sim::manual;
using testing::HasSubstr;
using testing::Not;

constexpr const char* small = R"(# A title

Words with *stress*.

<!-- if measured -->
measured words
<!-- end -->
<!-- if not measured -->
simulated words
<!-- end -->

## A step

```sh lines=2
printf 'one\ntwo\nthree\n'
```

```toml
kind = "hil"
```
<!-- catalogue -->
)";

std::string fault(const std::string& text) {
  try {
    (void)parse_chapter(text, "chapter.md", {});
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

Workshop workshop() { return Workshop({support::source, {"GREETING=hello"}}); }

std::string all_text(const Chapter& chapter) {
  std::string text;
  for (const Part& part : chapter.parts) text += part.text;
  return text;
}

TEST(ManualChapter, IsTextAndCommands) {
  const Chapter chapter = parse_chapter(small, "chapter.md", {});
  EXPECT_EQ(chapter.title, "A title");
  ASSERT_EQ(chapter.parts.size(), 4U);
  EXPECT_EQ(chapter.parts[1].kind, Part::Kind::commands);
  EXPECT_EQ(chapter.parts[1].text, "printf 'one\\ntwo\\nthree\\n'\n");
  EXPECT_EQ(chapter.parts[1].line, 14U);
  EXPECT_EQ(chapter.parts[1].shown, 2U);
  EXPECT_EQ(chapter.parts[3].kind, Part::Kind::catalogue);
  EXPECT_THAT(all_text(chapter), HasSubstr("```toml\nkind = \"hil\"\n```\n"));
}

TEST(ManualChapter, LeavesOutWhatIsNotThere) {
  const std::string without = all_text(parse_chapter(small, "chapter.md", {})),
                    with = all_text(parse_chapter(small, "chapter.md", {"measured"}));
  EXPECT_THAT(without, HasSubstr("simulated words"));
  EXPECT_THAT(without, Not(HasSubstr("measured words")));
  EXPECT_THAT(with, HasSubstr("measured words"));
  EXPECT_THAT(with, Not(HasSubstr("simulated words")));
}

// The lines behind a block that are an excerpt of its output are text as well.
TEST(ManualChapter, KnowsWhatABlockMustPrint) {
  const Chapter chapter =
      parse_chapter("# T\n```sh excerpt\ntrue\n```\n```text\none\n…\nthree\n```\n```text\nfour\n```\n", "c.md", {});
  ASSERT_EQ(chapter.parts.size(), 2U);
  EXPECT_TRUE(chapter.parts[0].excerpt);
  EXPECT_THAT(chapter.parts[0].expected, testing::ElementsAre("one", "three"));
  EXPECT_THAT(chapter.parts[1].text, HasSubstr("one\n…\nthree\n"));
}

// A misspelt directive would silently show both variants; a block without end would swallow the rest.
TEST(ManualChapter, RefusesWhatItDoesNotUnderstand) {
  EXPECT_THAT(fault("words\n"), HasSubstr("chapter.md:1: does not begin with a title"));
  EXPECT_THAT(fault("# T\n<!-- iff x -->\n"), HasSubstr("chapter.md:2: is unknown"));
  EXPECT_THAT(fault("# T\n<!-- end -->\n"), HasSubstr("chapter.md:2: is unknown"));
  EXPECT_THAT(fault("# T\n<!-- if x -->\n<!-- if y -->\n"), HasSubstr("chapter.md:3: is no condition"));
  EXPECT_THAT(fault("# T\n<!-- if x -->\n"), HasSubstr("ends inside of <!-- if"));
  EXPECT_THAT(fault("# T\n\n```sh\ntrue\n"), HasSubstr("chapter.md:3: begins a block that does not end"));
  EXPECT_THAT(fault("# T\n```sh line=2\ntrue\n```\n"), HasSubstr("chapter.md:2: has an unknown option"));
  EXPECT_THAT(fault("# T\n```sh lines=0\ntrue\n```\n"), HasSubstr("chapter.md:2: has an unknown option"));
  EXPECT_THAT(fault("# T\n```sh excerpt\ntrue\n```\n"), HasSubstr("chapter.md:2: has no excerpt"));
  EXPECT_THAT(fault("# T\n```sh excerpt\ntrue\n```\n```sh\ntrue\n```\n"),
              HasSubstr("chapter.md:5: begins before the excerpt"));
}

TEST(ManualChapter, IsAScript) {
  EXPECT_EQ(as_script(parse_chapter(small, "chapter.md", {})),
            "#!/bin/sh -e\n# A title\n\n# A step\nprintf 'one\\ntwo\\nthree\\n'\n");
}

TEST(Manual, ShowsWhatItsCommandsPrint) {
  Workshop shop = workshop();
  const Chapter first = parse_chapter(small, "first.md", {});
  const Chapter second = parse_chapter(
      "# More\n```sh\necho \"$GREETING <b>\" > file; echo stays >&2\n```\n```sh\ncat file\n```\n", "second.md", {});
  const Manual manual = make_manual({first, second}, shop, {});
  ASSERT_EQ(manual.executed.size(), 3U);
  for (const Executed& block : manual.executed) EXPECT_EQ(block.ended.status, 0) << block.commands;
  EXPECT_EQ(manual.executed[0].ended.output, "one\ntwo\nthree\n");
  EXPECT_THAT(manual.html, HasSubstr("<pre class=\"output\">one\ntwo\n…\n</pre>"));
  EXPECT_THAT(manual.html, HasSubstr("<pre class=\"output\">stays\n</pre>"));
  EXPECT_THAT(manual.html,
              HasSubstr("<pre class=\"run\">cat file\n</pre>\n<pre class=\"output\">hello &lt;b&gt;\n</pre>"));
  EXPECT_THAT(manual.html, HasSubstr("<em>stress</em>"));
  EXPECT_THAT(manual.html, HasSubstr("<h3>A step</h3>"));
  EXPECT_FALSE(std::filesystem::exists(support::source / "file"));
}

// A block stops at its first command that fails, and the manual with it: file, line, status.
TEST(Manual, IsNotMadeOfCommandsThatFail) {
  Workshop shop = workshop();
  const Chapter chapter = parse_chapter("# T\n\n```sh\n(exit 3)\necho later\n```\n", "bad.md", {});
  try {
    (void)make_manual({chapter}, shop, {});
    FAIL() << "accepted";
  } catch (const firmware::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("bad.md:3: these commands end with status 3"));
    EXPECT_THAT(error.what(), Not(HasSubstr("-> later")));
  }
}

// What a chapter shows of an output is printed, in its order; else there is no manual.
TEST(Manual, IsNotMadeOfExcerptsThatAreNotPrinted) {
  Workshop shop = workshop();
  const auto made = [&](const std::string& excerpt) {
    return make_manual(
        {parse_chapter(
            "# T\n```sh excerpt\nprintf 'stable\\n  delay 12.7455 ms\\nend\\n'\n```\n```text\n" + excerpt + "```\n",
            "c.md", {})},
        shop, {});
  };
  EXPECT_THAT(made("stable\n…\nend\n").html, Not(HasSubstr("<pre class=\"output\">")));
  try {
    (void)made("end\nstable\n");
    FAIL() << "accepted";
  } catch (const firmware::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("c.md:2: these commands do not print what is shown of them"));
    EXPECT_THAT(error.what(), HasSubstr("expected stable"));
  }
}

// Words are equal, numbers within 2 %; a sign or a unit more is another line.
TEST(Manual, ComparesExcerptsByWordsAndNumbers) {
  const std::string printed = "head\n  delay (0.0099994 … 12.84°\n  tail\n";
  EXPECT_EQ(missing_line({"delay (0.0100 … 12.7°", "tail"}, printed), "");
  EXPECT_EQ(missing_line({"delay (0.0103 … 12.84°"}, printed), "delay (0.0103 … 12.84°");
  EXPECT_EQ(missing_line({"delay (-0.0099994 … 12.84°"}, printed), "delay (-0.0099994 … 12.84°");
  EXPECT_EQ(missing_line({"delay (0.0099994 …"}, printed), "delay (0.0099994 …");
  EXPECT_EQ(missing_line({"tail", "head"}, printed), "head");
  EXPECT_EQ(missing_line({}, ""), "");
}

TEST(Manual, LeavesNoFolderBehind) {
  std::filesystem::path folder;
  {
    Workshop shop = workshop();
    folder = shop.folder();
    EXPECT_EQ(shop.run("echo x > y").status, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "y"));
    EXPECT_EQ(shop.run("kill -9 $$").status, 137);
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(Manual, CutsLongOutput) {
  EXPECT_EQ(shown_output("a\nb\nc\n", 0), "a\nb\nc\n");
  EXPECT_EQ(shown_output("a\nb\nc\n", 2), "a\nb\n…\n");
  EXPECT_EQ(shown_output("a\nb\n", 2), "a\nb\n");
  EXPECT_EQ(shown_output("a\nb", 2), "a\nb");
  EXPECT_EQ(shown_output("", 2), "");
}

TEST(Manual, ReadsTablesAndShowsHtmlAsText) {
  EXPECT_THAT(markdown_html("| a | b |\n| --- | --- |\n| 1 | `x < 2` |\n"),
              HasSubstr("<td><code>x &lt; 2</code></td>"));
  EXPECT_THAT(markdown_html("a <script>alert(1)</script>\n"), Not(HasSubstr("<script>")));
}

// Point. Curves between y = 80 (lowest, 0) and 20 (highest, 4); their difference 1, 2 between 134 (0) and 98 (2).
TEST(ManualPlot, ScalesBothCurvesAlike) {
  const std::array<double, 2> a{0.0, 2.0}, b{1.0, 4.0};
  const std::string picture = svg({"F", "changes by 50 %", "N", 1.5, a, b});
  EXPECT_THAT(picture, HasSubstr("class=\"without\" points=\"4.0,80.0 246.0,50.0 \""));
  EXPECT_THAT(picture, HasSubstr("class=\"with\" points=\"4.0,65.0 246.0,20.0 \""));
  EXPECT_THAT(picture, HasSubstr("class=\"difference\" points=\"4.0,116.0 246.0,98.0 \""));
  EXPECT_THAT(picture, HasSubstr(">0 … 4 N</text>"));
  EXPECT_THAT(picture, HasSubstr(">difference 0 … 2 N</text>"));
  EXPECT_THAT(picture, HasSubstr(">1.5 s</text>"));
}

TEST(ManualPlot, RefusesWhatCannotBeDrawn) {
  const std::array<double, 2> a{0.0, 2.0}, bad{0.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW((void)svg({"F", "", "N", 1.0, a, std::span(a).first(1)}), std::logic_error);
  EXPECT_THROW((void)svg({"F", "", "N", 1.0, a, bad}), std::logic_error);
  EXPECT_THROW((void)svg({"F", "", "N", 1.0, {}, {}}), std::logic_error);
}

// Every effect of the catalogue has its picture, in which it changes something.
TEST(ManualPictures, ShowEveryEffect) {
  const auto pictures = effect_pictures(support::source / "host_sim" / "rigs");
  ASSERT_EQ(pictures.size(), firmware::catalogue().size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    SCOPED_TRACE(pictures[i].values);
    EXPECT_EQ(pictures[i].entry, &firmware::catalogue()[i]);
    double largest = 0.0;
    for (const ChannelPicture& channel : pictures[i].channels) {
      largest = std::max(largest, channel.change);
      EXPECT_EQ(channel.with.size(), channel.without.size());
      EXPECT_LE(channel.with.size(), 260U);
    }
    EXPECT_GE(largest, 1e-3) << "the picture shows no change";
  }
}

}  // namespace
