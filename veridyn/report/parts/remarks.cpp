#include "veridyn/report/parts/remarks.hpp"

#include <utility>

namespace veridyn::report {

namespace {

void add_list(Document& document, const std::string& title, const std::vector<std::string>& items, Tone tone) {
  if (items.empty()) return;
  document.sections.push_back({.title = title, .blocks = {List{.items = items, .tone = tone}}});
}

}  // namespace

void add_warnings(Document& document, const std::vector<std::string>& warnings) {
  add_list(document, "Warnings", warnings, Tone::kWarning);
}

void add_notes(Document& document, const std::vector<std::string>& notes) {
  add_list(document, "Notes", notes, Tone::kNote);
}

Document started_document(std::string title, std::string subtitle, const std::string& program) {
  Document document;
  document.title = std::move(title);
  document.subtitle = std::move(subtitle);
  document.generator = "Made with " + program;
  return document;
}

}  // namespace veridyn::report
