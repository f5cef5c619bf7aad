#include "veridyn/camera/calibration/calibration_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "tests/camera/synthetic_camera.hpp"
#include "tests/support/folders.hpp"

namespace veridyn::camera {
namespace {

using ::testing::HasSubstr;

TEST(CalibrationChecks, PassForTheRightModel) {
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const CalibrationPoints points = testing::grid_points(testing::wide_camera(), 0.2, 0.3, seed);
    const Calibration c = fit_camera(points);
    for (const CheckOutcome& check : calibration_checks(points, c)) failed += check.passed ? 0 : 1;
    EXPECT_LT(c.systematic_image, 0.1);
  }
  EXPECT_LE(failed, 2);  // 0.3 expected at 1 %
}

TEST(CalibrationChecks, NoticeAModelThatIsTooPoor) {
  const CalibrationPoints points = testing::grid_points(testing::wide_camera(), 0.2, 0.3, 1);
  const Calibration c = fit_camera(points, Distortion::kNone);
  const CheckOutcome check = calibration_checks(points, c).front();
  EXPECT_FALSE(check.passed);
  EXPECT_THAT(check.text, HasSubstr("residuals depend on the place"));
  EXPECT_GT(c.systematic_image, 0.7 * c.sigma_image);
}

TEST(CalibrationChecks, NoticeThatARealLensNeedsMoreTerms) {
  const auto file = test::shared_folder() / "data/vehicle/cpm_lab/calibration_points.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the shared data are not here";
  const CalibrationPoints points = read_calibration_points(file);
  const std::vector<CheckOutcome> checks = calibration_checks(points, fit_camera(points));
  EXPECT_FALSE(checks.front().passed) << checks.front().text;
  for (std::size_t i = 2; i < checks.size(); ++i) EXPECT_TRUE(checks[i].passed) << checks[i].text;
}

TEST(CalibrationChecks, NameSwappedPoints) {
  CalibrationPoints points = testing::grid_points(testing::wide_camera(), 0.4, 0.3, 1);
  std::swap(points.points[7].image, points.points[8].image);
  const Calibration c = fit_camera(points);
  std::vector<std::size_t> off = outlying_points(c.residuals);
  ASSERT_GE(off.size(), 2U);
  EXPECT_THAT(std::vector<std::size_t>(off.begin(), off.begin() + 2), ::testing::UnorderedElementsAre(7U, 8U));
  const CheckOutcome check = calibration_checks(points, c)[1];
  EXPECT_FALSE(check.passed);
  EXPECT_THAT(check.text, HasSubstr("grid: point 8 ("));
  EXPECT_THAT(check.text, HasSubstr("grid: point 9 ("));
}

TEST(CalibrationChecks, NoticeAMirrorAndMillimetres) {
  CalibrationPoints points = testing::grid_points(testing::wide_camera(), 0.4, 0.3, 1);
  CalibrationPoints mirrored = points, large = points;
  for (CalibrationPoint& p : mirrored.points) std::swap(p.track(0), p.track(1));
  for (CalibrationPoint& p : large.points) p.track *= 1000.0;
  const CheckOutcome mirror = calibration_checks(mirrored, fit_camera(mirrored))[2];
  EXPECT_FALSE(mirror.passed);
  EXPECT_THAT(mirror.text, HasSubstr("as in a mirror"));
  const CheckOutcome scale = calibration_checks(large, fit_camera(large))[3];
  EXPECT_FALSE(scale.passed);
  EXPECT_THAT(scale.text, HasSubstr("world_x[mm]"));
}

}  // namespace
}  // namespace veridyn::camera
