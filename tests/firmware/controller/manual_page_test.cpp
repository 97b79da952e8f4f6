// man rig_controller and rig_controller --help are written in two places: an option of one is an option of the other.
#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <string>

#include "firmware/controller/devices/options.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

/// Every word of the form --name in a text.
std::set<std::string> options_in(const std::string& text) {
  std::set<std::string> found;
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 2)) {
    std::size_t end = at + 2;
    while (end < text.size() && (std::isalpha(static_cast<unsigned char>(text[end])) != 0 || text[end] == '-')) ++end;
    if (end > at + 2) found.insert(text.substr(at, end - at));
  }
  return found;
}

TEST(ManualPage, KnowsTheOptionsOfTheHelp) {
  std::string page;
  for (const char c : support::TemporaryFolder::read(support::source / "firmware/controller/deploy/rig_controller.1")) {
    if (c != '\\') page += c;  // \- is a hyphen
  }
  std::set<std::string> in_page = options_in(page);
  EXPECT_EQ(in_page.erase("--help") + in_page.erase("--version"), 2U);
  const std::set<std::string> in_help = options_in(firmware::controller::usage);
  EXPECT_GT(in_help.size(), 15U);
  EXPECT_EQ(in_page, in_help);
}

}  // namespace
