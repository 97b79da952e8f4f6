// rigtwin new-effect: what it writes into a source tree, and what it leaves alone. check.new_effect compiles the
// result.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/rig_texts.hpp"

namespace {

namespace fs = std::filesystem;
using support::Ended;
using support::rigtwin;
using support::TemporaryFolder;

/// What the command looks at of a source tree: model/ and the folder of the effects' tests.
class NewEffect : public testing::Test {
 protected:
  NewEffect() {
    fs::create_directories(tree / "tests/model/effects");
    fs::copy(support::source / "model", tree / "model", fs::copy_options::recursive);
  }

  [[nodiscard]] Ended add(const std::string& name) const {
    return rigtwin({"new-effect", name, "--tree", tree.string()});
  }
  [[nodiscard]] std::string list() const { return TemporaryFolder::read(tree / "model/effects/catalogue.hpp"); }
  [[nodiscard]] std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(tree)) count += entry.is_regular_file() ? 1 : 0;
    return count;
  }

  TemporaryFolder folder;
  fs::path tree = folder / "tree";
};

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// The effect's file with its card, its test, and one line each for #include and entry: the list is what it was,
// otherwise.
TEST_F(NewEffect, WritesFileTestAndEntry) {
  const std::string before = list();
  const Ended ended = add("rubber_bush");
  ASSERT_EQ(ended.status, 0) << ended.errors;
  const std::string effect = TemporaryFolder::read(tree / "model/effects/rubber_bush.hpp");
  EXPECT_NE(effect.find("struct RubberBush {"), std::string::npos);
  EXPECT_NE(effect.find(".name = \"rubber_bush\""), std::string::npos);
  const std::string test = TemporaryFolder::read(tree / "tests/model/effects/rubber_bush_test.cpp");
  EXPECT_NE(test.find("TEST(RubberBush, "), std::string::npos);
  for (const std::string& text : {effect, test}) EXPECT_EQ(text.find('@'), std::string::npos) << text;

  std::string after = list();
  const std::string include = "#include \"model/effects/rubber_bush.hpp\"\n";
  const std::string entry = "                           RubberBush<S>,           //\n";
  EXPECT_NE(after.find("relaxation.hpp\"\n" + include + "#include \"model/effects/seal_friction.hpp\""),
            std::string::npos)
      << "in the order of the alphabet";
  for (const std::string& added : {include, entry}) {
    const std::size_t at = after.find(added);
    ASSERT_NE(at, std::string::npos) << added;
    after.erase(at, added.size());
  }
  EXPECT_EQ(after, before);
}

// A name longer than all others moves the comments of the whole list, as clang-format would.
TEST_F(NewEffect, KeepsTheCommentsOfTheListInOneColumn) {
  const std::size_t lines = count_lines(list());
  ASSERT_EQ(add("extraordinarily_long_rubber_bush").status, 0);
  const std::string after = list();
  EXPECT_EQ(count_lines(after), lines + 2);
  EXPECT_NE(after.find("           ExtraordinarilyLongRubberBush<S>,  //\n"), std::string::npos);
  EXPECT_NE(after.find("           TopMount<S>,                       //\n"), std::string::npos);
  EXPECT_NE(after.find("           MovingMass<S>>;\n"), std::string::npos);
}

// What is refused changes nothing, and says in one line what is wrong.
TEST_F(NewEffect, RefusesWhatCannotBeAnEffect) {
  const std::string before = list();
  const std::size_t count = files();
  const auto refuse = [&](const std::string& name, int status, const std::string& says) {
    const Ended ended = add(name);
    EXPECT_EQ(ended.status, status) << name << ": " << ended.errors;
    EXPECT_EQ(ended.error_lines(), 1) << ended.errors;
    EXPECT_NE(ended.errors.find(says), std::string::npos) << ended.errors;
  };
  for (const char* name : {"RubberBush", "rubber-bush", "2nd_bush", "rubber__bush", "bush_", "_bush", "s", "r\xc3\xbc",
                           "a/../b", "rubber bush"}) {
    refuse(name, 2, "expected 3 to 48 lower-case letters");
  }
  refuse("coulomb_friction", 4, "coulomb_friction.hpp: is there already");
  refuse("catalogue", 4, "is there already");
  refuse("rig_parameters", 4, "declares RigParameters already");
  refuse("suspension_law", 4, "declares SuspensionLaw already");
  std::ofstream(tree / "tests/model/effects/rubber_bush_test.cpp") << "mine\n";
  refuse("rubber_bush", 4, "rubber_bush_test.cpp: is there already");
  EXPECT_EQ(list(), before);
  EXPECT_EQ(files(), count + 1);
}

// A folder that is no source tree, or whose list is not the one known here, stays as it is.
TEST_F(NewEffect, RefusesAFolderThatIsNoTree) {
  const Ended elsewhere = rigtwin({"new-effect", "rubber_bush", "--tree", folder.path().string()});
  EXPECT_EQ(elsewhere.status, 3);
  EXPECT_NE(elsewhere.errors.find("is no source tree of rigtwin"), std::string::npos) << elsewhere.errors;
  std::ofstream(tree / "model/effects/catalogue.hpp") << "// nothing\n";
  const std::size_t count = files();
  const Ended emptied = add("rubber_bush");
  EXPECT_EQ(emptied.status, 3);
  EXPECT_NE(emptied.errors.find("catalogue.hpp: includes no effect"), std::string::npos) << emptied.errors;
  EXPECT_EQ(files(), count);
}

}  // namespace
