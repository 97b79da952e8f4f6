#include "host_sim/manual/manual.hpp"

#include <md4c-html.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/manual/small_plot.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::manual {
namespace {

constexpr double unchanged = 1e-3;  ///< rms of the change ÷ rms, below which a channel is only named

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

std::string code(std::string_view text) { return "<code>" + report::escaped(text) + "</code>"; }

std::string per_cent(double change) {
  char text[32];
  std::snprintf(text, sizeof text, change < 0.0995 ? "%.2g %%" : "%.0f %%", 100.0 * change);
  return text;
}

/// Equation, how it shows, parameters.
std::string card(const EffectPicture& picture) {
  const firmware::CatalogueEntry& entry = *picture.entry;
  std::string text = "<p>" + code(entry.equation) + "</p>\n<p>Shows as " + report::escaped(entry.shows) + ".";
  for (const model::EffectParameter& p : entry.parameters) {
    text += " " + code(p.name) + " [" + report::escaped(p.unit) + "]: " + report::figure_text(p.lower, 3) + " to " +
            report::figure_text(p.upper, 3) + ".";
  }
  return text + "</p>\n";
}

std::string plot_of(const ChannelPicture& channel, const std::string& title, double window) {
  return svg({.title = title,
              .change = "changes by " + per_cent(channel.change),
              .unit = std::string(model::unit(channel.channel)),
              .duration = window,
              .without = channel.without,
              .with = channel.with}) +
         "\n";
}

std::string pictures_html(const std::vector<EffectPicture>& pictures) {
  std::string html = "<nav><ul>\n";
  for (const EffectPicture& picture : pictures) {
    const std::string name(picture.entry->name);
    html += "<li><a href=\"#effect-" + name + "\">" + name + "</a></li>\n";
  }
  html += "</ul></nav>\n";
  for (const EffectPicture& picture : pictures) {
    html += "<section class=\"effect\" id=\"effect-" + std::string(picture.entry->name) + "\">\n<h3>" +
            report::escaped(picture.entry->name) + "</h3>\n" + card(picture) + "<p class=\"lead\">Here on " +
            code(picture.rig) + ", " + report::escaped(picture.values) + ".</p>\n<div class=\"plots\">\n";
    std::string same;
    for (const ChannelPicture& channel : picture.channels) {
      const std::string name(model::name(channel.channel));
      if (channel.change < unchanged) {
        same += (same.empty() ? "" : ", ") + name;
      } else {
        html += plot_of(channel, name, picture.window);
      }
    }
    if (picture.on_bench) html += plot_of(*picture.on_bench, "F on a bench", picture.window);
    html += "</div>\n";
    if (!same.empty()) html += "<p class=\"lead\">Not changed, by less than 0.1 %: " + same + ".</p>\n";
    html += "</section>\n";
  }
  return html;
}

/// Styles of what only the manual has.
constexpr std::string_view manual_style = R"(<style>
h3 { font-size: 1.08rem; margin: 1.8rem 0 .4rem; }
main > ul, main > ol, main li { max-width: 50rem; }
main li { margin: .25rem 0; }
main table { display: block; overflow-x: auto; }
main table th, main table td { text-align: left; white-space: normal; min-width: 6rem; }
pre.run { background: #eef6fb; border-left: 4px solid #0072B2; margin-bottom: 0; }
pre.output { margin-top: 0; border-left: 4px solid #ccc; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: .5rem 1rem; }
svg.small { width: 100%; box-sizing: border-box; background: #fafafa; border: 1px solid #ddd; }
svg.small text { font-size: 10px; fill: #333; }
svg.small .without { fill: none; stroke: #aaa; stroke-width: 2.6; }
svg.small .with { fill: none; stroke: #0072B2; stroke-width: 1; }
svg.small .difference { fill: none; stroke: #D55E00; stroke-width: 1; }
@media print {
  .plots { grid-template-columns: repeat(3, 1fr); }
  section.effect > h3, section.effect > p, h3 { break-after: avoid; }
  svg.small { break-inside: avoid; }
  pre.run { break-after: avoid; }
}
</style>
)";

void run_block(const Chapter& chapter, const Part& part, Workshop& workshop, Manual& manual, report::Report& page) {
  Executed executed{chapter.file, part.line, part.text, workshop.run(part.text)};
  if (executed.ended.status != 0) {
    throw firmware::InputError(chapter.file, part.line,
                               "these commands end with status " + std::to_string(executed.ended.status) + ": " +
                                   part.text + " -> " + executed.ended.output,
                               "status 0");
  }
  if (const std::string missing = missing_line(part.expected, executed.ended.output); !missing.empty()) {
    throw firmware::InputError(chapter.file, part.line,
                               "these commands do not print what is shown of them: " + executed.ended.output, missing);
  }
  page.add_html("<pre class=\"run\">" + report::escaped(part.text) + "</pre>\n");
  const std::string shown = shown_output(executed.ended.output, part.shown);
  if (!part.excerpt && !shown.empty()) page.add_html("<pre class=\"output\">" + report::escaped(shown) + "</pre>\n");
  manual.executed.push_back(std::move(executed));
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The number in a word such as "(0.0099994", "12.84°" or "±2.5"; NaN where there is none.
double number_in(const std::string& word) {
  const std::size_t first = word.find_first_of("-0123456789");
  if (first == std::string::npos) return std::nan("");
  return std::strtod(word.c_str() + first, nullptr);
}

bool is_like(const std::string& shown, const std::string& printed) {
  constexpr double rounding = 0.02;  // relative
  const auto a = words_of(shown), b = words_of(printed);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const std::string& left, const std::string& right) {
    const double x = number_in(left), y = number_in(right);
    return left == right || std::abs(x - y) <= rounding * std::abs(x);
  });
}

void append(const MD_CHAR* text, MD_SIZE size, void* all) { static_cast<std::string*>(all)->append(text, size); }

}  // namespace

std::string markdown_html(const std::string& markdown) {
  std::string html;
  if (md_html(markdown.data(), static_cast<MD_SIZE>(markdown.size()), append, &html, MD_FLAG_TABLES | MD_FLAG_NOHTML,
              0) != 0) {
    throw std::runtime_error("Markdown that cannot be read");
  }
  for (int level = 5; level >= 1; --level) {
    for (const char* bracket : {"<h", "</h"}) {
      replace_all(html, bracket + std::to_string(level) + ">", bracket + std::to_string(level + 1) + ">");
    }
  }
  return html;
}

std::string shown_output(const std::string& output, std::size_t lines) {
  if (lines == 0) return output;
  std::size_t end = 0;
  for (std::size_t line = 0; line < lines && end < output.size(); ++line) {
    end = std::min(output.find('\n', end), output.size() - 1) + 1;
  }
  return end < output.size() ? output.substr(0, end) + "…\n" : output;
}

std::string missing_line(const std::vector<std::string>& excerpt, const std::string& output) {
  std::istringstream printed(output);
  for (const std::string& shown : excerpt) {
    bool found = false;
    for (std::string line; !found && std::getline(printed, line);) found = is_like(shown, line);
    if (!found) return shown;
  }
  return {};
}

Manual make_manual(const std::vector<Chapter>& chapters, Workshop& workshop,
                   const std::vector<EffectPicture>& pictures) {
  Manual manual;
  report::Report page("rigtwin: the manual",
                      "From a record to a named effect to a running controller. All outputs are those of the commands "
                      "above them, run when "
                      "this page was made.");
  page.add_html(manual_style);
  for (const Chapter& chapter : chapters) {
    page.add_section(chapter.title);
    for (const Part& part : chapter.parts) {
      switch (part.kind) {
        case Part::Kind::text:
          page.add_html(markdown_html(part.text));
          break;
        case Part::Kind::commands:
          run_block(chapter, part, workshop, manual, page);
          break;
        case Part::Kind::catalogue:
          page.add_html(pictures_html(pictures));
          break;
      }
    }
  }
  manual.html = page.html();
  return manual;
}

}  // namespace host_sim::manual
