#include "veridyn/estimation/open_loop/open_loop_windows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace veridyn::estimation {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Spans = std::vector<TimeSpan>;

TEST(OpenLoopWindows, ArePlacedOutsideOfWhatIdentificationSaw) {
  EXPECT_THAT(unseen(Spans{{0, 10}, {20, 30}}, Spans{{2, 4}, {8, 22}, {40, 50}}),
              ElementsAre(TimeSpan{0, 2}, TimeSpan{4, 8}, TimeSpan{22, 30}));
  EXPECT_THAT(unseen(Spans{{0, 10}}, Spans{{0, 10}}), IsEmpty());
}

TEST(OpenLoopWindows, LastUntilWhatIsFreeIsOverOrTheyAreLongEnough) {
  const Spans excited{{5, 10}, {30, 36}}, free{{0, 20}, {25, 60}};
  EXPECT_THAT(open_loop_windows(excited, free, {.duration_s = 100, .start_s = 2}),
              ElementsAre(TimeSpan{5, 20}, TimeSpan{30, 60}));
  // The first ends inside of its span: the next begins there, if that leaves it long enough.
  EXPECT_THAT(open_loop_windows(Spans{{0, 14}}, Spans{{0, 14}}, {.duration_s = 5, .start_s = 2}),
              ElementsAre(TimeSpan{0, 5}, TimeSpan{5, 10}, TimeSpan{10, 14}));
  EXPECT_THAT(open_loop_windows(Spans{{0, 13}}, Spans{{0, 13}}, {.duration_s = 5, .start_s = 2}),
              ElementsAre(TimeSpan{0, 5}, TimeSpan{5, 10}));
  EXPECT_THAT(open_loop_windows(Spans{{0, 6}}, {}, {.duration_s = 100, .start_s = 2}), ElementsAre(TimeSpan{0, 6}))
      << "excited, and not known to be usable: as far as it goes";
  EXPECT_THAT(open_loop_windows(Spans{{0, 3.9}}, {}, {.duration_s = 100, .start_s = 2}), IsEmpty());
  // A window covers the next excited span.
  EXPECT_THAT(open_loop_windows(Spans{{0, 6}, {8, 14}}, Spans{{0, 20}}, {.duration_s = 100, .start_s = 2}),
              ElementsAre(TimeSpan{0, 20}));
}

}  // namespace
}  // namespace veridyn::estimation
