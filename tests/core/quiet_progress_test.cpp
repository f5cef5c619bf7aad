#include "veridyn/core/quiet_progress.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace veridyn {
namespace {

struct Stoppable : Progress {
  std::string stages;
  bool stopped = false;
  void stage(std::string_view name) override { stages += name; }
  [[nodiscard]] bool interrupted() const override { return stopped; }
  [[nodiscard]] int threads() const override { return 8; }
};

TEST(QuietProgress, SaysNothingAndStopsWithTheWhole) {
  Stoppable whole;
  QuietProgress part(whole);
  part.stage("part");
  EXPECT_EQ(whole.stages, "");
  EXPECT_EQ(part.threads(), 1);
  EXPECT_EQ(QuietProgress(whole, 2).threads(), 2);
  EXPECT_TRUE(part.update(0.5));
  EXPECT_FALSE(part.interrupted());
  whole.stopped = true;
  EXPECT_FALSE(part.update(0.6));
  EXPECT_TRUE(part.interrupted());
}

}  // namespace
}  // namespace veridyn
