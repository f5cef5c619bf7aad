#include "veridyn/camera/calibration/calibration_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/camera/synthetic_camera.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::camera {
namespace {

using ::testing::HasSubstr;

TEST(CalibrationFile, ReadsBackToTheSameNumbers) {
  for (const Distortion distortion : {Distortion::kNone, Distortion::kRadial}) {
    const Calibration c = fit_camera(testing::grid_points(testing::wide_camera(), 0.3, 0.3, 5), distortion);
    const Calibration again = parse_calibration(to_toml(c), "calibration.toml");
    EXPECT_EQ(again.camera.parameters(), c.camera.parameters());
    EXPECT_EQ(again.camera.track_centre(), c.camera.track_centre());
    EXPECT_EQ(again.camera.image_scale(), c.camera.image_scale());
    EXPECT_EQ(again.covariance, c.covariance);
    EXPECT_EQ(again.sigma_image, c.sigma_image);
    EXPECT_EQ(again.systematic_image, c.systematic_image);
    EXPECT_EQ(again.distorted, c.distorted);
    EXPECT_EQ(again.points, c.points);
  }
}

TEST(CalibrationFile, AnUnknownErrorStaysUnknown) {
  Calibration c = fit_camera(testing::grid_points(testing::wide_camera(), 0.3, 0.3, 5));
  c.sigma_image = std::nan("");
  const Calibration again = parse_calibration(to_toml(c), "calibration.toml");
  EXPECT_TRUE(std::isnan(again.sigma_image));
  EXPECT_TRUE(std::isnan(again.track_covariance({1.0, 1.0}, Eigen::Matrix2d::Identity())(0, 0)));
}

TEST(CalibrationFile, RefusesWhatIsNoMap) {
  const std::string good = to_toml(fit_camera(testing::grid_points(testing::wide_camera(), 0.3, 0.3, 5)));
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t where = text.find(from);
    EXPECT_NE(where, std::string::npos) << from;
    text.replace(where, from.size(), to);
    return why([&] { (void)parse_calibration(text, "c.toml"); });
  };
  EXPECT_THAT(refusal("parameters = [", "parameters = [1.0, "),
              HasSubstr("c.toml:8: camera.parameters: has 13 numbers; must have 12"));
  EXPECT_THAT(refusal("track_scale = ", "track_scale = -"), HasSubstr("c.toml:4: camera.track_scale"));
  EXPECT_THAT(refusal("covariance = [", "covariance = [-"), HasSubstr("must have a diagonal > 0"));
  Calibration indefinite = fit_camera(testing::grid_points(testing::wide_camera(), 0.3, 0.3, 5));
  indefinite.covariance(1, 0) = 1.1 * indefinite.sigma()(0) * indefinite.sigma()(1);
  EXPECT_THAT(why([&] { (void)parse_calibration(to_toml(indefinite), "c.toml"); }),
              HasSubstr("covariance: must be positive definite"));
  EXPECT_THAT(refusal("points = ", "pionts = "), HasSubstr("pionts"));
  EXPECT_THAT(refusal("[camera]", "[camara]"), HasSubstr("camera"));
}

}  // namespace
}  // namespace veridyn::camera
