#include "veridyn/report/parts/remarks.hpp"

#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

TEST(Remarks, AreSectionsOfTheirOwnOnlyWhereThereIsOne) {
  Document document = started_document("title", "subtitle", "veridyn test");
  EXPECT_EQ(document.generator, "Made with veridyn test");
  add_warnings(document, {});
  add_notes(document, {});
  EXPECT_TRUE(document.sections.empty());
  add_warnings(document, {"mind the gap"});
  add_notes(document, {"seen"});
  ASSERT_EQ(document.sections.size(), 2U);
  EXPECT_EQ(document.sections[0].title, "Warnings");
  EXPECT_EQ(std::get<List>(document.sections[0].blocks.at(0)).tone, Tone::kWarning);
  EXPECT_EQ(std::get<List>(document.sections[1].blocks.at(0)).tone, Tone::kNote);
  EXPECT_FALSE(document.sections[0].folded) << "a warning is seen without a click";
}

}  // namespace
}  // namespace veridyn::report
