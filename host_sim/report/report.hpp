// Results as one HTML file with interactive figures, tables, verdicts and the inputs.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// All texts are plain UTF-8; the report escapes them. Names of channels in them show their meaning when pointed at
/// (channel_glossary.hpp).
namespace host_sim::report {

/// An axis of a figure: quantity and unit.
struct Axis {
  std::string quantity;  ///< "wheel load ÷ road"; never empty
  std::string unit;      ///< "N/m", "1" for a pure number; never empty, except beside names
  bool logarithmic = false;
  bool of_names = false;                             ///< a category axis with the names of bars
  std::optional<std::pair<double, double>> range{};  ///< initial range in `unit`; default: all data
};

enum class Dash : unsigned char { by_turns, solid, dashed, dotted, dash_dotted, none };
enum class Marker : unsigned char { none, circle, square, diamond, cross, open_circle };

/// Points, joined or not. A gap is a NaN.
struct Curve {
  std::string name;  ///< for legend and read-out
  std::vector<double> x, y;
  int colour = -1;  ///< of the palette (report::colours), −1: the next one
  Dash dash = Dash::by_turns;
  Marker marker = Marker::none;
  bool in_legend = true;
  std::vector<double> along{};  ///< third value in the read-out, such as the frequency on a Nyquist curve
  std::string along_quantity{}, along_unit{};        ///< its quantity and unit
  bool coloured_along = false;                       ///< colours the markers by `along`, with a colour scale
  std::vector<double> lower_error{}, upper_error{};  ///< error bars of y, as distances; empty: none
};

/// A bar from zero for each name; they lie along the panel's y axis, which is of_names.
struct Bars {
  std::string name;
  std::vector<std::string> names;
  std::vector<double> values;
  int colour = -1;
};

/// Colours over a plane: blue below zero, orange above, white at zero.
struct HeatMap {
  std::string quantity, unit;
  std::vector<double> x, y;
  std::vector<double> values;  ///< row after row of constant y
  double limit = 0.0;          ///< colour range ± limit; 0: the largest modulus
};

/// A straight line across a panel with a label.
struct Guide {
  enum class Along : unsigned char { x, y };  ///< which axis `value` belongs to
  Along along = Along::x;
  double value = 0.0;
  std::string label{};
};

/// One of the stacked parts of a figure; all share its x axis.
struct Panel {
  Axis y;
  std::vector<Curve> curves{};
  std::vector<Bars> bars{};
  std::vector<HeatMap> heat_map{};  ///< one at most
  std::vector<Guide> guides{};
  double share = 1.0;  ///< of the height, relative to the others
};

struct Figure {
  std::string title;
  std::string note;  ///< explanation under the figure
  Axis x;
  std::vector<Panel> panels{};
  bool equal_axes = false;  ///< equal scales of x and y: Nyquist
  int height = 420;         ///< [px]
};

struct Table {
  std::string title;
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;
  std::size_t text_columns = 1;  ///< number of text columns from the left; the others are numbers
};

/// Kind of a verdict box; each has a colour and a sign, so that no information depends on colour alone.
enum class Verdict : unsigned char { good, bad, remark };

/// Okabe and Ito's colours without the yellow, which is too pale for a line; black comes last.
inline constexpr std::string_view colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                               "#56B4E9", "#E69F00", "#000000"};

/// Collects parts in order and writes them as one HTML file. Equal parts give equal bytes.
///
/// The file is self-contained: Plotly, the data of the figures and the style are in it. For tests the page counts in
/// attributes of its body: data-figures, data-drawn, data-traces (figures with a visible curve), data-requests (network
/// requests), data-errors. An invalid part (an axis without a unit, columns of different lengths, an empty figure) is a
/// std::logic_error when it is added.
class Report {
 public:
  /// \param title  of the page; `lead` is the sentence under it
  explicit Report(std::string title, std::string lead = {});

  void add_section(std::string_view title);  ///< listed in the contents
  void add_text(std::string_view paragraph);
  void add_verdict(Verdict verdict, std::string_view sentence);
  /// A piece of HTML as it is: the caller answers for it. The manual's text; not for words of a user.
  void add_html(std::string_view trusted) { body_ += trusted; }
  void add_figure(const Figure& figure);
  void add_table(const Table& table);
  void add_folded_table(const Table& table);  ///< its title unfolds it; unfolded on paper
  /// A folded section at the end with the text as given, such as a rig description; not on paper.
  void add_appendix(std::string_view title, std::string_view text);

  [[nodiscard]] std::string html() const;
  [[nodiscard]] std::size_t figures() const { return figures_; }

 private:
  std::string title_, lead_, body_, appendices_;
  std::vector<std::string> sections_;
  std::size_t figures_ = 0;
  std::string first_;  // parts before the table of contents
};

/// How a page was made.
struct Origin {
  struct Input {
    std::string file;    ///< as the user named it
    std::string sha256;  ///< of its bytes
  };
  std::string command;
  std::vector<Input> inputs{};
};

/// `page`, the text of a Report, with version, command and inputs in its footer, so that it can be made again.
[[nodiscard]] std::string with_origin(std::string page, const Origin& origin);

/// The number with `digits` significant digits: 15.25, −0.0031, 4.5e-07.
[[nodiscard]] std::string figure_text(double value, int digits = 4);

/// Escaped for HTML text and quoted attributes.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace host_sim::report
