#include "veridyn/core/finishing_progress.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace veridyn {
namespace {

struct Stopped : Progress {
  std::string stages;
  double fraction = 0.0;
  void stage(std::string_view name) override { stages += name; }
  [[nodiscard]] bool update(double done) override {
    fraction = done;
    return false;
  }
  [[nodiscard]] bool interrupted() const override { return true; }
  [[nodiscard]] int threads() const override { return 3; }
};

TEST(FinishingProgress, ShowsWhatIsDoneAndGoesOnAfterAnInterruption) {
  Stopped whole;
  FinishingProgress rest(whole);
  rest.stage("the rest");
  EXPECT_EQ(whole.stages, "the rest");
  EXPECT_TRUE(rest.update(0.25));
  EXPECT_EQ(whole.fraction, 0.25);
  EXPECT_FALSE(rest.interrupted());
  EXPECT_EQ(rest.threads(), 3);
}

}  // namespace
}  // namespace veridyn
