#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// A report as data: what is shown, not how. No domain in here; a domain fills these plain structs, `to_html` makes
/// the page. Texts are UTF-8 and always shown as they are, never interpreted as HTML: they may come from a log.
/// Every field has a default, so designated initialisers may name the few that matter.
/// A NaN or infinite number is a missing one (a gap in a line, a dash in a table). Units are texts in square-bracket
/// style without the brackets ("m/s", "deg", "" for none) and numbers are in that unit: convert before filling in.
namespace veridyn::report {

/// What became of an estimate, shown as a coloured badge. The first nine are those of `estimate.json`.
enum class Status {
  kNone,           ///< no badge
  kIdentified,     ///< trust it
  kInsignificant,  ///< not distinguishable from zero
  kWeak,           ///< distinguishable from zero, but with a wide interval
  kEffective,      ///< predicts, but is no physical constant
  kImplausible,    ///< no individual of this kind has such a value
  kAtBound,        ///< its search ended at the limit of what was allowed
  kNotExcited,     ///< the data hold nothing about it
  kRejected,       ///< estimated, but wrong by some check
  kFixed,          ///< given, not estimated
  kGood,           ///< a check passed
  kCaution,        ///< a check passed with a reservation
  kBad,            ///< a check failed
};

/// "identified", "not_excited", ...: the words of `estimate.json`; "" for `kNone`.
[[nodiscard]] std::string_view status_name(Status status);
/// The same in plain words: "not excited".
[[nodiscard]] std::string_view status_label(Status status);
/// The status of such a word; `kNone` for any other.
[[nodiscard]] Status status_from_name(std::string_view name);

/// How a verdict is shown: green, amber, red.
enum class Level { kGood, kCaution, kBad };

/// What a pilot reads before anything else.
struct Verdict {
  Level level = Level::kCaution;
  /// One or two words; when empty "Usable", "Use with care" or "Do not use", by level.
  std::string word = {};
  std::string headline = {};            ///< one sentence
  std::vector<std::string> lines = {};  ///< a few more, in plain words
};

/// The verdict's word, that of its level when none is given.
[[nodiscard]] std::string_view verdict_word(const Verdict& verdict);

/// "Aircraft: Skywalker X8".
struct Fact {
  std::string name = {};
  std::string value = {};
};

/// How a text is set: as body text, small, or marked as a warning.
enum class Tone { kPlain, kNote, kWarning };

/// Running text.
struct Paragraph {
  std::string text = {};
  Tone tone = Tone::kPlain;
};

/// Short items; with `kWarning` the place for a run's warnings.
struct List {
  std::vector<std::string> items = {};
  Tone tone = Tone::kPlain;
};

/// Names and values, set in columns: options, versions, seeds.
struct FactList {
  std::vector<Fact> facts = {};
};

/// A cell of a table: a number, a text, or a badge (whose text, when given, replaces the status's label).
struct Cell {
  std::optional<double> number = {};
  /// Decimals shown; when empty as many as the column's significant digits need.
  std::optional<int> decimals = {};
  std::string text = {};
  Status status = Status::kNone;
};

/// A text.
[[nodiscard]] Cell text_cell(std::string text);
/// A number with the digits of its column.
[[nodiscard]] Cell number_cell(double value);
/// A number with so many decimals.
[[nodiscard]] Cell number_cell(double value, int decimals);
/// A badge; `text` replaces its words.
[[nodiscard]] Cell status_cell(Status status, std::string text = {});
/// A value with as many decimals as its standard deviation has at two significant digits: 0.4231 with sigma 0.0123 is
/// "0.423". Use it for the value, its sigma and the ends of its interval alike. Falls back to the column's digits when
/// sigma is not a positive number.
[[nodiscard]] Cell measured_cell(double value, double sigma);

/// Where the texts of a column stand.
enum class Align {
  kAuto,  ///< right when the column holds numbers, left otherwise
  kLeft,
  kRight,
  kCenter,
};

/// Head of a column and how its cells are set.
struct Column {
  std::string name = {};
  std::string unit = {};
  Align align = Align::kAuto;
  int digits = 4;          ///< significant digits of numbers without `decimals`
  std::string group = {};  ///< neighbours of one group stand under a common head ("OLS", "TLS")
};

/// A row of a table.
struct Row {
  std::vector<Cell> cells = {};  ///< as many as columns
  /// Colours the row's margin and softens what should not be used; shows no badge by itself.
  Status status = Status::kNone;
};

/// Rows under named columns; `sortable` by a click on a head.
struct Table {
  std::string title = {};
  std::string caption = {};
  std::vector<Column> columns = {};
  std::vector<Row> rows = {};
  bool sortable = true;
};

/// Label and unit of an axis or a panel.
struct Quantity {
  std::string label = {};
  std::string unit = {};
};

/// What a line stands for, which decides its colour and weight.
enum class Role {
  kEstimate,   ///< coloured
  kMeasured,   ///< grey, thin
  kReference,  ///< dashed: truth, a model line, a bound
};

/// How samples are drawn.
enum class Style {
  kLine,
  kMarkers,
  kStems,  ///< lines from zero (`XYPlot` only)
};

/// Lower and upper end of an uncertainty band, sample by sample of the line it belongs to.
struct Band {
  std::vector<double> low = {};
  std::vector<double> high = {};
};

/// A line of a panel. Lines of the same name and role have the same colour in all panels of a figure.
struct Line {
  std::string name = {};
  std::vector<double> y = {};
  /// 95 % band; sizes as `y`. Empty for none.
  std::optional<Band> band = {};
  /// Abscissae of a line that is sampled otherwise than the figure; empty: the figure's.
  std::vector<double> x = {};
  Role role = Role::kEstimate;
  Style style = Style::kLine;
};

/// One ordinate of a time series with its lines.
struct Panel {
  std::string label = {};
  std::string unit = {};
  std::vector<Line> lines = {};
  int height = 150;  ///< [CSS px]
};

/// Shade of a span.
enum class SpanTone { kPrimary, kSecondary, kMuted, kBad };

/// A shaded piece of the abscissa: "identification", "hold-out", "no GNSS".
struct Span {
  double from = 0.0;
  double to = 0.0;
  std::string label = {};
  SpanTone tone = SpanTone::kPrimary;
};

/// A piece of the abscissa.
struct Window {
  double from = 0.0;
  double to = 0.0;  ///< after `from`
};

/// Panels stacked over one abscissa. Figures of equal `axis` zoom together and share the cursor.
struct TimeSeries {
  std::string title = {};
  std::string caption = {};
  Quantity x = {.label = "time", .unit = "s"};
  std::vector<double> samples = {};  ///< abscissae, increasing
  std::vector<Panel> panels = {};
  std::vector<Span> spans = {};
  std::string axis = "time";
  /// When not empty, these alone are shown, side by side, each with its own part of the width: short stretches of a
  /// long recording would else be slivers. Increasing, and they do not overlap.
  std::vector<Window> windows = {};
};

/// Points of an XY plot, as markers or joined.
struct XYSeries {
  std::string name = {};
  std::vector<double> x = {};
  std::vector<double> y = {};
  Role role = Role::kEstimate;
  Style style = Style::kMarkers;
  double width = 0.0;    ///< of a line, or of a marker [CSS px]; 0: by role
  double opacity = 1.0;  ///< 0 to 1
};

/// A shaded region of a plot between two lines: a mask, a tolerance.
struct XYArea {
  std::string name = {};
  std::vector<double> x = {};  ///< increasing
  /// A value that is not finite: as far as the plot goes.
  std::vector<double> low = {}, high = {};
};

/// A dashed line across a plot, such as the bound of white noise.
struct Guide {
  enum class Direction { kHorizontal, kVertical };
  Direction direction = Direction::kHorizontal;
  double value = 0.0;
  std::string label = {};
};

/// Points or lines over a free abscissa: normal probability plot, autocorrelation, fit against measured. Neighbours in
/// a section stand side by side where the page is wide enough.
struct XYPlot {
  std::string title = {};
  std::string caption = {};
  Quantity x = {};
  Quantity y = {};
  std::vector<XYSeries> series = {};
  std::vector<Guide> guides = {};
  std::vector<XYArea> areas = {};
  bool log_x = false;        ///< decades along the abscissa; what is not above zero is not drawn
  bool equal_axes = false;   ///< the same range on both axes
  bool equal_scale = false;  ///< a unit as long on one axis as on the other: a drawing of something in space
  int height = 260;          ///< [CSS px]
};

/// An estimate with its 95 % interval; NaN ends: no interval; NaN value: none by this method.
struct Interval {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
  Status status = Status::kNone;
};

/// The estimates of one parameter, and its reference (the truth, a published value) where there is one.
struct IntervalRow {
  std::string name = {};
  std::string unit = {};
  std::vector<Interval> estimates = {};  ///< in the order of the plot's methods
  std::optional<double> reference = {};
};

/// Estimates of several methods side by side, a row per parameter.
struct IntervalPlot {
  std::string title = {};
  std::string caption = {};
  std::vector<std::string> methods = {};
  std::string reference_name = "reference";
  std::vector<IntervalRow> rows = {};
  /// One scale for all rows; otherwise each has its own (parameters differ by orders of magnitude).
  bool shared_scale = false;
};

/// A small matrix as a heat map, such as the correlation of parameters.
struct Matrix {
  std::string title = {};
  std::string caption = {};
  std::vector<std::string> row_names = {};
  std::vector<std::string> column_names = {};
  std::vector<std::vector<double>> values = {};  ///< by rows
  double low = -1.0;                             ///< value of the full colour; below zero: two colours, meeting at zero
  double high = 1.0;
  int decimals = 2;
};

/// A place in space: forward, left, up [m], of what moves or of the ground.
struct ScenePoint {
  double x = 0.0, y = 0.0, z = 0.0;
  bool moves = false;
};

/// What a shape of a scene stands for, which decides its colour.
enum class SceneTone {
  kGround,   ///< what stands still
  kBody,     ///< what moves
  kLink,     ///< what lies between
  kPerson,   ///< somebody who is carried
  kOutline,  ///< dashed: where the body is at rest
};

/// A piece of a drawing in space.
struct SceneShape {
  enum class Kind {
    kLine,      ///< through its points
    kFace,      ///< a polygon
    kBall,      ///< one point
    kActuator,  ///< from foot to head: a rod that slides in a cylinder
    kLabel,     ///< one point with a text
  };
  Kind kind = Kind::kLine;
  SceneTone tone = SceneTone::kGround;
  std::vector<ScenePoint> points = {};
  double size = 2.0;  ///< width of a line [CSS px]; radius of a ball, length of a cylinder [m]
  std::string text = {};
};

/// One of the joints that carry a scene's body, each on the one before, the first on the ground: a shift along or a
/// turn about a direction (right-hand rule).
struct SceneJoint {
  std::string name = {};
  std::string unit = {};
  bool turns = false;
  std::array<double, 3> direction = {1.0, 0.0, 0.0};  ///< forward, left, up; of length 1
  double scale = 1.0;                                 ///< of one unit [m or rad]
};

/// What the joints do: values in their units, by joint and sample.
struct SceneMotion {
  std::string name = {};
  std::vector<std::vector<double>> values = {};
};

/// A drawing in space that moves with a slider of time, seen from wherever it is turned to. Its time is marked in the
/// figures of equal `axis`; a time series that follows it stands next to it where the page is wide enough. Samples are
/// stored as they are (thin them out before), and drawn with straight lines between them.
struct Scene {
  std::string title = {};
  std::string caption = {};
  Quantity x = {.label = "time", .unit = "s"};
  std::vector<double> samples = {};  ///< abscissae, increasing
  std::string axis = "time";
  std::vector<SceneShape> shapes = {};
  std::vector<SceneJoint> joints = {};
  std::vector<SceneMotion> motions = {};  ///< one is shown at a time
  std::string choice = "motion";          ///< what distinguishes motions: "algorithm"
  int height = 420;                       ///< [CSS px]
};

/// Whatever a section may hold.
using Block = std::variant<Paragraph, List, FactList, Table, TimeSeries, XYPlot, IntervalPlot, Matrix, Scene>;

/// A titled part of a report.
struct Section {
  std::string title = {};
  /// Link target of the table of contents; made from the title when empty, made unique in any case.
  std::string id = {};
  std::vector<Block> blocks = {};
  bool folded = false;      ///< shown on a click (and always on paper)
  std::string inside = {};  ///< said beside the title, also while folded; empty: how many tables and figures
};

/// A whole report.
struct Document {
  std::string title = {};
  std::string subtitle = {};
  Verdict verdict = {};
  /// What an engineer of the field looks at first, on the first screen below the verdict: measured against model.
  /// Figures stand side by side where the page is wide enough.
  std::vector<Block> lead = {};
  std::vector<Fact> facts = {};
  std::vector<Section> sections = {};
  std::string generator = "Made with Veridyn";  ///< last line of the page: program and version
};

/// Checks shapes: cells per row, samples per line and band, estimates per method, rows of a matrix.
/// A violation is a programming error: asserts, naming the block.
void check(const Document& document);

/// The document with every caption at the first block that has it alone: what explains ten plots alike is said once.
[[nodiscard]] Document with_captions_once(Document document);

/// The sections' link targets: lower-case letters, digits and dashes, all different.
[[nodiscard]] std::vector<std::string> section_ids(const Document& document);

}  // namespace veridyn::report
