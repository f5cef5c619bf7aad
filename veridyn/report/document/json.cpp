#include "veridyn/report/document/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "veridyn/report/document/decimate.hpp"
#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {

namespace {

using nlohmann::json;

// Steps of the stored samples per range: finer than a pixel, also after zooming in some twenty times.
constexpr double kValueSteps = 20000.0;
// Abscissae are zoomed further.
constexpr double kAbscissaSteps = 2e6;

template <typename Enum, std::size_t n>
std::string_view name_of(Enum value, const std::array<std::string_view, n>& names) {
  return names.at(static_cast<std::size_t>(value));
}

std::string_view name_of(Level level) {
  return name_of(level, std::array<std::string_view, 3>{"good", "caution", "bad"});
}
std::string_view name_of(Tone tone) {
  return name_of(tone, std::array<std::string_view, 3>{"plain", "note", "warning"});
}
std::string_view name_of(Role role) {
  return name_of(role, std::array<std::string_view, 3>{"estimate", "measured", "reference"});
}
std::string_view name_of(Style style) {
  return name_of(style, std::array<std::string_view, 3>{"line", "markers", "stems"});
}
std::string_view name_of(SpanTone tone) {
  return name_of(tone, std::array<std::string_view, 4>{"primary", "secondary", "muted", "bad"});
}

std::string_view name_of(SceneTone tone) {
  return name_of(tone, std::array<std::string_view, 5>{"ground", "body", "link", "person", "outline"});
}
std::string_view name_of(SceneShape::Kind kind) {
  return name_of(kind, std::array<std::string_view, 5>{"line", "face", "ball", "actuator", "label"});
}

/// Nine digits are more than any table shows and fewer than a double's noise.
json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  // A p-value may be too small for a normal number, which stod refuses.
  return std::strtod(fmt::format("{:.9g}", value).c_str(), nullptr);
}

json facts_json(const std::vector<Fact>& facts) {
  json list = json::array();
  for (const Fact& fact : facts) list.push_back({{"name", fact.name}, {"value", fact.value}});
  return list;
}

json quantity_json(const Quantity& quantity) { return {{"label", quantity.label}, {"unit", quantity.unit}}; }

/// Counts what was left out, for the footnote.
class Thinning {
 public:
  void add(std::size_t all, std::size_t kept) {
    if (kept >= all) return;
    most_ = std::max(most_, all);
    kept_ = std::max(kept_, kept);
  }
  [[nodiscard]] std::string footnote(std::string_view what) const {
    if (most_ == 0) return "";
    return fmt::format("Drawn from at most {} of {} samples a line: {}.", kept_, most_, what);
  }

 private:
  std::size_t most_ = 0;
  std::size_t kept_ = 0;
};

/// The abscissae of a figure, each sequence once however many lines share it.
class Abscissae {
 public:
  std::size_t index(const std::vector<double>& x) {
    std::vector<double> rounded = round_for_storage(x, kAbscissaSteps);
    const auto [at, is_new] = known_.emplace(std::move(rounded), known_.size());
    if (is_new) list_.push_back(at->first);
    return at->second;
  }
  [[nodiscard]] const json& list() const { return list_; }

 private:
  std::map<std::vector<double>, std::size_t> known_;
  json list_ = json::array();
};

/// Markers need no gaps between them, and non-finite values take no space.
Polyline without_gaps(const std::vector<double>& x, const std::vector<double>& y) {
  Polyline line;
  for (std::size_t k = 0; k < y.size(); ++k) {
    if (!std::isfinite(y[k])) continue;
    line.x.push_back(x[k]);
    line.y.push_back(y[k]);
  }
  return line;
}

json line_json(const Line& line, const std::vector<double>& samples, const JsonOptions& options, Abscissae& abscissae,
               Thinning& thinning) {
  const std::vector<double>& all_x = line.x.empty() ? samples : line.x;
  const Polyline all = line.style == Style::kMarkers ? without_gaps(all_x, line.y) : Polyline{all_x, line.y};
  const Polyline drawn = decimate_line(all.x, all.y, options.points_per_line);
  thinning.add(all.x.size(), drawn.x.size());
  json result = {{"name", line.name},
                 {"role", name_of(line.role)},
                 {"style", name_of(line.style)},
                 {"x", abscissae.index(drawn.x)},
                 {"y", round_for_storage(drawn.y, kValueSteps)}};
  if (line.band && !line.band->low.empty()) {
    const DecimatedBand band = decimate_band(all_x, line.band->low, line.band->high, options.points_per_band);
    result["band"] = {{"x", abscissae.index(band.x)},
                      {"low", round_for_storage(band.low, kValueSteps)},
                      {"high", round_for_storage(band.high, kValueSteps)}};
  }
  return result;
}

json block_json(const Paragraph& paragraph, const JsonOptions&) {
  return {{"kind", "paragraph"}, {"text", paragraph.text}, {"tone", name_of(paragraph.tone)}};
}

json block_json(const List& list, const JsonOptions&) {
  return {{"kind", "list"}, {"items", list.items}, {"tone", name_of(list.tone)}};
}

json block_json(const FactList& list, const JsonOptions&) {
  return {{"kind", "facts"}, {"facts", facts_json(list.facts)}};
}

json block_json(const Table& table, const JsonOptions&) {
  json columns = json::array();
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const Column& column = table.columns[k];
    const Align align = resolved_align(table, k);
    columns.push_back({{"name", column.name},
                       {"unit", column.unit},
                       {"group", column.group},
                       {"align", align == Align::kRight    ? "right"
                                 : align == Align::kCenter ? "center"
                                                           : "left"}});
  }
  json rows = json::array();
  for (const Row& row : table.rows) {
    json cells = json::array();
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const Cell& cell = row.cells[k];
      json content = {{"t", cell_text(cell, table.columns[k])}};
      if (cell.number) content["v"] = number(*cell.number);
      if (cell.status != Status::kNone) content["s"] = status_name(cell.status);
      cells.push_back(std::move(content));
    }
    rows.push_back({{"status", status_name(row.status)}, {"cells", std::move(cells)}});
  }
  return {{"kind", "table"},    {"title", table.title}, {"caption", table.caption},
          {"columns", columns}, {"rows", rows},         {"sortable", table.sortable}};
}

json block_json(const TimeSeries& figure, const JsonOptions& options) {
  Abscissae abscissae;
  Thinning thinning;
  json panels = json::array();
  for (const Panel& panel : figure.panels) {
    json lines = json::array();
    for (const Line& line : panel.lines) lines.push_back(line_json(line, figure.samples, options, abscissae, thinning));
    panels.push_back(
        {{"label", panel.label}, {"unit", panel.unit}, {"height", panel.height}, {"lines", std::move(lines)}});
  }
  json spans = json::array();
  for (const Span& span : figure.spans) {
    spans.push_back(
        {{"from", number(span.from)}, {"to", number(span.to)}, {"label", span.label}, {"tone", name_of(span.tone)}});
  }
  json windows = json::array();
  for (const Window& window : figure.windows) windows.push_back({{"from", window.from}, {"to", window.to}});
  return {{"kind", "time_series"},
          {"title", figure.title},
          {"caption", figure.caption},
          {"footnote", thinning.footnote("the smallest and the largest of every short stretch")},
          {"axis", figure.axis},
          {"x", quantity_json(figure.x)},
          {"xs", abscissae.list()},
          {"panels", std::move(panels)},
          {"spans", std::move(spans)},
          {"windows", std::move(windows)}};
}

json block_json(const XYPlot& plot, const JsonOptions& options) {
  Thinning thinning;
  json series = json::array();
  for (const XYSeries& each : plot.series) {
    const bool in_order = std::is_sorted(each.x.begin(), each.x.end());
    const Polyline drawn = each.x.size() <= options.points_per_line ? Polyline{each.x, each.y}
                           : each.style != Style::kMarkers && in_order
                               ? decimate_line(each.x, each.y, options.points_per_line)
                               : thin_scatter(each.x, each.y, options.points_per_line);
    thinning.add(each.x.size(), drawn.x.size());
    series.push_back({{"name", each.name},
                      {"role", name_of(each.role)},
                      {"style", name_of(each.style)},
                      {"width", each.width},
                      {"opacity", each.opacity},
                      {"x", round_for_storage(drawn.x, kValueSteps)},
                      {"y", round_for_storage(drawn.y, kValueSteps)}});
  }
  json guides = json::array();
  for (const Guide& guide : plot.guides) {
    guides.push_back({{"direction", guide.direction == Guide::Direction::kHorizontal ? "horizontal" : "vertical"},
                      {"value", number(guide.value)},
                      {"label", guide.label}});
  }
  json areas = json::array();
  for (const XYArea& area : plot.areas) {
    json each = {{"name", area.name}, {"x", json::array()}, {"low", json::array()}, {"high", json::array()}};
    for (std::size_t k = 0; k < area.x.size(); ++k) {
      each["x"].push_back(number(area.x[k]));
      each["low"].push_back(number(area.low[k]));
      each["high"].push_back(number(area.high[k]));
    }
    areas.push_back(std::move(each));
  }
  return {{"kind", "xy"},
          {"title", plot.title},
          {"caption", plot.caption},
          {"footnote", thinning.footnote("where points cover each other, one is left")},
          {"x", quantity_json(plot.x)},
          {"y", quantity_json(plot.y)},
          {"height", plot.height},
          {"equal_axes", plot.equal_axes},
          {"equal_scale", plot.equal_scale},
          {"log_x", plot.log_x},
          {"series", std::move(series)},
          {"areas", std::move(areas)},
          {"guides", std::move(guides)}};
}

json block_json(const IntervalPlot& plot, const JsonOptions&) {
  json rows = json::array();
  for (const IntervalRow& row : plot.rows) {
    json estimates = json::array();
    for (std::size_t k = 0; k < row.estimates.size(); ++k) {
      const Interval& each = row.estimates[k];
      estimates.push_back({{"method", k},
                           {"value", number(each.value)},
                           {"low", number(each.low)},
                           {"high", number(each.high)},
                           {"status", status_name(each.status)}});
    }
    rows.push_back({{"name", row.name},
                    {"unit", row.unit},
                    {"reference", row.reference ? number(*row.reference) : json(nullptr)},
                    {"estimates", std::move(estimates)}});
  }
  return {{"kind", "intervals"},
          {"title", plot.title},
          {"caption", plot.caption},
          {"methods", plot.methods},
          {"reference", plot.reference_name},
          {"shared_scale", plot.shared_scale},
          {"rows", std::move(rows)}};
}

json block_json(const Matrix& matrix, const JsonOptions&) {
  json values = json::array();
  for (const std::vector<double>& row : matrix.values) {
    json line = json::array();
    for (const double value : row) line.push_back(number(value));
    values.push_back(std::move(line));
  }
  return {{"kind", "matrix"},
          {"title", matrix.title},
          {"caption", matrix.caption},
          {"rows", matrix.row_names},
          {"columns", matrix.column_names},
          {"values", std::move(values)},
          {"low", matrix.low},
          {"high", matrix.high},
          {"decimals", matrix.decimals}};
}

json block_json(const Scene& scene, const JsonOptions&) {
  json shapes = json::array();
  for (const SceneShape& shape : scene.shapes) {
    json points = json::array();
    for (const ScenePoint& p : shape.points) points.push_back({number(p.x), number(p.y), number(p.z), p.moves ? 1 : 0});
    shapes.push_back({{"kind", name_of(shape.kind)},
                      {"tone", name_of(shape.tone)},
                      {"points", std::move(points)},
                      {"size", number(shape.size)},
                      {"text", shape.text}});
  }
  json joints = json::array();
  for (const SceneJoint& joint : scene.joints) {
    joints.push_back({{"name", joint.name},
                      {"unit", joint.unit},
                      {"turns", joint.turns},
                      {"direction", joint.direction},
                      {"scale", number(joint.scale)}});
  }
  json motions = json::array();
  for (const SceneMotion& motion : scene.motions) {
    json values = json::array();
    for (const std::vector<double>& each : motion.values) values.push_back(round_for_storage(each, kValueSteps));
    motions.push_back({{"name", motion.name}, {"values", std::move(values)}});
  }
  return {{"kind", "scene"},
          {"title", scene.title},
          {"caption", scene.caption},
          {"axis", scene.axis},
          {"x", quantity_json(scene.x)},
          {"samples", round_for_storage(scene.samples, kAbscissaSteps)},
          {"shapes", std::move(shapes)},
          {"joints", std::move(joints)},
          {"motions", std::move(motions)},
          {"choice", scene.choice},
          {"height", scene.height}};
}

/// These three occur in strings only; escaped there, no text can end the <script> element or begin a comment in it.
std::string escape_markup(const std::string& text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      result += "\\u003c";
    } else if (c == '>') {
      result += "\\u003e";
    } else if (c == '&') {
      result += "\\u0026";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

std::string to_json(const Document& document, const JsonOptions& options) {
  check(document);
  const auto blocks_json = [&options](const std::vector<Block>& blocks) {
    json all = json::array();
    for (const Block& block : blocks)
      all.push_back(std::visit([&options](const auto& each) { return block_json(each, options); }, block));
    return all;
  };
  const std::vector<std::string> ids = section_ids(document);
  json sections = json::array();
  for (std::size_t k = 0; k < document.sections.size(); ++k) {
    const Section& section = document.sections[k];
    sections.push_back({{"title", section.title},
                        {"id", ids[k]},
                        {"folded", section.folded},
                        {"inside", section.inside},
                        {"blocks", blocks_json(section.blocks)}});
  }
  const json result = {{"format", "veridyn-report"},
                       {"version", 1},
                       {"generator", document.generator},
                       {"title", document.title},
                       {"subtitle", document.subtitle},
                       {"verdict",
                        {{"level", name_of(document.verdict.level)},
                         {"word", verdict_word(document.verdict)},
                         {"headline", document.verdict.headline},
                         {"lines", document.verdict.lines}}},
                       {"lead", blocks_json(document.lead)},
                       {"facts", facts_json(document.facts)},
                       {"sections", std::move(sections)}};
  return escape_markup(result.dump(-1, ' ', true, json::error_handler_t::replace));
}

}  // namespace veridyn::report
