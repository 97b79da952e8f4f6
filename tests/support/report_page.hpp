// A report as a test reads it.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace support {

/// The figures of a page: the JSON of each, as the browser will parse it.
inline std::vector<nlohmann::json> figures_of(const std::string& html) {
  const std::string begin = "<script type=\"application/json\">", end = "</script>";
  std::vector<nlohmann::json> figures;
  for (std::size_t at = html.find(begin); at != std::string::npos; at = html.find(begin, at)) {
    at += begin.size();
    figures.push_back(nlohmann::json::parse(html.substr(at, html.find(end, at) - at)));
  }
  return figures;
}

/// What holds of every page: as many figures as expected (if a number is) and as it says, whole, a unit on every axis
/// and colour scale, nothing from elsewhere.
inline void expect_sound(const std::string& html, std::optional<std::size_t> figures = std::nullopt) {
  const auto found = figures_of(html);
  EXPECT_EQ(found.size(), figures.value_or(found.size()));
  EXPECT_NE(html.find("<body data-figures=\"" + std::to_string(found.size()) + "\""), std::string::npos);
  const auto expect_unit = [](const nlohmann::json& titled) {
    const std::string title = titled["title"]["text"];
    EXPECT_TRUE(title.ends_with("]") &&
                (title.find(" [") != std::string::npos || title.find("<br>[") != std::string::npos) &&
                !title.ends_with("[]"))
        << title;
  };
  for (const auto& figure : found) {
    EXPECT_FALSE(figure["data"].empty());
    for (const auto& trace : figure["data"]) {
      EXPECT_FALSE(trace["x"].empty()) << trace["name"];
      EXPECT_TRUE(trace.contains("hovertemplate"));
      if (trace.contains("colorbar")) expect_unit(trace["colorbar"]);
      EXPECT_TRUE(figure["layout"].contains(
          trace["yaxis"] == "y" ? "yaxis" : "yaxis" + trace["yaxis"].get<std::string>().substr(1)));
    }
    for (const auto& [key, part] : figure["layout"].items()) {
      if ((key.starts_with("xaxis") || key.starts_with("yaxis")) && part["type"] != "category") expect_unit(part);
    }
  }
  EXPECT_NE(html.find("<html lang=\"en\">"), std::string::npos);
  EXPECT_NE(html.find("<meta name=\"viewport\""), std::string::npos);
  for (const char* elsewhere : {" src=\"", "@import", "<link rel=\"stylesheet\"", "url(http"}) {
    EXPECT_EQ(html.find(elsewhere), std::string::npos) << elsewhere;
  }
}

}  // namespace support
