#include "firmware/description/text/json_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace {

using firmware::json_text;

TEST(JsonText, IsReadAsItWas) {
  for (const char* text : {"", "door", "a \"b\" \\c", "Prüfstand №7 🚗", "\xEF\xBF\xBF"}) {
    EXPECT_EQ(nlohmann::json::parse(json_text(text)).get<std::string>(), text);
  }
}

// A file name or a mark may hold any bytes: a parser must be able to read the rest of the object.
TEST(JsonText, IsReadableWhateverTheBytesAre) {
  EXPECT_EQ(json_text("a\nb\x7f"), "\"a b \"");
  for (const std::string text : {"\xff", "r\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe0\x80\x80",
                                 "\x80", "\xf0\x8f\xbf\xbf", "\xf5\x80\x80\x80", "\xe2\x28\xa1"}) {
    const nlohmann::json read = nlohmann::json::parse(json_text(text), nullptr, false);
    ASSERT_TRUE(read.is_string()) << json_text(text);
    EXPECT_NE(read.get<std::string>().find('?'), std::string::npos);
  }
}

}  // namespace
