#include "host_sim/report/report.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "firmware/description/version.hpp"
#include "host_sim/report/channel_glossary.hpp"
#include "host_sim/report/embedded_files.hpp"
#include "host_sim/report/plotly.hpp"

namespace host_sim::report {
namespace {

constexpr std::string_view style = R"(
:root { color-scheme: light; }
body { margin: 0 auto; padding: 0 1.2rem 3rem; max-width: 68rem; background: #fff; color: #222;
       font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", Arial, sans-serif; }
h1 { overflow-wrap: anywhere; font-size: 1.7rem; line-height: 1.25; margin: 1.4rem 0 .4rem; }
h2 { font-size: 1.3rem; margin: 2.4rem 0 .6rem; padding-bottom: .2rem; border-bottom: 1px solid #bbb; }
p { max-width: 52rem; margin: .6rem 0; }
.lead { color: #444; }
nav ul { margin: .8rem 0; padding: 0; list-style: none; display: flex; flex-wrap: wrap; gap: .2rem 1.4rem; }
a { color: #00558a; }
.verdict { max-width: 50rem; margin: .8rem 0; padding: .6rem .9rem; border-left: 6px solid; background: #f5f5f5; }
.verdict b { margin-right: .5em; white-space: nowrap; }
.good { border-color: #0072B2; background: #eef6fb; }
.bad { border-color: #D55E00; background: #fdf2ea; }
.remark { border-color: #777; }
figure { margin: 1.4rem 0; }
figcaption { font-weight: 600; margin-bottom: .2rem; }
figure p { margin: .3rem 0 0; font-size: .93rem; color: #444; }
.plot { width: 100%; }
.scroll { overflow-x: auto; }
abbr { text-decoration: underline dotted #999; text-underline-offset: .2em; cursor: help; }
table { border-collapse: collapse; margin: .4rem 0 1.2rem; font-variant-numeric: tabular-nums; font-size: .95rem; }
caption { text-align: left; font-weight: 600; padding: .4rem 0; }
@media (min-width: 48rem) { caption { white-space: nowrap; } }
th, td { padding: .2rem .8rem .2rem 0; text-align: right; vertical-align: top; border-bottom: 1px solid #ddd; }
th { border-bottom-color: #888; }
td { white-space: nowrap; }
th.words, td.words { text-align: left; white-space: normal; min-width: 7rem; }
details { margin: .6rem 0; }
summary { cursor: pointer; font-weight: 600; }
pre { background: #f7f7f7; padding: .7rem; overflow-x: auto; font-size: .85rem; line-height: 1.35; }
pre.made { white-space: pre-wrap; overflow-wrap: anywhere; }
footer { margin-top: 2.5rem; font-size: .9rem; color: #444; }
@page { size: A4; margin: 15mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  nav, footer details, .modebar-container { display: none !important; }
  abbr { text-decoration: none; }
  figure, tr, .verdict, .short { break-inside: avoid; }
  h2, h3, caption, thead, summary { break-after: avoid; }
  p { orphans: 3; widows: 3; }
  pre { white-space: pre-wrap; overflow: visible; }
  .scroll { overflow: visible; }
  table { font-size: .85em; }
  th, td { white-space: normal; padding-right: .5rem; }
  th.words, td.words { min-width: 0; }
}
)";

// Draws the figures and keeps them as wide as the page, also in print. It counts its work in attributes of the body.
constexpr std::string_view drawing = R"(
"use strict";
(function () {
  const say = document.body.dataset;
  const places = Array.from(document.querySelectorAll(".plot"));
  const config = {responsive: true, displaylogo: false, showSendToCloud: false, plotlyServerURL: "",
                  modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"], toImageButtonOptions: {format: "svg"}};
  const narrow = function (layout, data) {
    // The legend stands between the buttons and the figure; its rows depend on the width.
    const width = Math.min(window.innerWidth, 1088) - 110;
    let row = 0, rows = 1;
    data.forEach(function (trace) {
      if (trace.showlegend === false || !trace.name) return;
      const item = 48 + 7 * trace.name.length;
      if (row > 0 && row + item > width) { rows += 1; row = 0; }
      row += item;
    });
    layout.margin.t = 34 + 19 * rows;
    if (window.innerWidth >= 600) return layout;  // a phone: every pixel of the margins counts, no tick labels turn
    layout.font.size = 11;
    layout.margin.l = 45;
    layout.margin.r = 8;
    if (layout.xaxis.type === "linear") layout.xaxis.nticks = 5;
    layout.xaxis.tickangle = 0;
    layout.xaxis.automargin = false;
    Object.keys(layout).forEach(function (key) {
      const axis = layout[key];
      if (!key.startsWith("yaxis") || axis.type !== "category") return;
      axis.automargin = false;
      axis.title.text = "";
      axis.tickfont = {size: 10};
      layout.margin.l = 155;
    });
    return layout;
  };
  const drawn = places.map(function (place) {
    const figure = JSON.parse(place.nextElementSibling.textContent);
    return Plotly.newPlot(place, figure.data, narrow(figure.layout, figure.data), config);
  });
  Promise.all(drawn).then(function () {
    say.drawn = String(places.filter(function (place) { return place.querySelector(".main-svg"); }).length);
    say.traces = String(places.filter(function (place) {
      return place.querySelector(".trace, .hm image, .heatmaplayer image");
    }).length);
    say.requests = String(performance.getEntriesByType("resource").length);
  }, function (error) { console.error(error); });
  window.addEventListener("beforeprint", function () {
    document.querySelectorAll("main details").forEach(function (part) { part.open = true; });
    places.forEach(function (place) {  // two figures of one or two panels fit on a page
      const panels = Object.keys(place.layout).filter(function (key) { return key.startsWith("yaxis"); }).length;
      const height = (panels > 2 ? 1 : 0.78) * place.clientHeight;
      place.dataset.screen = String(place.clientHeight);
      place.style.height = height + "px";
      Plotly.relayout(place, {width: 680, height: height});
    });
  });
  window.addEventListener("afterprint", function () {
    places.forEach(function (place) {
      place.style.height = place.dataset.screen + "px";
      Plotly.relayout(place, {width: null, height: Number(place.dataset.screen), autosize: true});
    });
  });
})();
)";

constexpr std::string_view listening = R"(
(function () {
  const count = function () { document.body.dataset.errors = String(Number(document.body.dataset.errors) + 1); };
  const before = console.error;
  console.error = function () { count(); before.apply(console, arguments); };
  window.addEventListener("error", count);
  window.addEventListener("unhandledrejection", count);
})();
)";

/// Where with_origin() writes: in the footer, once a page.
constexpr std::string_view origin_mark = "<div id=\"origin\"></div>\n";

std::string section_id(std::size_t i) { return "section-" + std::to_string(i + 1); }

/// Throws if a script contains text that would end its HTML element or start a comment in it.
std::string in_script(std::string_view program) {
  for (const std::string_view ending : {"</script", "</SCRIPT", "<!--"}) {
    if (program.find(ending) != std::string_view::npos) {
      throw std::logic_error("a program with \"" + std::string(ending) + "\" in it cannot stand in a page");
    }
  }
  return std::string(program);
}

}  // namespace

std::string figure_text(double value, int digits) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  std::string result(text.data());
  if (result == "-0") return "0";
  if (result.starts_with('-')) result.replace(0, 1, "−");
  return result;
}

std::string escaped(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

Report::Report(std::string title, std::string lead) : title_(std::move(title)), lead_(std::move(lead)) {
  if (title_.empty()) throw std::logic_error("a report without a title");
}

void Report::add_section(std::string_view title) {
  if (sections_.empty()) {
    first_ = std::move(body_);
    body_.clear();
  }
  body_ += "<h2 id=\"" + section_id(sections_.size()) + "\">" + escaped(title) + "</h2>\n";
  sections_.emplace_back(title);
}

void Report::add_text(std::string_view paragraph) { body_ += "<p>" + with_meanings(escaped(paragraph)) + "</p>\n"; }

void Report::add_verdict(Verdict verdict, std::string_view sentence) {
  constexpr std::array<std::array<std::string_view, 2>, 3> kinds{{{"good", "✓"}, {"bad", "✗"}, {"remark", "•"}}};
  const auto& [name, sign] = kinds[static_cast<std::size_t>(verdict)];
  body_ += "<div class=\"verdict " + std::string(name) + "\"><b>" + std::string(sign) + "</b>" +
           with_meanings(escaped(sentence)) + "</div>\n";
}

void Report::add_figure(const Figure& figure) {
  const std::string json = plotly_json(figure);
  const std::string number = std::to_string(++figures_);
  body_ += "<figure id=\"figure-" + number + "\"><figcaption>" + escaped(figure.title) +
           "</figcaption>\n<div class=\"plot\" role=\"img\" aria-label=\"" + escaped(figure.title) +
           "\" style=\"height:" + std::to_string(figure.height) + "px\"></div>\n<script type=\"application/json\">" +
           json + "</script>\n";
  if (!figure.note.empty()) body_ += "<p>" + escaped(figure.note) + "</p>\n";
  body_ += "</figure>\n";
}

void Report::add_folded_table(const Table& table) {
  body_ += "<details><summary>" + with_meanings(escaped(table.title)) + "</summary>\n";
  Table unnamed = table;
  unnamed.title.clear();
  add_table(unnamed);
  body_ += "</details>\n";
}

void Report::add_table(const Table& table) {
  const auto cell = [&](const char* tag, std::size_t column, const std::string& text) {
    return std::string("<") + tag + (column < table.text_columns ? " class=\"words\">" : ">") +
           with_meanings(escaped(text)) + "</" + tag + ">";
  };
  constexpr std::size_t short_table = 15;  // rows that stay together on paper
  body_ += std::string("<div class=\"scroll") + (table.rows.size() <= short_table ? " short" : "") + "\"><table>" +
           (table.title.empty() ? "" : "<caption>" + with_meanings(escaped(table.title)) + "</caption>") +
           "\n<thead><tr>";
  for (std::size_t i = 0; i < table.headings.size(); ++i) body_ += cell("th", i, table.headings[i]);
  body_ += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    if (row.size() != table.headings.size()) {
      throw std::logic_error("table \"" + table.title + "\": a row has not as many cells as there are headings");
    }
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) body_ += cell("td", i, row[i]);
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Report::add_appendix(std::string_view title, std::string_view text) {
  appendices_ += "<details><summary>" + escaped(title) + "</summary>\n<pre>" + escaped(text) + "</pre></details>\n";
}

std::string with_origin(std::string page, const Origin& origin) {
  const std::size_t at = page.rfind(origin_mark);
  if (at == std::string::npos) throw std::logic_error("a page without a place for its origin");
  std::string text = "<h2>How this page was made</h2>\n<pre class=\"made\">rigtwin " + std::string(firmware::version) +
                     "\n$ " + escaped(origin.command) + "\n";
  for (const Origin::Input& input : origin.inputs) text += "\n" + input.sha256 + "  " + escaped(input.file);
  if (!origin.inputs.empty()) text += "\n";
  text +=
      "</pre>\n<p>The same version and command with inputs of the same SHA-256 (sha256sum prints it) give this page "
      "again.</p>\n";
  return page.replace(at, origin_mark.size(), text);
}

std::string Report::html() const {
  const std::string name = "rigtwin " + std::string(firmware::version);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"" +
      name + "\">\n<link rel=\"icon\" href=\"data:,\">\n<title>" + escaped(title_) + "</title>\n<style>" +
      std::string(style) + "</style>\n</head>\n<body data-figures=\"" + std::to_string(figures_) +
      "\" data-drawn=\"0\" data-errors=\"0\">\n<script>" + std::string(listening) + "</script>\n<header><h1>" +
      escaped(title_) + "</h1>\n";
  if (!lead_.empty()) page += "<p class=\"lead\">" + escaped(lead_) + "</p>\n";
  page +=
      "</header>\n<noscript><p>The figures of this page need JavaScript; everything they need is in this file.</p>"
      "</noscript>\n<main>\n";
  page += sections_.empty() ? std::string() : first_ + "<nav><ul>\n";
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    page += "<li><a href=\"#" + section_id(i) + "\">" + escaped(sections_[i]) + "</a></li>\n";
  }
  if (!sections_.empty()) page += "</ul></nav>\n";
  page += body_ + "</main>\n<footer>\n<h2>Inputs and licences</h2>\n" + appendices_;
  if (figures_ > 0) {
    page += "<details><summary>Licence of Plotly.js, which draws the figures</summary>\n<pre>" +
            escaped(embedded_file("plotly-LICENSE")) + "</pre></details>\n";
  }
  page += std::string(origin_mark) + "<p>Made by " + name + "." +
          (figures_ > 0 ? " Drag over a figure to zoom, double-click to reset, point at a curve to read values." : "") +
          "</p>\n</footer>\n";
  if (figures_ > 0) {
    page += "<script>" + in_script(embedded_file("plotly-cartesian.min.js")) + "</script>\n<script>" +
            std::string(drawing) + "</script>\n";
  }
  return page + "</body>\n</html>\n";
}

}  // namespace host_sim::report
