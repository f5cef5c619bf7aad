#include "veridyn/camera/calibration/calibration_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>
#include <vector>

#include "veridyn/core/at_place.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::camera {
namespace {

constexpr int kCount = TrackCamera::kParameters;
constexpr std::size_t kTriangle = std::size_t{kCount} * (kCount + 1) / 2;

std::vector<double> read_numbers(const StudyTable& table, std::string_view key, std::size_t count) {
  std::vector<double> values = table.numbers(key, "1");
  if (values.size() != count) table.fail(key, fmt::format("has {} numbers; must have {}", values.size(), count));
  return values;
}

void read_covariance(const StudyTable& table, Calibration& c) {
  const std::vector<double> triangle = read_numbers(table, "covariance", kTriangle);
  const int fitted = c.distorted ? kCount : 8;
  std::size_t k = 0;
  for (int i = 0; i < kCount; ++i) {
    for (int j = 0; j <= i; ++j, ++k) {
      c.covariance(i, j) = c.covariance(j, i) = triangle[k];
      if (i >= fitted && triangle[k] != 0.0)
        table.fail("covariance", "must be 0 for centre and radial terms of a map that is not distorted");
    }
  }
  // In units of the standard errors: the parameters differ by eight powers of ten.
  Eigen::MatrixXd scaled = c.covariance.topLeftCorner(fitted, fitted);
  const Eigen::VectorXd sigma = scaled.diagonal().cwiseSqrt();
  if (!(sigma.array() > 0.0).all()) table.fail("covariance", "must have a diagonal > 0");
  scaled = sigma.cwiseInverse().asDiagonal() * scaled * sigma.cwiseInverse().asDiagonal();
  // Rounding of a nearly singular matrix is forgiven.
  scaled.diagonal().array() += 1e-9;
  if (!numerics::Cholesky(scaled).positive_definite()) table.fail("covariance", "must be positive definite");
}

}  // namespace

std::string to_toml(const Calibration& c) {
  const TrackCamera& m = c.camera;
  std::vector<double> parameters(m.parameters().begin(), m.parameters().end()), triangle;
  for (int i = 0; i < kCount; ++i)
    for (int j = 0; j <= i; ++j) triangle.push_back(c.covariance(i, j));
  std::string text = fmt::format(
      "# Map from a track (x, y on the plane [m]) to an image (x right, y down [px]); see docs/camera.md.\n[camera]\n"
      "track_centre = [{}, {}]\ntrack_scale = {}\nimage_scale = {}\ndistorted = {}\n"
      "# h0 ... h7, centre x, y [px], k1, k2\nparameters = [{}]\npoints = {}\nrms_image = {}  # [px]\n"
      "rms_track = {}  # [m]\nsystematic_image = {}  # [px]\n",
      m.track_centre()(0), m.track_centre()(1), m.track_scale(), m.image_scale(), c.distorted,
      fmt::join(parameters, ", "), c.points, c.rms_image, c.rms_track, c.systematic_image);
  if (std::isfinite(c.sigma_image)) {
    text += fmt::format("sigma_image = {}  # [px]\n# of the parameters, lower triangle by rows\ncovariance = [{}]\n",
                        c.sigma_image, fmt::join(triangle, ", "));
  }
  return text;
}

Calibration parse_calibration(std::string_view text, std::string name) {
  const Study study = Study::parse(text, std::move(name));
  const StudyTable table = study.root().table("camera");
  Calibration c;
  c.distorted = table.flag_or("distorted", true);
  const std::vector<double> centre = read_numbers(table, "track_centre", 2);
  const std::vector<double> parameters = read_numbers(table, "parameters", kCount);
  const double track_scale = table.positive("track_scale", "1"), image_scale = table.positive("image_scale", "1");
  c.camera = at_place(table.place("parameters"), [&] {
    return TrackCamera(TrackCamera::Parameters(parameters.data()), {centre[0], centre[1]}, track_scale, image_scale);
  });
  const long long points = table.integer_or("points", 4);
  if (points < 4) table.fail("points", "must be at least 4");
  c.points = static_cast<std::size_t>(points);
  c.rms_image = table.number_or("rms_image", "1", 0.0);
  c.rms_track = table.number_or("rms_track", "1", 0.0);
  c.systematic_image = table.number_or("systematic_image", "1", 0.0);
  if (!(c.systematic_image >= 0.0)) table.fail("systematic_image", "must be >= 0");
  c.converged = true;
  if (table.has("covariance") || table.has("sigma_image")) {
    c.sigma_image = table.positive("sigma_image", "1");
    read_covariance(table, c);
  } else {
    c.sigma_image = kNaN;
    c.covariance.setConstant(kNaN);
  }
  study.root().finish();
  return c;
}

Calibration read_calibration(const std::filesystem::path& path) {
  return parse_calibration(read_file(path), path.string());
}

}  // namespace veridyn::camera
