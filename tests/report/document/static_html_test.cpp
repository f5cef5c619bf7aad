#include "veridyn/report/document/static_html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The page of one section with one block.
std::string html_of(Block block) {
  return static_html({.sections = {{.title = "s", .blocks = {std::move(block)}}}}, "no picture here");
}

TEST(EscapeHtml, WritesWhatHtmlWouldReadAsEntitiesAndNothingElse) {
  EXPECT_EQ(escape_html("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escape_html("&lt;"), "&amp;lt;") << "an entity in a text is a text";
  EXPECT_EQ(escape_html("5 °, − and ü"), "5 °, − and ü");
}

TEST(StaticHtml, BeginsWithTheVerdictAndEndsWithTheProgram) {
  const std::string html =
      static_html({.title = "Flight <12>",
                   .subtitle = "by hand",
                   .verdict = {.level = Level::kBad, .headline = "It fails.", .lines = {"one", "two"}},
                   .lead = {Paragraph{"measured against model"}},
                   .facts = {{.name = "Mass", .value = "12.6 kg"}},
                   .sections = {{.title = "First"}, {.title = "Second"}},
                   .generator = "Made with veridyn 1.2"},
                  "");
  const std::vector<std::string> parts = {"<h1>Flight &lt;12&gt;</h1>",
                                          "<p class=\"subtitle\">by hand</p>",
                                          "<section class=\"verdict bad\">",
                                          "<p class=\"word\">Do not use</p><h2>It fails.</h2><p>one</p><p>two</p>",
                                          "<p>measured against model</p>",
                                          "<dt>Mass</dt><dd>12.6 kg</dd>",
                                          "<section id=\"first\"><h2>First</h2>",
                                          "<section id=\"second\"><h2>Second</h2>",
                                          "<footer>Made with veridyn 1.2</footer>"};
  std::size_t from = 0;
  for (const std::string& part : parts) {
    const std::size_t at = html.find(part, from);
    ASSERT_NE(at, std::string::npos) << part << "\nin\n" << html;
    from = at;
  }
}

TEST(StaticHtml, HasNoListOfFactsWithoutAFact) { EXPECT_THAT(static_html({}, ""), Not(HasSubstr("<dl"))); }

TEST(StaticHtml, MarksNotesAndWarnings) {
  EXPECT_THAT(html_of(Paragraph{"plain"}), HasSubstr("<p>plain</p>"));
  EXPECT_THAT(html_of(Paragraph{"n", Tone::kNote}), HasSubstr("<p class=\"callout note\">n</p>"));
  EXPECT_THAT(html_of(List{{"a", "b"}}), HasSubstr("<ul class=\"plain\"><li>a</li><li>b</li></ul>"));
  EXPECT_THAT(html_of(List{{"mind"}, Tone::kWarning}), HasSubstr("<ul class=\"callout warning\"><li>mind</li>"));
}

TEST(StaticHtml, SetsATableWithItsUnitsAndNumbersToTheRight) {
  const std::string html = html_of(Table{.title = "T",
                                         .caption = "what it is",
                                         .columns = {{.name = "name"}, {.name = "value", .unit = "N/rad"}},
                                         .rows = {{.cells = {text_cell("C_f"), number_cell(44000.0)}}}});
  EXPECT_THAT(html, HasSubstr("<h3>T</h3>"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"col\" class=\"left\">name</th>"));
  EXPECT_THAT(html, HasSubstr("<th scope=\"col\" class=\"right\">value [N/rad]</th>"));
  EXPECT_THAT(html, HasSubstr("<tr><td class=\"left\">C_f</td><td class=\"right\">44000</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<figcaption>what it is</figcaption>"));
  EXPECT_THAT(html, Not(HasSubstr("class=\"groups\""))) << "no column has a group";
}

TEST(StaticHtml, PutsNeighboursOfAGroupUnderOneHead) {
  const std::string html =
      html_of(Table{.columns = {{.name = "p"},
                                {.name = "low", .group = "95 %"},
                                {.name = "high", .group = "95 %"},
                                {.name = "sigma", .group = "OLS"}},
                    .rows = {{.cells = {text_cell("a"), number_cell(1), number_cell(2), number_cell(3)}}}});
  EXPECT_THAT(html,
              HasSubstr("<tr class=\"groups\"><td colspan=\"1\"></td><th colspan=\"2\" scope=\"colgroup\">95 %</th>"
                        "<th colspan=\"1\" scope=\"colgroup\">OLS</th></tr>"));
}

TEST(StaticHtml, ColoursBadgesAndRowsByWhatBecameOfThem) {
  const auto row_with = [](Status status) {
    return html_of(
        Table{.columns = {{.name = "c"}}, .rows = {{.cells = {status_cell(status, "word")}, .status = status}}});
  };
  EXPECT_THAT(row_with(Status::kIdentified), HasSubstr("<tr class=\"tone-good\">"));
  EXPECT_THAT(row_with(Status::kGood), HasSubstr("<span class=\"badge good\">word</span>"));
  for (const Status care : {Status::kWeak, Status::kEffective, Status::kNotExcited, Status::kCaution})
    EXPECT_THAT(row_with(care), HasSubstr("<span class=\"badge caution\">word</span>")) << status_name(care);
  for (const Status bad : {Status::kImplausible, Status::kAtBound, Status::kRejected, Status::kBad})
    EXPECT_THAT(row_with(bad), HasSubstr("<tr class=\"tone-bad\">")) << status_name(bad);
  EXPECT_THAT(row_with(Status::kFixed), HasSubstr("badge info"));
  EXPECT_THAT(row_with(Status::kInsignificant), HasSubstr("badge muted"));
  EXPECT_THAT(row_with(Status::kNone), HasSubstr("<tr><td class=\"left\">word</td>")) << "no badge";
}

TEST(StaticHtml, WritesAMatrixInNumbers) {
  const std::string html = html_of(Matrix{.title = "correlation",
                                          .row_names = {"a", "b"},
                                          .column_names = {"a", "b"},
                                          .values = {{1.0, -0.255}, {-0.255, 1.0}},
                                          .decimals = 1});
  EXPECT_THAT(html, HasSubstr("<th scope=\"col\">a</th><th scope=\"col\">b</th>"));
  EXPECT_THAT(html, HasSubstr("<tr><th scope=\"row\">b</th><td class=\"cell\">−0.3</td><td class=\"cell\">1.0</td>"));
}

TEST(StaticHtml, SaysOfEveryPictureThatItIsNotThere) {
  for (const Block& block : std::vector<Block>{
           TimeSeries{.title = "title", .caption = "caption"}, XYPlot{.title = "title", .caption = "caption"},
           IntervalPlot{.title = "title", .caption = "caption"}, Scene{.title = "title", .caption = "caption"}}) {
    EXPECT_THAT(html_of(block), HasSubstr("<figure><h3>title</h3><p class=\"footnote\">no picture here</p>"
                                          "<figcaption>caption</figcaption></figure>"));
  }
  EXPECT_THAT(html_of(XYPlot{}), HasSubstr("<figure><p class=\"footnote\">no picture here</p></figure>"));
}

}  // namespace
}  // namespace veridyn::report
