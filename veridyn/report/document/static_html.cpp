#include "veridyn/report/document/static_html.hpp"

#include <fmt/format.h>

#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {

namespace {

std::string_view level_class(Level level) {
  return level == Level::kGood ? "good" : level == Level::kCaution ? "caution" : "bad";
}

std::string_view badge_class(Status status) {
  switch (status) {
    case Status::kIdentified:
    case Status::kGood:
      return "good";
    case Status::kWeak:
    case Status::kEffective:
    case Status::kNotExcited:
    case Status::kCaution:
      return "caution";
    case Status::kImplausible:
    case Status::kAtBound:
    case Status::kRejected:
    case Status::kBad:
      return "bad";
    case Status::kFixed:
      return "info";
    case Status::kInsignificant:
    case Status::kNone:
      break;
  }
  return "muted";
}

std::string_view align_class(Align align) {
  return align == Align::kRight ? "right" : align == Align::kCenter ? "center" : "left";
}

std::string facts_html(const std::vector<Fact>& facts) {
  if (facts.empty()) return "";
  std::string html = "<dl class=\"facts\">";
  for (const Fact& fact : facts) {
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", escape_html(fact.name), escape_html(fact.value));
  }
  return html + "</dl>\n";
}

std::string label_with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : fmt::format("{} [{}]", label, unit);
}

/// View of a document while it is written: writes one block, and holds what every block may need.
class BlockWriter {
 public:
  explicit BlockWriter(std::string_view note) : note_(note) {}

  std::string operator()(const Paragraph& paragraph) const {
    return fmt::format("<p{}>{}</p>\n", tone_class(paragraph.tone), escape_html(paragraph.text));
  }

  std::string operator()(const List& list) const {
    std::string html = fmt::format("<ul{}>", list.tone == Tone::kPlain ? " class=\"plain\"" : tone_class(list.tone));
    for (const std::string& item : list.items) html += fmt::format("<li>{}</li>", escape_html(item));
    return html + "</ul>\n";
  }

  std::string operator()(const FactList& list) const { return facts_html(list.facts); }

  std::string operator()(const Table& table) const {
    std::string html = "<div class=\"scroll\"><table class=\"data\"><thead>" + group_row(table) + "<tr>";
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      html += fmt::format("<th scope=\"col\" class=\"{}\">{}</th>", align_class(resolved_align(table, k)),
                          escape_html(label_with_unit(table.columns[k].name, table.columns[k].unit)));
    }
    html += "</tr></thead><tbody>\n";
    for (const Row& row : table.rows) {
      html += row.status == Status::kNone ? "<tr>" : fmt::format("<tr class=\"tone-{}\">", badge_class(row.status));
      for (std::size_t k = 0; k < row.cells.size(); ++k) {
        const std::string text = escape_html(cell_text(row.cells[k], table.columns[k]));
        const Status status = row.cells[k].status;
        html += fmt::format("<td class=\"{}\">", align_class(resolved_align(table, k)));
        html += status == Status::kNone ? text
                                        : fmt::format("<span class=\"badge {}\">{}</span>", badge_class(status), text);
        html += "</td>";
      }
      html += "</tr>\n";
    }
    return figure(table.title, table.caption, html + "</tbody></table></div>");
  }

  std::string operator()(const TimeSeries& each) const { return picture(each.title, each.caption); }
  std::string operator()(const XYPlot& each) const { return picture(each.title, each.caption); }
  std::string operator()(const IntervalPlot& each) const { return picture(each.title, each.caption); }
  std::string operator()(const Scene& each) const { return picture(each.title, each.caption); }

  std::string operator()(const Matrix& matrix) const {
    std::string html = "<div class=\"scroll\"><table class=\"matrix\"><thead><tr><td></td>";
    for (const std::string& name : matrix.column_names) {
      html += fmt::format("<th scope=\"col\">{}</th>", escape_html(name));
    }
    html += "</tr></thead><tbody>\n";
    for (std::size_t i = 0; i < matrix.row_names.size(); ++i) {
      html += fmt::format("<tr><th scope=\"row\">{}</th>", escape_html(matrix.row_names[i]));
      for (const double value : matrix.values[i]) {
        html += fmt::format("<td class=\"cell\">{}</td>", format_decimals(value, matrix.decimals));
      }
      html += "</tr>\n";
    }
    return figure(matrix.title, matrix.caption, html + "</tbody></table></div>");
  }

 private:
  static std::string tone_class(Tone tone) {
    if (tone == Tone::kPlain) return "";
    return tone == Tone::kNote ? " class=\"callout note\"" : " class=\"callout warning\"";
  }

  static std::string group_row(const Table& table) {
    std::string html;
    bool any = false;
    for (std::size_t k = 0; k < table.columns.size();) {
      const std::string& group = table.columns[k].group;
      std::size_t end = k + 1;
      while (end < table.columns.size() && table.columns[end].group == group) ++end;
      any = any || !group.empty();
      html += group.empty() ? fmt::format("<td colspan=\"{}\"></td>", end - k)
                            : fmt::format("<th colspan=\"{}\" scope=\"colgroup\">{}</th>", end - k, escape_html(group));
      k = end;
    }
    return any ? "<tr class=\"groups\">" + html + "</tr>" : "";
  }

  static std::string figure(const std::string& title, const std::string& caption, const std::string& content) {
    std::string html = "<figure>";
    if (!title.empty()) html += fmt::format("<h3>{}</h3>", escape_html(title));
    html += content;
    if (!caption.empty()) html += fmt::format("<figcaption>{}</figcaption>", escape_html(caption));
    return html + "</figure>\n";
  }

  [[nodiscard]] std::string picture(const std::string& title, const std::string& caption) const {
    return figure(title, caption, fmt::format("<p class=\"footnote\">{}</p>", escape_html(note_)));
  }

  std::string_view note_;
};

}  // namespace

std::string escape_html(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string static_html(const Document& document, std::string_view note_for_figures) {
  check(document);
  const Verdict& verdict = document.verdict;
  std::string html =
      fmt::format("<div class=\"page\"><main>\n<div class=\"title\"><h1>{}</h1><p class=\"subtitle\">{}</p></div>\n",
                  escape_html(document.title), escape_html(document.subtitle));
  html += fmt::format("<section class=\"verdict {}\"><div><p class=\"word\">{}</p><h2>{}</h2>",
                      level_class(verdict.level), escape_html(verdict_word(verdict)), escape_html(verdict.headline));
  for (const std::string& line : verdict.lines) html += fmt::format("<p>{}</p>", escape_html(line));
  html += "</div></section>\n";
  const BlockWriter write(note_for_figures);
  for (const Block& block : document.lead) html += std::visit(write, block);
  html += facts_html(document.facts);
  const std::vector<std::string> ids = section_ids(document);
  for (std::size_t k = 0; k < document.sections.size(); ++k) {
    const Section& section = document.sections[k];
    html += fmt::format("<section id=\"{}\"><h2>{}</h2>\n", ids[k], escape_html(section.title));
    if (!section.inside.empty()) html += fmt::format("<p>{}</p>\n", escape_html(section.inside));
    for (const Block& block : section.blocks) html += std::visit(write, block);
    html += "</section>\n";
  }
  return html + fmt::format("<footer>{}</footer>\n</main></div>\n", escape_html(document.generator));
}

}  // namespace veridyn::report
