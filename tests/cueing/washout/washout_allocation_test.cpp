// Nothing between the vehicle and the platform allocates once it is made.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/counting_new.hpp"
#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

TEST(CueingChain, DoesNotAllocateWithAnyAlgorithm) {
  for (const char* name : {"three_axis", "hexapod"}) {
    const Platform& platform = built_in_platform(name);
    for (const WashoutAlgorithm& a : washout_algorithms()) {
      CueingChain chain(a.design()->make(platform), platform);
      recording::MotionSample s;
      s.frame = Frame::kFlu;
      s.force = recording::force_at_rest(Frame::kFlu);
      chain.reset(s);
      double sum = 0.0;
      const long before = allocations.load();
      for (int k = 0; k < 500; ++k) {
        s.force.x() = 6.0 * std::sin(0.05 * k);
        s.force.y() = 8.0 * std::cos(0.03 * k);
        s.rate.z() = 0.4 * std::sin(0.03 * k);
        sum += chain.step(s, k % 3 == 0 ? 0.007 : 0.021).reached.angle.x();
      }
      EXPECT_EQ(allocations.load(), before) << a.name << " on " << name;
      EXPECT_TRUE(std::isfinite(sum));
    }
  }
}

}  // namespace
}  // namespace veridyn::cueing
