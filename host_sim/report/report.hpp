// One HTML file that shows results: figures to zoom and read off, tables, verdicts, and where it all comes from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What goes in is plain text in UTF-8: it is escaped on its way out, whatever it holds.
namespace host_sim::report {

/// What is measured along a side of a figure.
struct Axis {
  std::string quantity;  ///< "wheel load ÷ road"; never empty
  std::string unit;      ///< "N/m", "1" for a pure number; never empty, except beside names
  bool logarithmic = false;
  bool of_names = false;                             ///< bars stand along it, each with its name
  std::optional<std::pair<double, double>> range{};  ///< shown at first, in `unit`; else all there is
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
  std::vector<double> along{};                       ///< read out beside x and y: the frequency on a Nyquist curve …
  std::string along_quantity{}, along_unit{};        ///< … what that is
  bool coloured_along = false;                       ///< markers coloured by it, with a scale beside the figure
  std::vector<double> lower_error{}, upper_error{};  ///< of y, as distances from it; empty: not known
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
  double limit = 0.0;          ///< colours end at ± this; 0: at the largest modulus
};

/// A line across a panel, with a few words at its end.
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
  std::string note;  ///< what to see in it: under the figure
  Axis x;
  std::vector<Panel> panels{};
  bool equal_axes = false;  ///< a unit of x is as long as one of y: Nyquist
  int height = 420;         ///< [px]
};

struct Table {
  std::string title;
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;
  std::size_t text_columns = 1;  ///< that many columns from the left are words, the others numbers
};

/// Colour, sign and word of a box: a colour alone would not do.
enum class Verdict : unsigned char { good, bad, remark };

/// Okabe and Ito's colours without the yellow, which is too pale for a line; black comes last.
inline constexpr std::string_view colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                               "#56B4E9", "#E69F00", "#000000"};

/// Collects parts in their order and makes one HTML file of them. The same parts give the same bytes.
///
/// The file asks for nothing from elsewhere: Plotly, the figures' numbers and the style are in it. Once every figure is
/// drawn the page says so in attributes of its body – data-figures, data-drawn,
/// data-traces (figures with something in them), data-requests, data-errors – for whoever tests it.
/// A part that cannot be right – an axis without a unit, columns of different lengths, nothing to see – is a
/// std::logic_error of the caller when it is added.
class Report {
 public:
  /// \param title  of the page; `lead` stands under it
  explicit Report(std::string title, std::string lead = {});

  void add_section(std::string_view title);  ///< listed in the contents
  void add_text(std::string_view paragraph);
  void add_verdict(Verdict verdict, std::string_view sentence);
  void add_figure(const Figure& figure);
  void add_table(const Table& table);
  /// At the end, folded up, letter by letter as given: a rig description.
  void add_appendix(std::string_view title, std::string_view text);

  [[nodiscard]] std::string html() const;
  [[nodiscard]] std::size_t figures() const { return figures_; }

 private:
  std::string title_, lead_, body_, appendices_;
  std::vector<std::string> sections_;
  std::size_t figures_ = 0;
  std::string first_;  // what stands before the contents
};

/// The number with so many significant digits, as a person writes it: 15.25, −0.0031, 4.5e-07.
[[nodiscard]] std::string figure_text(double value, int digits = 4);

/// Fit to stand between HTML tags and in quoted attributes.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace host_sim::report
