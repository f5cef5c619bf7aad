#include "veridyn/numerics/batches/process_share.hpp"

#include <gtest/gtest.h>

namespace veridyn::numerics {
namespace {

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
