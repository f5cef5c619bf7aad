#include "veridyn/muscle/path/segment_lanes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <random>
#include <vector>

namespace veridyn::muscle::internal {
namespace {

/// 12 random segments between two links, and the second one's motion with three
/// coordinates.
struct RandomSegments {
  explicit RandomSegments(unsigned seed) : random(seed) {
    for (auto* ends : {&a, &b}) {
      for (auto& axis : *ends) {
        axis.resize(12);
        for (double& x : axis) x = draw();
      }
    }
    r = Eigen::Quaterniond(draw(), draw(), draw(), draw()).normalized().toRotationMatrix();
    t = {draw(), draw(), draw()};
    for (Eigen::Index i = 0; i < motion.size(); ++i) motion.data()[i] = draw();
  }
  double draw() { return static_cast<double>(random()) / 4294967295.0 - 0.4; }
  [[nodiscard]] SegmentLanes lanes(std::vector<double>& length, std::vector<double>& term) const {
    SegmentLanes lanes;
    for (std::size_t k = 0; k < 3; ++k) {
      lanes.a[k] = a[k].data();
      lanes.b[k] = b[k].data();
    }
    length.assign(12, -1.0);
    term.assign(36, -1.0);
    lanes.n = 12;
    lanes.r = r.data();
    lanes.t = t.data();
    lanes.motion = motion.data();
    lanes.coordinates = 3;
    lanes.length = length.data();
    lanes.term = term.data();
    return lanes;
  }

  std::mt19937 random;
  std::array<std::vector<double>, 3> a, b;
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  Eigen::Matrix<double, 6, 3> motion;
};

TEST(SegmentLanes, AreLengthsAndHowTheyChangeWithTheLinksMotion) {
  const RandomSegments s(3);
  std::vector<double> length, term;
  compute(s.lanes(length, term));
  for (std::size_t i = 0; i < 12; ++i) {
    const Eigen::Vector3d pa(s.a[0][i], s.a[1][i], s.a[2][i]), pb(s.b[0][i], s.b[1][i], s.b[2][i]);
    const Eigen::Vector3d at = s.r * pb + s.t;
    EXPECT_NEAR(length[i], (at - pa).norm(), 1e-15);
    for (std::size_t j = 0; j < 3; ++j) {
      const Eigen::Vector3d w = s.motion.col(static_cast<Eigen::Index>(j)).head<3>();
      const Eigen::Vector3d v = s.motion.col(static_cast<Eigen::Index>(j)).tail<3>();
      // The far end's speed along the segment.
      EXPECT_NEAR(term[12 * j + i], (at - pa).normalized().dot(w.cross(at) + v), 2e-15);
    }
  }
}

TEST(SegmentLanes, HaveTheSameBitsOnProcessorsWithoutAvx2) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const RandomSegments s(seed);
    std::vector<double> length, term, other_length, other_term;
    compute(s.lanes(length, term));
    compute_without_avx2(s.lanes(other_length, other_term));
    EXPECT_EQ(length, other_length);
    EXPECT_EQ(term, other_term);
  }
}

TEST(SegmentLanes, LeaveTermsAloneWhereOnlyLengthsAreAskedFor) {
  const RandomSegments s(5);
  std::vector<double> length, term;
  SegmentLanes lanes = s.lanes(length, term);
  lanes.coordinates = 0;
  compute(lanes);
  EXPECT_GT(length[11], 0.0);
  EXPECT_EQ(term, std::vector<double>(36, -1.0));
}

}  // namespace
}  // namespace veridyn::muscle::internal
