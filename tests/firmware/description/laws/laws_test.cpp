// [laws] of a rig description: read, checked, written back.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "firmware/description/laws/law_file.hpp"
#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"

namespace {

using firmware::parse_rig;
using firmware::RigDescription;
using model::LawOver;
using model::LawPlace;

constexpr std::string_view car =
    "kind = \"quarter_car\"\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n"
    "[tyre]\nstiffness = 200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 0.0\n";  // 12 lines

RigDescription with(const std::string& laws) { return parse_rig(std::string(car) + laws, "rig.toml"); }

std::string error_of(const std::string& laws) {
  try {
    static_cast<void>(with(laws));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "no error";
}

constexpr const char* damper =
    "[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, -0.3, 0.0, 0.3, 1.0]\n"
    "value = [-1900.0, -900.0, 0.0, 500.0, 1100.0]\n";

// Point. Both laws of contract.md arrive in the model with place, points and branches.
TEST(Laws, TheExamplesOfTheContractAreRead) {
  const std::string bushing =
      "[laws.bushing]\nplace = \"suspension\"\nbranches = [{ stiffness = 8e3, time_constant = 0.02 }, "
      "{ stiffness = 20e3, slip_force = 60.0 }]\n";
  const RigDescription rig = with(damper + bushing);
  const auto& laws = rig.rig.laws;
  ASSERT_EQ(laws.curve_count, 1);
  EXPECT_EQ(laws.curves[0].place, LawPlace::suspension);
  EXPECT_EQ(laws.curves[0].over, LawOver::velocity);
  ASSERT_EQ(laws.curves[0].count, 5);
  EXPECT_EQ(laws.curves[0].at[1], -0.3);
  EXPECT_EQ(laws.curves[0].value[4], 1100.0);
  ASSERT_EQ(laws.branch_count, 2);
  EXPECT_EQ(laws.branches[0].time_constant, 0.02);
  EXPECT_EQ(laws.branches[0].slip_force, 0.0);
  EXPECT_EQ(laws.branches[1].stiffness, 20e3);
  EXPECT_EQ(laws.branches[1].slip_force, 60.0);
}

// Point. `behind` is a spring in series; what cannot be behind one is an error with its line.
TEST(Laws, ACurveMayBeBehindASpring) {
  const RigDescription rig = with(std::string(damper) + "behind = 4.3e5\n");
  EXPECT_EQ(rig.rig.laws.curves[0].behind, 4.3e5);
  EXPECT_EQ(with(damper).rig.laws.curves[0].behind, 0.0);
  const RigDescription again = parse_rig(firmware::format_rig(rig), "again.toml");
  EXPECT_EQ(again.rig.laws.curves[0].behind, 4.3e5);
  const auto expect = [](const std::string& laws, const std::string& place, const std::string& why) {
    const std::string error = error_of(laws);
    EXPECT_NE(error.find(place), std::string::npos) << error;
    EXPECT_NE(error.find(why), std::string::npos) << error;
  };
  expect(std::string(damper) + "behind = -1.0\n", "rig.toml:18", "behind");
  expect(std::string(damper) + "behind = 1e15\n", "rig.toml:18", "N/m");
  expect("[laws.b]\nplace = \"suspension\"\nbehind = 1e5\nbranches = [{ stiffness = 8e3, time_constant = 0.02 }]\n",
         "rig.toml:15", "branches behind a spring");
  expect(
      "[laws.b]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 0.1, 1.0]\n"
      "value = [-900.0, 0.0, 700.0, 600.0]\nbehind = 1e5\n",
      "rig.toml:18", "it would jump");
  expect("[laws.b]\nplace = \"sensor F_w\"\nat = [-1.0, 1.0]\nvalue = [-1.0, 1.1]\nbehind = 1e5\n", "rig.toml:17",
         "sensor");
}

// Law. Written and read again it is the same rig, under the same names.
TEST(Laws, AreWrittenAsTheyWereRead) {
  const std::string rest =
      "branches = [{ stiffness = 8e3, time_constant = 0.02 }]\n"
      "[laws.ball]\nplace = \"tyre\"\nover = [\"deflection\", \"velocity\"]\nat = [-0.01, 0.0, 0.02]\n"
      "at_2 = [-1.0, 1.0]\nvalue = [[-3.0, 1.0], [-1.0, 1.0], [-1.5, 7.0]]\n"
      "[laws.bent]\nplace = \"sensor F_w\"\nat = [-1e4, 0.0, 1e4]\nvalue = [-9e3, 0.0, 1.1e4]\n"
      "[laws.spring]\nplace = \"body_guide\"\nover = \"deflection\"\nat = [0.0, 0.1]\nvalue = [0.0, -5.0]\n"
      "feeds_energy = true\n";
  const RigDescription first = with(damper + rest);
  const std::string text = format_rig(first);
  const RigDescription second = parse_rig(text, "again.toml");
  EXPECT_EQ(format_rig(second), text);
  ASSERT_EQ(second.laws.size(), 4U);
  EXPECT_EQ(second.rig.laws.curve_count, 3);
  EXPECT_EQ(second.rig.laws.surfaces[0].value[2][1], 7.0);
  EXPECT_EQ(second.rig.laws.surfaces[0].place, LawPlace::tyre);
  EXPECT_NE(text.find("[laws.damper]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, -0.3, 0.0, 0.3, 1.0]\n"
                      "value = [-1900.0, -900.0, 0.0, 500.0, 1100.0]\n"
                      "branches = [{ stiffness = 8000.0, time_constant = 0.02 }]\n"),
            std::string::npos)
      << text;
}

// Law. Lost motion of a slider is read and written; a branch with a time constant has none.
TEST(Laws, ASliderMayHaveLostMotion) {
  const std::string band =
      "[laws.band]\nplace = \"suspension\"\nbranches = [{ stiffness = 1000.0, slip_force = 5.0, gap = 0.004 }]\n";
  const RigDescription rig = with(band);
  EXPECT_EQ(rig.rig.laws.branches[0].gap, 0.004);
  EXPECT_NE(format_rig(rig).find("slip_force = 5.0, gap = 0.004 }"), std::string::npos) << format_rig(rig);
}

// Law. A law that nobody named is written, too.
TEST(Laws, OneWithoutANameIsWritten) {
  RigDescription rig = with("");
  rig.rig.laws.branches[rig.rig.laws.branch_count++] = {.stiffness = 1e3, .slip_force = 5.0};
  EXPECT_EQ(parse_rig(format_rig(rig), "again.toml").laws.at(0).name, "law_1");
}

// Law. Branches of one place that nobody named are one law; it needs no leave to feed energy, since no branch can.
TEST(Laws, BranchesOfOnePlaceAreOneLaw) {
  RigDescription rig = with("");
  for (const double force : {5.0, 7.0}) {
    rig.rig.laws.branches[rig.rig.laws.branch_count++] = {.stiffness = 1e3, .slip_force = force};
  }
  rig.rig.laws.branches[rig.rig.laws.branch_count++] = {
      .place = model::LawPlace::tyre, .stiffness = 1e3, .slip_force = 9.0};
  const RigDescription again = parse_rig(format_rig(rig), "again.toml");
  ASSERT_EQ(again.laws.size(), 2U);
  EXPECT_EQ(again.laws[0].branches, 2U);
  EXPECT_FALSE(again.laws[0].feeds_energy);
  EXPECT_EQ(again.laws[1].first_branch, 2U);
  EXPECT_EQ(again.laws[1].branches, 1U);
}

// Law. A damper with gas pushes at rest. What its static equilibrium carries already is no part of the law: said by a key
// of its own, it is taken off; unsaid, the description is refused on a rig whose body it would move.
TEST(Laws, GasPreloadIsAKeyOfItsOwn) {
  const std::string gas =
      "[laws.d]\nplace = \"suspension\"\nover = \"velocity\"\nat = [-1.0, 0.0, 1.0]\nvalue = [-100.0, 200.0, 700.0]\n";
  EXPECT_NE(error_of(gas).find("pushes with 200 N at rest"), std::string::npos) << error_of(gas);
  EXPECT_NE(error_of(gas).find("preload = 200.0"), std::string::npos) << error_of(gas);
  const RigDescription rig = with(gas + "preload = 200.0\n");
  EXPECT_EQ(rig.rig.laws.curves[0].value[0], -300.0);
  EXPECT_EQ(rig.rig.laws.curves[0].value[1], 0.0);
  EXPECT_EQ(rig.rig.laws.curves[0].value[2], 500.0);
  const RigDescription again = parse_rig(format_rig(rig), "again.toml");
  EXPECT_EQ(again.rig.laws.curves[0].value[2], 500.0);
  EXPECT_EQ(error_of(gas + "feeds_energy = true\n"), "no error");
}

struct Wrong {
  const char* law;
  const char* message;
};

// Point. Each error says line, key and what is expected.
TEST(Laws, ErrorsNameLineAndKey) {
  const std::string head = "[laws.d]\nplace = \"suspension\"\nover = \"velocity\"\n";
  const std::vector<Wrong> wrongs{
      {"at = [-1.0, 0.0, 0.0]\nvalue = [-1.0, 0.0, 1.0]\n", "rig.toml:16: laws.d.at: 0 follows 0, expected ascending"},
      {"at = [-1.0]\nvalue = [-1.0]\n", "rig.toml:16: laws.d.at is not a list of 2 to 33 numbers"},
      {"at = [-1.0, nan]\nvalue = [-1.0, 1.0]\n", "rig.toml:16: laws.d.at: value 2 is not a finite number"},
      {"at = [-1.0, 1.0]\nvalue = [-1.0, 0.0, 1.0]\n", "rig.toml:17: laws.d.value has 3 numbers, expected 2"},
      {"at = [-1.0, 1.0]\nvalue = [1.0, -1.0]\n",
       "rig.toml:17: the law d pushes the way it moves, expected a force that "
       "grows with the velocity (compression positive), or feeds_energy"},
      {"at = [-500.0, 500.0]\nvalue = [-1.0, 1.0]\n",
       "rig.toml:16: laws.d.at reaches -500 m/s, expected at most 20 m/s; is the table in mm/s?"},
      {"at = [-1.0, 1.0]\nvalue = [-1.0, 1.0]\nvalues = 3\n", "rig.toml:18: unknown key 'laws.d.values'"},
      {"at = [-1.0, 1.0]\n", "rig.toml:13: [laws.d] has no 'value'"},
      {"file = \"d.csv\"\nat = [0.0, 1.0]\n", "rig.toml:17: laws.d.at beside a file"},
  };
  for (const Wrong& wrong : wrongs) {
    EXPECT_NE(error_of(head + wrong.law).find(wrong.message), std::string::npos)
        << error_of(head + wrong.law) << "\n  instead of\n"
        << wrong.message;
  }
  const std::vector<Wrong> places{
      {"[laws.d]\nplace = \"piston\"\n", "rig.toml:14: 'piston': quarter_car has no such place"},
      {"[laws.d]\nplace = \"suspenson\"\n", "rig.toml:14: unknown place"},
      {"[laws.d]\nplace = \"sensor F\"\n", "rig.toml:14: 'sensor F': quarter_car has no such place"},
      {"[laws.d]\nplace = \"tyre\"\n", "rig.toml:13: [laws.d] has no 'at', expected a curve"},
      {"[laws.d]\nplace = \"tyre\"\nbranches = [{ stiffness = 1.0 }]\n",
       "rig.toml:15: a branch of d with neither time_constant and slip_force"},
      {"[laws.d]\nplace = \"tyre\"\nbranches = [{ stiffness = -1.0, slip_force = 2.0 }]\n",
       "rig.toml:15: laws.d.branches.stiffness"},
      {"[laws.d]\nplace = \"tyre\"\nbranches = [{ stiffness = 1.0, slip_force = 2.0, gap = -1.0 }]\n",
       "rig.toml:15: laws.d.branches.gap"},
      {"[laws.d]\nplace = \"tyre\"\nbranches = [{ stiffness = 1.0, time_constant = 2.0, gap = 1.0 }]\n",
       "rig.toml:15: a gap of a branch of d with a time_constant"},
  };
  for (const Wrong& wrong : places) {
    EXPECT_NE(error_of(wrong.law).find(wrong.message), std::string::npos) << error_of(wrong.law) << "\n  instead of\n"
                                                                          << wrong.message;
  }
}

class LawFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("rigtwin_laws_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  firmware::LawPoints read(const std::string& text, LawOver over = LawOver::velocity) {
    std::ofstream(folder_ / "d.csv") << text;
    return firmware::read_law_file(folder_ / "d.csv", LawPlace::suspension, over);
  }
  std::string error(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const firmware::InputError& e) {
      const std::string what = e.what();
      return what.substr(what.find("d.csv"));
    }
    return "no error";
  }
  std::filesystem::path folder_;
};

// Point. The forms in which data sheets come give the same points.
TEST_F(LawFile, FormsOfADataSheetAreTheSame) {
  for (const char* text :
       {"-0.5,-900\n0,0\n0.5,450\n", "\xef\xbb\xbfvelocity [mm/s],force [N]\n-500,-900\n0,0\n500,450\n",
        "# bench 3\nv (mm/s);F (kN);\r\n-500;-0,9;\r\n0;0;\r\n500;0,45;\r\n",
        "v [m/s]\tF [daN]\n0,5\t45\n\n0\t0\n-0,5\t-90\n", "v F\n-0.5   -900\n 0 0\n+0.5 450\n"}) {
    const auto points = read(text);
    ASSERT_EQ(points.at.size(), 3U) << text;
    EXPECT_DOUBLE_EQ(points.at[0], -0.5) << text;
    EXPECT_DOUBLE_EQ(points.value[0], -900.0) << text;
    EXPECT_DOUBLE_EQ(points.at[2], 0.5) << text;
    EXPECT_DOUBLE_EQ(points.value[2], 450.0) << text;
  }
  EXPECT_DOUBLE_EQ(read("x [mm],F [N]\n0,0\n10,5\n", LawOver::deflection).at[1], 0.01);
}

// Point. What is no table is said with its line.
TEST_F(LawFile, ErrorsNameTheLine) {
  EXPECT_EQ(error("v,F\n0,0\n0.1,x\n"),
            "d.csv:3: 'x' is not a number, expected two columns of numbers: velocity or "
            "deflection, then force");
  EXPECT_EQ(error("v,F,T\n0,0,20\n"),
            "d.csv:1: a row of 3 columns, expected two columns of numbers: velocity or "
            "deflection, then force");
  EXPECT_EQ(error("v [mm],F [N]\n0,0\n"),
            "d.csv:1: the unit 'mm', expected m/s, mm/s or cm/s: the law is over the "
            "velocity");
  EXPECT_EQ(error("0,0\n"), "d.csv: 1 points, expected 2 to 33 rows of two numbers");
  EXPECT_EQ(error("0,0\n1,1\n1,2\n"),
            "d.csv:3: the first column turns back or repeats, expected one value a row, in "
            "ascending or descending order");
  EXPECT_EQ(error("0,0\n1,nan\n"),
            "d.csv:2: 'nan' is not a number, expected two columns of numbers: velocity or "
            "deflection, then force");
  std::string many;
  for (int i = 0; i < 34; ++i) many += std::to_string(i) + ",1\n";
  EXPECT_EQ(error(many), "d.csv:34: more than 33 points, expected 2 to 33; thin the table where it is straight");
}

// Law. A file is looked for beside the description; a table in mm/s without units is recognised.
TEST_F(LawFile, StandsBesideTheDescription) {
  std::ofstream(folder_ / "d.csv") << "-0.5,-900\n0,0\n0.5,450\n";
  const std::string law = "[laws.d]\nplace = \"suspension\"\nover = \"velocity\"\nfile = \"d.csv\"\n";
  const auto rig = parse_rig(std::string(car) + law, (folder_ / "rig.toml").string());
  EXPECT_EQ(rig.rig.laws.curves[0].value[0], -900.0);
  EXPECT_NE(format_rig(rig).find("value = [-900.0, 0.0, 450.0]"), std::string::npos);
  std::ofstream(folder_ / "d.csv") << "-500,-900\n0,0\n500,450\n";
  try {
    static_cast<void>(parse_rig(std::string(car) + law, (folder_ / "rig.toml").string()));
    FAIL();
  } catch (const firmware::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("rig.toml:16: d.csv reaches -500 m/s"), std::string::npos) << error.what();
  }
}

}  // namespace
