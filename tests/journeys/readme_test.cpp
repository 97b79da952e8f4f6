// README.md answers five questions by commands and their output: here the commands run and print that output.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using support::TemporaryFolder;

/// One question: its heading, the commands below it, and the lines that README shows of their output.
struct Question {
  std::string heading;
  std::string commands;
  std::vector<std::string> output;
};

/// The questions of the chapter "Five questions": "### heading", a block of sh, a block of text.
std::vector<Question> questions() {
  std::istringstream readme(TemporaryFolder::read("README.md"));
  std::vector<Question> all;
  std::string block;  // the language of the fenced block that the line is in; empty: none
  bool in_chapter = false;
  for (std::string line; std::getline(readme, line);) {
    if (block.empty() && line.starts_with("## ")) in_chapter = line == "## Five questions";
    if (!in_chapter) continue;
    if (line.starts_with("```")) {
      block = block.empty() ? line.substr(3) : "";
    } else if (block.empty() && line.starts_with("### ")) {
      all.push_back({line.substr(4), "", {}});
    } else if (block == "sh" && !all.empty()) {
      all.back().commands += line + "\n";
    } else if (block == "text" && !all.empty() && line != "…") {
      all.back().output.push_back(line);
    }
  }
  return all;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The number in a word such as "(0.0099994", "12.84°" or "±2.5"; NaN where there is none.
double number_in(const std::string& word) {
  const std::size_t first = word.find_first_of("-0123456789");
  if (first == std::string::npos) return std::nan("");
  return std::strtod(word.c_str() + first, nullptr);
}

/// Equal words; where both are numbers, within 2 %: libraries of other Debian releases round differently.
bool alike(const std::string& shown, const std::string& printed) {
  const auto a = words_of(shown), b = words_of(printed);
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    const double x = number_in(a[i]), y = number_in(b[i]);
    if (!(std::abs(x - y) <= 0.02 * std::abs(x))) return false;
  }
  return true;
}

class Readme : public testing::TestWithParam<std::size_t> {};

// A user copies these commands: each runs from the files of the repository, and each line that README shows is printed,
// in README's order.
TEST_P(Readme, AnswersAQuestionByCommandsThatRun) {
  const auto all = questions();
  ASSERT_EQ(all.size(), 5U);
  const Question& question = all[GetParam()];
  SCOPED_TRACE(question.heading);
  ASSERT_FALSE(question.commands.empty());
  ASSERT_FALSE(question.output.empty());

  const TemporaryFolder folder;
  std::filesystem::create_directory_symlink(std::filesystem::absolute("host_sim"), folder / "host_sim");
  const std::string programs = std::filesystem::path(RIGTWIN_PROGRAM).parent_path().string();
  const std::string script =
      "cd '" + folder.path().string() + "'\nPATH='" + programs + "':\"$PATH\"\n" + question.commands;
  const TemporaryFolder streams;
  const auto ended = support::RunningProgram(streams, {"-e", "-c", script}, {}, "/bin/sh").wait();
  ASSERT_EQ(ended.status, 0) << question.commands << ended.errors;

  std::istringstream printed(ended.output);
  for (const std::string& shown : question.output) {
    bool found = false;
    for (std::string line; !found && std::getline(printed, line);) found = alike(shown, line);
    ASSERT_TRUE(found) << "README shows, and the commands do not print (in this order):\n"
                       << shown << "\n\n"
                       << ended.output;
  }
}

INSTANTIATE_TEST_SUITE_P(Questions, Readme, testing::Range(std::size_t{0}, std::size_t{5}));

}  // namespace
