#include "veridyn/numerics/batches/process_share.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::numerics {
namespace {

using ::testing::ElementsAre;

TEST(ProcessShare, ComesToItsOwnItemsFirst) {
  const ProcessShare second{.index = 1, .count = 3};
  EXPECT_THAT(second.own_first(8), ElementsAre(1, 4, 7, 0, 2, 3, 5, 6));
  EXPECT_THAT(ProcessShare().own_first(3), ElementsAre(0, 1, 2));
  EXPECT_THAT(ProcessShare{.count = 0}.own_first(2), ElementsAre(0, 1));
}

TEST(ProcessShare, EveryItemIsComputedByOne) {
  for (std::size_t item = 0; item < 20; ++item) {
    int computing = 0;
    for (std::size_t i = 0; i < 4; ++i) computing += ProcessShare{.index = i, .count = 4}.computes(item) ? 1 : 0;
    EXPECT_EQ(computing, 1);
    EXPECT_FALSE(ProcessShare{.count = 0}.computes(item));
  }
}

}  // namespace
}  // namespace veridyn::numerics
