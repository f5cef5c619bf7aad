#include "veridyn/estimation/recursive/score_blocks.hpp"

#include <gtest/gtest.h>

#include <array>

namespace veridyn::estimation::internal {
namespace {

/// 60 blocks of 10 rows of one parameter, whose regressor is `level` but in `manoeuvres` blocks, where it is 1.
ScoreBlocks blocks_of(double level, int manoeuvres, double lambda = 1.0) {
  ScoreBlocks blocks;
  blocks.reset(1, 10);
  for (int k = 0; k < 600; ++k) {
    const double x = k / 10 < manoeuvres ? 1.0 : level;
    SmallVector score(1);
    score << x * (k % 2 == 0 ? 1.0 : -1.0);
    blocks.add(&x, score, lambda);
  }
  return blocks;
}

TEST(ScoreBlocks, CountsTheBlocksThatDetermineAParameter) {
  const double p = 1.0;
  EXPECT_NEAR(blocks_of(1.0, 0).blocks_behind(&p), 60.0, 1e-9);
  // Five blocks hold all the information there is.
  EXPECT_NEAR(blocks_of(0.0, 5).blocks_behind(&p), 5.0, 1e-9);
  EXPECT_NEAR(blocks_of(0.0, 5).blocks(), 60.0, 1e-9);
  // The scale of p does not matter.
  const double q = 7.0;
  EXPECT_NEAR(blocks_of(0.0, 5).blocks_behind(&q), 5.0, 1e-9);
}

TEST(ScoreBlocks, ForgetsInformationByTheSquareOfTheWeights) {
  // a_b = lambda^(20 age) up to a factor: (sum a)^2/sum a^2 = (1 + g)/(1 - g) (1 - g^60)^2/(1 - g^120), g = lambda^20.
  const double lambda = 0.995, p = 1.0;
  const double g = std::pow(lambda, 20.0);
  const double expected = (1.0 + g) / (1.0 - g) * std::pow(1.0 - std::pow(g, 60.0), 2) / (1.0 - std::pow(g, 120.0));
  EXPECT_NEAR(blocks_of(1.0, 0, lambda).blocks_behind(&p), expected, 1e-9);
  // Far beyond what a double can hold without a scale.
  EXPECT_TRUE(std::isfinite(blocks_of(1.0, 0, 0.6).blocks_behind(&p)));
}

TEST(ScoreBlocks, SpreadsABatchEstimateOverItsRows) {
  ScoreBlocks blocks;
  blocks.reset(2, 10);
  const SmallMatrix M = (SmallMatrix(2, 2) << 4.0, 1.0, 1.0, 3.0).finished();
  blocks.start(2.0 * M, M, 300.0);
  const std::array<double, 2> p{0.3, -1.0};
  EXPECT_NEAR(blocks.blocks_behind(p.data()), 30.0, 1e-9);
  EXPECT_NEAR(blocks.blocks(), 30.0, 1e-9);
}

TEST(ScoreBlocks, SumsWideBlocksOverFourNeighbours) {
  ScoreBlocks blocks;
  blocks.reset(1, 1);
  SmallVector one(1);
  one << 1.0;
  const double x = 1.0;
  for (int k = 0; k < 8; ++k) blocks.add(&x, one, 1.0);
  EXPECT_NEAR(blocks.sum()(0, 0), 8.0, 1e-12);        // eight squares of one
  EXPECT_NEAR(blocks.wide_sum()(0, 0), 32.0, 1e-12);  // two squares of four
  blocks.restart();
  EXPECT_EQ(blocks.sum()(0, 0), 0.0);
  EXPECT_EQ(blocks.blocks_behind(&x), 0.0);
}

}  // namespace
}  // namespace veridyn::estimation::internal
