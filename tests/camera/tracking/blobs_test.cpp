#include "veridyn/camera/tracking/blobs.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::camera {
namespace {

/// A Gaussian spot on an even ground, with white noise.
GreyImage picture(const Eigen::Vector2d& centre, double width_px, double noise, numerics::RandomStream& random) {
  GreyImage image{.width = 90, .height = 70, .pixels = {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double r2 = (Eigen::Vector2d(x, y) - centre).squaredNorm();
      const double grey = 30.0 + 160.0 * std::exp(-0.5 * r2 / (width_px * width_px)) + noise * random.normal();
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0)));
    }
  }
  return image;
}

TEST(BlobFinder, StatesTheErrorOfACentre) {
  numerics::RandomStream random(3, "blobs");
  BlobFinder finder;
  constexpr int kPictures = 400;
  double mean_x = 0.0, squares = 0.0, noise = 0.0;
  for (int k = 0; k < kPictures; ++k) {
    const Eigen::Vector2d centre(45.0 + random.uniform(), 35.0 + random.uniform());
    const auto blobs = finder.find(picture(centre, 2.0, 3.0, random).view());
    ASSERT_EQ(blobs.size(), 1U);
    EXPECT_FALSE(blobs[0].disturbed);
    const Eigen::Vector2d off = blobs[0].centre - centre;
    mean_x += off(0) / kPictures;
    const Eigen::Matrix2d of_noise = blobs[0].covariance - 1e-3 * Eigen::Matrix2d::Identity();
    squares += off.dot(of_noise.inverse() * off) / (2.0 * kPictures);
    noise += finder.noise() / kPictures;
  }
  EXPECT_NEAR(noise, 3.0, 0.1);  // from 200 pixels each, 0.3 for one picture
  EXPECT_NEAR(mean_x, 0.0, 0.005);
  // Chi-square over 800 degrees of freedom has a standard deviation of 0.05; what the cut at a quarter of the height
  // does (pixels that come and go with the noise, shape of the pixels) is a little more. The floor is left out.
  EXPECT_GT(squares, 0.8);
  EXPECT_LT(squares, 1.4);
}

TEST(BlobFinder, SaysWhichSpotsAreDisturbed) {
  GreyImage image{.width = 100, .height = 60, .pixels = std::vector<std::uint8_t>(6000, 20)};
  const auto put = [&](int x, int y, int size) {
    for (int i = 0; i < size; ++i)
      for (int k = 0; k < size; ++k) image.pixels[(y + k) * 100 + x + i] = 200;
  };
  put(20, 20, 4);
  put(26, 20, 4);  // its light is in the window of the one before
  put(60, 30, 4);
  put(97, 50, 3);  // at the edge
  put(80, 5, 1);   // one pixel
  BlobFinder finder;
  const auto blobs = finder.find(image.view());
  ASSERT_EQ(blobs.size(), 4U);
  int disturbed = 0;
  for (const Blob& b : blobs) disturbed += b.disturbed ? 1 : 0;
  EXPECT_EQ(disturbed, 3);
  for (const Blob& b : blobs) {
    if (!b.disturbed) {
      EXPECT_NEAR((b.centre - Eigen::Vector2d(61.5, 31.5)).norm(), 0.0, 1e-12);
    }
  }
}

TEST(BlobFinder, JoinsPixelsThatTouchAtCorners) {
  GreyImage image{.width = 64, .height = 64, .pixels = std::vector<std::uint8_t>(4096, 10)};
  // A "V": its arms are one spot although they meet in the last row only.
  for (int i = 0; i < 6; ++i) {
    image.pixels[(20 + i) * 64 + 20 + i] = 200;
    image.pixels[(20 + i) * 64 + 30 - i] = 200;
  }
  BlobFinder finder;
  EXPECT_EQ(finder.find(image.view()).size(), 1U);
}

TEST(BlobFinder, FindsNothingInTheDarkOrInANull) {
  numerics::RandomStream random(4, "dark");
  BlobFinder finder;
  EXPECT_TRUE(finder.find(picture({-50.0, -50.0}, 1.0, 3.0, random).view()).empty());
  EXPECT_TRUE(finder.find(GreyView{}).empty());
  BlobOptions options;
  options.contrast = 0.0;
  EXPECT_EQ(why([&] { BlobFinder{options}; }), "blobs: contrast must be 1 to 255 grey levels");
}

}  // namespace
}  // namespace veridyn::camera
