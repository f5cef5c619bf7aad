#include "veridyn/report/document/document.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <utility>

#include "veridyn/core/assert.hpp"

namespace veridyn::report {

namespace {

struct StatusWords {
  Status status;
  std::string_view name;
  std::string_view label;
};

constexpr std::array kStatusWords = {
    StatusWords{Status::kNone, "", ""},
    StatusWords{Status::kIdentified, "identified", "identified"},
    StatusWords{Status::kInsignificant, "insignificant", "insignificant"},
    StatusWords{Status::kWeak, "weak", "weak"},
    StatusWords{Status::kEffective, "effective", "effective"},
    StatusWords{Status::kImplausible, "implausible", "implausible"},
    StatusWords{Status::kAtBound, "at_bound", "at its bound"},
    StatusWords{Status::kNotExcited, "not_excited", "not excited"},
    StatusWords{Status::kRejected, "rejected", "rejected"},
    StatusWords{Status::kFixed, "fixed", "fixed"},
    StatusWords{Status::kGood, "good", "good"},
    StatusWords{Status::kCaution, "caution", "caution"},
    StatusWords{Status::kBad, "bad", "bad"},
};

const StatusWords& words(Status status) {
  for (const StatusWords& each : kStatusWords) {
    if (each.status == status) return each;
  }
  return kStatusWords[0];
}

void check_block(const Table& table) {
  for (const Row& row : table.rows) VERIDYN_ASSERT(row.cells.size() == table.columns.size());
}

void check_block(const TimeSeries& figure) {
  for (const Panel& panel : figure.panels) {
    for (const Line& line : panel.lines) {
      VERIDYN_ASSERT(line.y.size() == (line.x.empty() ? figure.samples.size() : line.x.size()));
      VERIDYN_ASSERT(line.style != Style::kStems);
      if (line.band) {
        VERIDYN_ASSERT(line.band->low.size() == line.y.size() && line.band->high.size() == line.y.size());
      }
    }
  }
  for (std::size_t k = 0; k < figure.windows.size(); ++k) {
    VERIDYN_ASSERT(figure.windows[k].to > figure.windows[k].from);
    VERIDYN_ASSERT(k == 0 || figure.windows[k].from >= figure.windows[k - 1].to);
  }
}

void check_block(const XYPlot& plot) {
  for (const XYSeries& series : plot.series) VERIDYN_ASSERT(series.x.size() == series.y.size());
  for (const XYArea& area : plot.areas)
    VERIDYN_ASSERT(area.low.size() == area.x.size() && area.high.size() == area.x.size());
}

void check_block(const IntervalPlot& plot) {
  for (const IntervalRow& row : plot.rows) VERIDYN_ASSERT(row.estimates.size() == plot.methods.size());
}

void check_block(const Matrix& matrix) {
  VERIDYN_ASSERT(matrix.values.size() == matrix.row_names.size());
  for (const std::vector<double>& row : matrix.values) VERIDYN_ASSERT(row.size() == matrix.column_names.size());
}

void check_block(const Scene& scene) {
  using Kind = SceneShape::Kind;
  for (const SceneShape& shape : scene.shapes) {
    const std::size_t count = shape.points.size();
    VERIDYN_ASSERT(shape.kind == Kind::kBall || shape.kind == Kind::kLabel ? count == 1
                   : shape.kind == Kind::kActuator                         ? count == 2
                                                                           : count >= 2);
  }
  for (const SceneMotion& motion : scene.motions) {
    VERIDYN_ASSERT(motion.values.size() == scene.joints.size());
    for (const std::vector<double>& values : motion.values) VERIDYN_ASSERT(values.size() == scene.samples.size());
  }
}

void check_block(const Paragraph&) {}
void check_block(const List&) {}
void check_block(const FactList&) {}

std::string slug(std::string_view text) {
  std::string id;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 128 && std::isalnum(byte) != 0) {
      id += static_cast<char>(std::tolower(byte));
    } else if (!id.empty() && id.back() != '-') {
      id += '-';
    }
  }
  while (!id.empty() && id.back() == '-') id.pop_back();
  return id.empty() ? "section" : id;
}

}  // namespace

std::string_view status_name(Status status) { return words(status).name; }

std::string_view status_label(Status status) { return words(status).label; }

Status status_from_name(std::string_view name) {
  for (const StatusWords& each : kStatusWords) {
    if (each.name == name) return each.status;
  }
  return Status::kNone;
}

std::string_view verdict_word(const Verdict& verdict) {
  if (!verdict.word.empty()) return verdict.word;
  switch (verdict.level) {
    case Level::kGood:
      return "Usable";
    case Level::kCaution:
      return "Use with care";
    case Level::kBad:
      break;
  }
  return "Do not use";
}

Cell text_cell(std::string text) { return {.text = std::move(text)}; }

Cell number_cell(double value) { return {.number = value}; }

Cell number_cell(double value, int decimals) { return {.number = value, .decimals = decimals}; }

Cell status_cell(Status status, std::string text) { return {.text = std::move(text), .status = status}; }

Cell measured_cell(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return number_cell(value);
  // 0.0996 rounds to 0.10 at two digits: round first, then count.
  const double exponent = std::floor(std::log10(sigma * (1.0 + 0.5e-2)));
  const int decimals = static_cast<int>(std::max(0.0, 1.0 - exponent));
  if (decimals > 9) return number_cell(value);
  return number_cell(value, decimals);
}

void check(const Document& document) {
  for (const Block& block : document.lead) std::visit([](const auto& each) { check_block(each); }, block);
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) std::visit([](const auto& each) { check_block(each); }, block);
  }
}

Document with_captions_once(Document document) {
  std::set<std::string> said;
  const auto once = [&said](auto& block) {
    if constexpr (requires { block.caption; })
      if (!block.caption.empty() && !said.insert(block.caption).second) block.caption.clear();
  };
  for (Block& block : document.lead) std::visit(once, block);
  for (Section& section : document.sections)
    for (Block& block : section.blocks) std::visit(once, block);
  return document;
}

std::vector<std::string> section_ids(const Document& document) {
  // Names of elements that the page has already.
  std::set<std::string> taken = {"report", "veridyn-document", "theme", "reset-zoom", "expand-all"};
  std::vector<std::string> ids;
  for (const Section& section : document.sections) {
    const std::string base = slug(section.id.empty() ? section.title : section.id);
    std::string id = base;
    for (int k = 2; !taken.insert(id).second; ++k) id = fmt::format("{}-{}", base, k);
    ids.push_back(id);
  }
  return ids;
}

}  // namespace veridyn::report
