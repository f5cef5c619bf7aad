#include "veridyn/numerics/statistics.hpp"

namespace {
using namespace veridyn::numerics;

// Abramowitz & Stegun tables 26.1, 26.8, 26.10.
TEST(Quantiles, MatchPublishedTables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(student_t_quantile(0.975, 10.0), 2.228138851986, 1e-9);
  EXPECT_NEAR(student_t_quantile(0.975, 1.0), 12.7062047364, 1e-8);
  EXPECT_NEAR(chi_square_quantile(0.95, 6.0), 12.591587243744, 1e-9);
  EXPECT_NEAR(chi_square_quantile(0.95, 2.0), -2.0 * std::log(0.05), 1e-12);  // closed form for 2 degrees of freedom
}

}  // namespace
