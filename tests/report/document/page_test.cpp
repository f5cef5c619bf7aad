#include "veridyn/report/document/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace veridyn::report::internal {
namespace {

using testing::HasSubstr;
using testing::Not;

// What `to_html` relies on, of the page with the front end and of the plain one.
TEST(Page, HasEachMarkerOnceAndInOrder) {
  const std::string_view text = page();
  std::size_t before = 0;
  for (const std::string_view marker : {"@@VERIDYN_TITLE@@", "@@VERIDYN_STATIC@@", "@@VERIDYN_DOCUMENT@@"}) {
    const std::size_t at = text.find(marker);
    ASSERT_NE(at, std::string_view::npos) << marker;
    EXPECT_EQ(text.find(marker, at + 1), std::string_view::npos) << marker;
    EXPECT_GT(at, before) << marker;
    before = at;
  }
}

TEST(Page, NeedsNothingButItself) {
  const std::string text(page());
  EXPECT_THAT(text, HasSubstr("Content-Security-Policy"));
  EXPECT_THAT(text, HasSubstr("default-src 'none'"));
  EXPECT_THAT(text, Not(HasSubstr("src=\"")));
  EXPECT_THAT(text, Not(HasSubstr("rel=\"stylesheet\"")));
  EXPECT_THAT(text, Not(HasSubstr("@import")));
  EXPECT_THAT(text, Not(HasSubstr("@font-face")));
}

TEST(Page, HasAScriptOnlyWhereItDrawsFigures) {
  EXPECT_EQ(page().find("<script") != std::string_view::npos, page_has_figures());
}

// The classes by which `static_html` shows what is good and what is not.
TEST(Page, HasAStyleForWhatTheStaticReportMarks) {
  const std::string text(page());
  for (const char* name : {".verdict", ".badge", ".good", ".caution", ".bad", ".muted", ".callout", ".warning"})
    EXPECT_THAT(text, HasSubstr(name));
}

}  // namespace
}  // namespace veridyn::report::internal
