#include "veridyn/camera/tracking/marker_pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <vector>

#include "tests/camera/rendered_drive.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera {
namespace {

constexpr std::array<std::size_t, 3> kShuffled{2, 0, 1};

Eigen::Vector2d placed(const Eigen::Vector3d& pose, const Eigen::Vector2d& marker) {
  return pose.head<2>() + Eigen::Rotation2Dd(pose(2)) * marker;
}

/// The markers of a car in the order above, each seen with an error of its own shape.
std::vector<Spot> spots_at(const Eigen::Vector3d& pose, const MarkerLayout& layout) {
  std::vector<Spot> spots;
  for (const std::size_t marker : kShuffled) {
    Spot spot;
    spot.place = placed(pose, layout.markers[marker]);
    const auto size = 1e-6 * static_cast<double>(marker + 1);
    spot.noise << size, 0.3 * size, 0.3 * size, 2.0 * size;
    spot.J_place_parameters.setZero();
    spots.push_back(spot);
  }
  return spots;
}

PoseMeasurement fitted(const std::vector<Spot>& spots, const MarkerLayout& layout, const Calibration& calibration) {
  std::vector<const Spot*> views;
  for (const Spot& s : spots) views.push_back(&s);
  return fit_pose(views, {kShuffled.data(), views.size()}, layout, calibration).value();
}

TEST(MarkerPose, OfExactSpotsIsExact) {
  const MarkerLayout layout;
  for (const double heading : {0.2, 2.0, 4.5}) {
    const Eigen::Vector3d pose(1.9, 1.1, heading);
    for (const std::size_t seen : {3U, 2U}) {
      std::vector<Spot> spots = spots_at(pose, layout);
      spots.resize(seen);
      const PoseMeasurement m = fitted(spots, layout, {});
      EXPECT_LT((m.pose.head<2>() - pose.head<2>()).norm(), 1e-12);
      EXPECT_NEAR(std::remainder(m.pose(2) - heading, 2.0 * kPi), 0.0, 1e-12);
      EXPECT_LE(std::abs(m.pose(2)), kPi);
      EXPECT_NEAR(m.chi_square, 0.0, 1e-12);
      EXPECT_EQ(m.markers, seen);
    }
  }
  const Spot lone = spots_at({0.0, 0.0, 0.0}, layout)[0];
  const Spot* one[] = {&lone};
  EXPECT_FALSE(fit_pose(one, {kShuffled.data(), 1}, layout, {}).has_value());
}

// The covariance against the scatter of many fits; three markers leave three of six coordinates over.
TEST(MarkerPose, NoiseIsTheScatterOfItsFits) {
  const MarkerLayout layout{.sigma = 1e-3};
  const Eigen::Vector3d pose(2.0, 1.3, 0.7);
  const std::vector<Spot> exact = spots_at(pose, layout);
  numerics::RandomStream random(3, "spots");
  constexpr int kFits = 4000;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double misfit = 0.0;
  for (int k = 0; k < kFits; ++k) {
    std::vector<Spot> spots = exact;
    for (Spot& s : spots) {
      const Eigen::Matrix2d C = s.noise + layout.sigma * layout.sigma * Eigen::Matrix2d::Identity();
      s.place += Eigen::LLT<Eigen::Matrix2d>(C).matrixL() * Eigen::Vector2d(random.normal(), random.normal());
    }
    const PoseMeasurement m = fitted(spots, layout, {});
    scatter += (m.pose - pose) * (m.pose - pose).transpose() / kFits;
    misfit += m.chi_square / kFits;
  }
  const Eigen::Vector3d unit = fitted(exact, layout, {}).noise.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d stated = unit.asDiagonal() * fitted(exact, layout, {}).noise * unit.asDiagonal();
  // A variance from 4000 fits is right to 2 %.
  EXPECT_LT((unit.asDiagonal() * scatter * unit.asDiagonal() - stated).cwiseAbs().maxCoeff(), 0.09);
  EXPECT_NEAR(misfit, 3.0, 0.15);
}

// What an error of a parameter of the map does to the pose, by fitting it with that parameter changed.
TEST(MarkerPose, ErrorsOfTheMapMoveItAsStated) {
  const MarkerLayout layout;
  const Eigen::Vector3d pose(2.6, 1.0, -0.4);
  Calibration calibration;
  calibration.camera = testing::half_size_camera();
  std::vector<Blob> blobs;
  for (const std::size_t marker : kShuffled) {
    Blob blob;
    blob.centre = calibration.camera.to_image(placed(pose, layout.markers[marker])).value();
    blob.covariance = 0.01 * Eigen::Matrix2d::Identity();
    blobs.push_back(blob);
  }
  const auto pose_by = [&](const TrackCamera& camera) {
    Calibration c = calibration;
    c.camera = camera;
    std::vector<Spot> spots;
    spots_of(blobs, c, spots);
    return fitted(spots, layout, c);
  };
  EXPECT_LT((pose_by(calibration.camera).pose - pose).norm(), 1e-9);
  for (const int parameter : {0, 2, 4, 6, 8, 10}) {
    const TrackCamera& camera = calibration.camera;
    TrackCamera::Parameters changed = camera.parameters();
    const double step = 1e-4 * std::max(1.0, std::abs(changed(parameter)));
    changed(parameter) += step;
    const Eigen::Vector3d moved =
        (pose_by({changed, camera.track_centre(), camera.track_scale(), camera.image_scale()}).pose - pose) / step;
    calibration.covariance.setZero();
    calibration.covariance(parameter, parameter) = 4.0;
    const Eigen::Matrix3d map = pose_by(camera).map;
    EXPECT_LT((map - 4.0 * moved * moved.transpose()).norm(), 2e-2 * map.norm()) << parameter;
    EXPECT_GT(map.norm(), 0.0);
  }
  blobs[1].disturbed = true;
  std::vector<Spot> spots;
  spots_of(blobs, calibration, spots);
  EXPECT_EQ(spots.size(), 2U);
}

TEST(MarkerLayout, MustTellItsMarkersApart) {
  const auto refusal = [](std::vector<Eigen::Vector2d> markers) {
    return why([&] { MarkerLayout{.markers = std::move(markers)}.validate(); });
  };
  EXPECT_EQ(why([] { MarkerLayout().validate(); }), "nothing was refused");
  EXPECT_EQ(refusal({{0.1, 0.0}}), "markers: 1 markers; must be two or three");
  EXPECT_EQ(refusal({{0.1, 0.0}, {0.1, 0.004}}), "markers: markers 1 and 2 are at one place");
  // Equal sides: a third of a turn is not seen.
  EXPECT_NE(refusal({{0.1, 0.0}, {-0.05, 0.0866}, {-0.05, -0.0866}}).find("must differ by more than 5 mm"),
            std::string::npos);
  EXPECT_NE(refusal({{0.1, 0.0}, {std::nan(""), 0.0}}).find("marker 2 is not a place"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::camera
