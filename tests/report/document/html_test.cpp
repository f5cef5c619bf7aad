#include "veridyn/report/document/html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/report/sample_document.hpp"
#include "veridyn/report/document/page.hpp"

namespace veridyn::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count(const std::string& text, std::string_view what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

TEST(ToHtml, SaysTheVerdictWithoutAScript) {
  const std::string html = to_html(sample_document());
  const std::string before_scripts = html.substr(0, html.find("<script"));
  EXPECT_THAT(
      before_scripts,
      HasSubstr(
          "<p class=\"word\">Use with care</p><h2>The pitch model is good to fly with; the yaw model is not.</h2>"));
  EXPECT_THAT(before_scripts, HasSubstr("<span class=\"badge bad\">rejected</span>"));
  EXPECT_THAT(before_scripts, HasSubstr("<title>Sample aircraft, flight 12</title>"));
}

TEST(ToHtml, NeverInterpretsATextFromTheData) {
  Document document{.title = kHostileText,
                    .subtitle = kHostileText,
                    .verdict = {.word = kHostileText, .headline = kHostileText, .lines = {kHostileText}},
                    .facts = {{.name = kHostileText, .value = kHostileText}},
                    .generator = kHostileText};
  document.sections = {
      {.title = kHostileText,
       .id = kHostileText,
       .blocks = {
           Paragraph{kHostileText}, List{{kHostileText}}, FactList{{{kHostileText, kHostileText}}},
           Table{.title = kHostileText,
                 .caption = kHostileText,
                 .columns = {{.name = kHostileText, .unit = kHostileText, .group = kHostileText}},
                 .rows = {{.cells = {text_cell(kHostileText)}}, {.cells = {status_cell(Status::kBad, kHostileText)}}}},
           TimeSeries{.title = kHostileText, .caption = kHostileText}, XYPlot{.title = kHostileText},
           IntervalPlot{.title = kHostileText},
           Matrix{.title = kHostileText, .row_names = {kHostileText}, .values = {{}}}}}};
  const std::string html = to_html(document);
  const std::string harmless = to_html({});
  EXPECT_EQ(count(html, "<script"), count(harmless, "<script"));
  EXPECT_EQ(count(html, "</script"), count(harmless, "</script"));
  EXPECT_EQ(count(html, "<img"), count(harmless, "<img"));
  EXPECT_EQ(count(html, "<!--"), count(harmless, "<!--"));
}

// A text that looks like a marker of the page must not be filled in.
TEST(ToHtml, LeavesMarkersInTextsAlone) {
  const std::string html = to_html({.title = "@@VERIDYN_STATIC@@ @@VERIDYN_DOCUMENT@@"});
  EXPECT_THAT(html, HasSubstr("<title>@@VERIDYN_STATIC@@ @@VERIDYN_DOCUMENT@@</title>"));
  EXPECT_EQ(count(html, "<h1>"), count(to_html({}), "<h1>"));
}

TEST(ToHtml, EmbedsTheDocumentForTheFrontEnd) {
  if (!internal::page_has_figures()) GTEST_SKIP() << "built without the front end (VERIDYN_WEB=OFF)";
  const std::string html = to_html(sample_document());
  const std::string begin = "id=\"veridyn-document\">";
  const std::size_t from = html.find(begin) + begin.size();
  const auto report = nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
  EXPECT_EQ(report["title"], "Sample aircraft, flight 12");
}

TEST(ToHtml, SaysWhatIsMissingWithoutTheFrontEnd) {
  if (internal::page_has_figures()) GTEST_SKIP() << "built with the front end (VERIDYN_WEB=ON)";
  const std::string html = to_html(sample_document());
  EXPECT_THAT(html, HasSubstr("The picture needs the front end"));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace veridyn::report
