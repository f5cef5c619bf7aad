#include "veridyn/numerics/random.hpp"

#include <cmath>
#include <set>

namespace veridyn::numerics {
namespace {

TEST(RandomStream, RepeatsForTheSameSeedAndName) {
  RandomStream a(7, "gyro"), b(7, "gyro");
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(a.normal(), b.normal());
    EXPECT_EQ(a.uniform(), b.uniform());
  }
}

// Kept so that a change of compiler, library or seeding that changes everybody's results is noticed. The engine alone
// is fixed by the C++ standard (its 10000th output for the default seed is 9981545732273789042).
TEST(RandomStream, KeepsItsNumbersBetweenReleases) {
  RandomStream stream(1, "reference");
  RandomStream numbered(1, std::uint64_t{3});
  EXPECT_DOUBLE_EQ(stream.normal(), -1.5214328447424901);
  EXPECT_DOUBLE_EQ(stream.normal(), 1.0823166201331269);
  EXPECT_DOUBLE_EQ(numbered.uniform(), 0.71669132095293631);
}

TEST(RandomStream, DiffersBetweenSeedsAndNames) {
  std::set<double> first;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const char* name : {"a", "b", "ab"}) first.insert(RandomStream(seed, name).uniform());
  EXPECT_EQ(first.size(), 150u);
}

TEST(RandomStream, HasTheMomentsOfItsDistributionsAndIndependentStreams) {
  // Bounds are five standard errors of each moment: 1, sqrt 2, sqrt 15, sqrt 96, 1 for the cross product.
  RandomStream a(11, "x"), b(11, "y");
  constexpr int kN = 400000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0, cross = 0, u1 = 0;
  for (int i = 0; i < kN; ++i) {
    const double x = a.normal();
    m1 += x;
    m2 += x * x;
    m3 += x * x * x;
    m4 += x * x * x * x;
    cross += x * b.normal();
    u1 += b.uniform();
  }
  const double se = 5.0 / std::sqrt(kN);
  EXPECT_NEAR(m1 / kN, 0.0, se);
  EXPECT_NEAR(m2 / kN, 1.0, se * std::sqrt(2.0));
  EXPECT_NEAR(m3 / kN, 0.0, se * std::sqrt(15.0));
  EXPECT_NEAR(m4 / kN, 3.0, se * std::sqrt(96.0));
  EXPECT_NEAR(cross / kN, 0.0, se);
  EXPECT_NEAR(u1 / kN, 0.5, se / std::sqrt(12.0));
}

TEST(RandomStream, DrawsEveryIndexEquallyOften) {
  RandomStream random(5, "index");
  std::array<int, 7> count{};
  for (int i = 0; i < 70000; ++i) ++count[random.index(7)];
  double chi2 = 0;
  for (const int c : count) chi2 += (c - 10000.0) * (c - 10000.0) / 10000.0;
  EXPECT_LT(chi2, 22.5);  // 0.999 quantile of chi-square with 6 degrees of freedom
}

}  // namespace
}  // namespace veridyn::numerics
