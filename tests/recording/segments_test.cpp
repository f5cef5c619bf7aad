#include "veridyn/recording/segments.hpp"

#include <cmath>

#include "tests/io/support.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::message_of;

std::string refusal(const std::string& toml) {
  const Study study = Study::parse("[segments]\n" + toml, "study.toml", ".");
  return message_of([&] {
    (void)SegmentOptions::keys().read(study.root().table("segments"));
    (void)read_spans(study.root().table("segments"), "spans");
  });
}

TEST(LeastActivity, FollowsTheRecordingWhereItIsGentle) {
  const LeastActivity least{.usual = 1.0, .least = 0.01};
  const auto with = [](double calm, double lively, double share) {
    std::vector<double> activity(1000, calm);
    for (std::size_t i = 0; i < static_cast<std::size_t>(1000.0 * share); ++i) activity[i] = lively;
    return activity;
  };
  const std::vector<bool> all(1000, true);
  EXPECT_DOUBLE_EQ(least.of(with(0.1, 5.0, 0.2), all), 1.0);
  EXPECT_DOUBLE_EQ(least.of(with(0.02, 0.4, 0.2), all), 0.2);
  EXPECT_DOUBLE_EQ(least.of(with(0.02, 0.4, 0.01), all), 0.04) << "one manoeuvre: by the calm parts";
  EXPECT_DOUBLE_EQ(least.of(with(0.001, 0.4, 0.01), all), 0.01);
  EXPECT_DOUBLE_EQ(least.of(with(0.3, 0.3, 0.0), all), 0.6) << "nothing stands out";
  // Only what is inside counts, and what is missing does not.
  std::vector<double> gap = with(0.02, 0.4, 0.2);
  gap[999] = std::nan("");
  std::vector<bool> inside(1000, false);
  std::fill(inside.begin() + 200, inside.end(), true);
  EXPECT_DOUBLE_EQ(least.of(gap, inside), 0.04);
  EXPECT_DOUBLE_EQ(least.of({}, {}), 0.01);
}

TEST(Segments, StretchesAreTheLongestRunsForWhichSomethingHolds) {
  const numerics::UniformGrid grid{1.0, 0.5, 8};
  const std::vector<bool> holds{true, true, false, true, false, true, true, true};
  std::vector<TimeSpan> found = stretches(grid, grid.count, [&](std::size_t k) { return holds[k]; });
  EXPECT_THAT(found, ElementsAre(TimeSpan{1.0, 1.5}, TimeSpan{2.5, 2.5}, TimeSpan{3.5, 4.5}));
  EXPECT_DOUBLE_EQ(total_s(found), 1.5);
  drop_shorter(found, 0.0);
  EXPECT_THAT(found, ElementsAre(TimeSpan{1.0, 1.5}, TimeSpan{3.5, 4.5}));
  drop_shorter(found, 1.0);
  EXPECT_THAT(found, ElementsAre(TimeSpan{3.5, 4.5}));
}

TEST(Segments, SpansNoFurtherApartThanTheGapAreJoined) {
  const std::vector<TimeSpan> spans{{0, 1}, {3, 4}, {8, 9}};
  EXPECT_THAT(merged(spans, 2.0), ElementsAre(TimeSpan{0, 4}, TimeSpan{8, 9}));
  EXPECT_THAT(merged(spans, 1.9).size(), 3u);
}

TEST(Segments, PartsWithinOthersAreTheirIntersection) {
  const std::vector<TimeSpan> a{{0, 5}, {6, 10}}, b{{4, 7}, {9, 12}};
  EXPECT_THAT(within(a, b), ElementsAre(TimeSpan{4, 5}, TimeSpan{6, 7}, TimeSpan{9, 10}));
}

TEST(Segments, ActivityIsTheRootMeanSquareAboutTheMean) {
  // +-1 about 1000: the mean is not activity, and running sums must not cancel.
  std::vector<double> x(200);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = 1000.0 + (k % 2 == 0 ? 1.0 : -1.0);
  const std::vector<double> found = activity(x, 20);
  EXPECT_NEAR(found[100], 1.0, 1e-3);
  for (std::size_t k = 60; k < 140; ++k) x[k] = NAN;
  EXPECT_TRUE(std::isnan(activity(x, 20)[100]));
}

TEST(Segments, MeanSquareOfAConstantIsItsSquareUpToTheEnds) {
  const std::vector<double> x(50, -3.0);
  for (const double v : mean_square(x, 7)) EXPECT_NEAR(v, 9.0, 1e-12);
}

TEST(Segments, BlocksAreEqualAndFillTheSpan) {
  EXPECT_THAT(blocks({0, 34}, 10.0).size(), 3u);
  EXPECT_THAT(blocks({0, 36}, 10.0).size(), 4u);
  EXPECT_THAT(blocks({5, 7}, 10.0), ElementsAre(TimeSpan{5, 7}));
  EXPECT_EQ(blocks({0, 34}, 10.0).back().end, 34.0);
}

TEST(Segments, HoldOutHasItsShareAndAGuardBetweenTheUses) {
  const SegmentOptions options{.holdout = 1.0 / 3.0, .block_s = 10.0, .guard_s = 0.5};
  const AssignedBlocks s = assign_blocks(std::vector<TimeSpan>{{0, 300}}, options, Neighbours::kJoined, 1.0);
  EXPECT_EQ(s.holdout.size(), 10u);
  EXPECT_NEAR(total_s(s.holdout), 10.0 * 9.0, 1e-9);
  EXPECT_EQ(s.identification.front().begin, 0.0);
  for (const TimeSpan& a : s.identification) {
    for (const TimeSpan& b : s.holdout) EXPECT_TRUE(a.end + 0.99 < b.begin || b.end + 0.99 < a.begin);
  }
}

TEST(Segments, NeighbouringBlocksOfOneUseAreJoinedOrKeptSeparately) {
  const SegmentOptions options{.holdout = 0.0};
  const std::vector<TimeSpan> excited = {{0, 30}, {40, 50}};
  const AssignedBlocks joined = assign_blocks(excited, options, Neighbours::kJoined, 1.0);
  const AssignedBlocks separate = assign_blocks(excited, options, Neighbours::kSeparate, 1.0);
  EXPECT_THAT(joined.identification, ElementsAre(TimeSpan{0, 30}, TimeSpan{40, 50}));
  EXPECT_THAT(separate.identification,
              ElementsAre(TimeSpan{0, 10}, TimeSpan{10, 20}, TimeSpan{20, 30}, TimeSpan{40, 50}));
  EXPECT_THAT(joined.holdout, IsEmpty());
}

TEST(Segments, FirstBlockIsForIdentificationWhateverTheShare) {
  const AssignedBlocks s = assign_blocks(std::vector<TimeSpan>{{0, 10}}, {.holdout = 0.8}, Neighbours::kJoined, 1.0);
  EXPECT_EQ(s.identification.size(), 1u);
}

// All of an input in the second block, which the share alone would hold out; an input that is even changes nothing.
TEST(Segments, HoldOutLeavesHalfOfEachInput) {
  const std::vector<TimeSpan> excited{{0.0, 30.0}};
  const SegmentOptions options{.holdout = 0.4, .block_s = 10.0, .guard_s = 0.0};
  const InputShare even = [](const TimeSpan& span) { return span.duration(); };
  const InputShare once = [](const TimeSpan& span) { return span.contains(15.0) ? 1.0 : 0.0; };
  const auto held = [&](std::vector<InputShare> inputs) {
    return assign_blocks(excited, options, Neighbours::kSeparate, 1.0, inputs).holdout;
  };
  ASSERT_EQ(held({}).size(), 1u);
  EXPECT_EQ(held({}).front().begin, 10.0);
  EXPECT_EQ(held({even}).front().begin, 10.0);
  ASSERT_EQ(held({even, once}).size(), 1u);
  EXPECT_EQ(held({even, once}).front().begin, 20.0);
}

TEST(Segments, BlocksThatTheGuardMakesTooShortAreDropped) {
  const AssignedBlocks s =
      assign_blocks(std::vector<TimeSpan>{{0, 30}}, {.holdout = 1.0 / 3.0, .block_s = 10.0, .guard_s = 4.6},
                    Neighbours::kJoined, 1.0);
  EXPECT_THAT(s.holdout, IsEmpty());
  EXPECT_EQ(s.identification.size(), 2u);
}

TEST(Segments, RefuseSpansAndSharesThatMakeNoSense) {
  EXPECT_THAT(refusal("spans = [1, 2, 3]\n"), HasSubstr("spans: has 3 numbers; must be pairs of begin and end"));
  EXPECT_THAT(refusal("spans = [2, 1]\n"), HasSubstr("spans: segment 2 s to 1 s has no length"));
  EXPECT_THAT(refusal("spans = [1, 5, 4, 8]\n"), HasSubstr("overlap or are not in order"));
  EXPECT_THAT(refusal("holdout = 0.9\n"), HasSubstr("holdout: = 0.9 must be from 0 to 0.8"));
  EXPECT_THAT(refusal("guard = -1\n"), HasSubstr("guard: = -1 must be >= 0"));
}

}  // namespace
}  // namespace veridyn::recording
