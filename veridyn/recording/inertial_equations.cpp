#include "veridyn/recording/inertial_equations.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::recording::internal {
namespace {

using estimation::RegressionData;

constexpr std::size_t kFewestWindows = 60;
/// Root mean square of the horizontal acceleration from which on it shows the zero of the heading [m/s^2].
constexpr double kShowsHeading = 1.0;
/// The same of the heading in which it shows least of zero and deviation: turns in all directions.
constexpr double kShowsDeviation = 0.3;
/// Standard error of an inverse gain, as a share of it, beyond which its axis did not move enough.
constexpr double kUndetermined = 0.1;
/// Share of the reference's signal that is neither explained nor noise of it, from which on sensor and reference
/// contradict each other whatever moved.
constexpr double kContradicted = 0.5;
/// The largest attenuation that counts as a doubt of a gain: what leaves more unexplained is no noise of a reading.
constexpr double kMostAttenuated = 0.6;

/// Gain and bias from the inverse gain N and offset c (truth = N reading + c): reading = G truth - G c, with
/// dG = -G dN G.
SensorMatrix inverted(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance) {
  Matrix3 N;
  for (Eigen::Index i = 0; i < 3; ++i) N.row(i) = theta.segment<3>(3 * i).transpose();
  SensorMatrix m;
  m.gain = N.inverse();
  m.bias = -m.gain * theta.tail<3>();
  const Matrix3& G = m.gain;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      Eigen::VectorXd slope = Eigen::VectorXd::Zero(kUnknowns);
      for (Eigen::Index k = 0; k < 3; ++k)
        for (Eigen::Index l = 0; l < 3; ++l) slope(3 * k + l) = -G(i, k) * G(l, j);
      m.gain_sigma(i, j) = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
    }
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(kUnknowns);
    slope.tail<3>() = -G.row(i).transpose();
    // The offset's own part: -G dc + G dN G c.
    const Vector3 Gc = G * theta.tail<3>();
    for (Eigen::Index k = 0; k < 3; ++k)
      for (Eigen::Index l = 0; l < 3; ++l) slope(3 * k + l) = G(i, k) * Gc(l);
    m.bias_sigma(i) = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
  }
  return m;
}

}  // namespace

Eigen::Matrix<double, 3, kUnknowns> regressors(const Matrix3& T, const Vector3& reading) {
  Eigen::Matrix<double, 3, kUnknowns> X;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) X.col(3 * i + j) = T.col(i) * reading(j);
    X.col(9 + i) = T.col(i);
  }
  return X;
}

/// How many of the heading's are shown: none, its zero, or its deviation too.
Eigen::Index Equations::heading_unknowns() const {
  Matrix3 squares = Matrix3::Zero();
  for (const Row& row : rows_) {
    const Eigen::Matrix3d X = row.X.middleCols<3>(kHeading);
    squares += X.transpose() * X;
  }
  squares /= static_cast<double>(rows_.size());
  if (!(std::sqrt(squares(0, 0)) > kShowsHeading)) return 0;
  return std::sqrt(numerics::symmetric_eigenvalues(squares).minCoeff()) > kShowsDeviation ? 3 : 1;
}

/// Places of the unknowns that are estimated.
std::vector<Eigen::Index> Equations::unknowns(const Moved& moved, bool delays) const {
  const Eigen::Index heading = delays ? heading_unknowns() : 0;
  std::vector<Eigen::Index> places;
  for (Eigen::Index k = 0; k < (delays ? kHeading + heading : kUnknowns); ++k)
    if (k >= 9 || moved[k % 3]) places.push_back(k);
  return places;
}

RegressionData Equations::data(const Moved& moved, bool delays) const {
  const std::vector<Eigen::Index> places = unknowns(moved, delays);
  const auto n = signed_index(rows_.size());
  RegressionData data;
  data.regressors.resize(3 * n, signed_index(places.size()));
  data.regressand.resize(3 * n);
  data.segment.resize(3 * rows_.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const Row& row = rows_[k];
      data.regressors.row(axis * n + k) = row.X.row(axis)(places);
      double known = 0.0;
      for (Eigen::Index j = 0; j < 3; ++j)
        if (!moved[j]) known += row.X(axis, 4 * j);
      data.regressand(axis * n + k) = row.z(axis) - known;
      data.segment[axis * n + k] = static_cast<int>(axis);
    }
  }
  for (const Eigen::Index k : places) data.parameter_names.push_back(fmt::format("n{}", k));
  return data;
}

/// Of the reading of an axis about its mean.
double Equations::power(std::size_t axis) const {
  Vector3 sum = Vector3::Zero(), squares = Vector3::Zero();
  for (const Row& row : rows_) {
    const Vector3 x = row.X.col(signed_index(4 * axis));
    sum += x;
    squares += x.cwiseProduct(x);
  }
  return (squares - sum.cwiseProduct(sum) / static_cast<double>(rows_.size())).sum();
}

double Equations::signal_rms() const {
  const auto n = static_cast<double>(rows_.size());
  Vector3 sum = Vector3::Zero(), squares = Vector3::Zero();
  for (const Row& row : rows_) {
    sum += row.z;
    squares += row.z.cwiseProduct(row.z);
  }
  return std::sqrt((squares - sum.cwiseProduct(sum) / n).sum() / (3.0 * n));
}

Equations::Estimate Equations::estimate(const Moved& moved, bool delays) const {
  estimation::RegressionOptions options;
  options.max_lag = 20;
  const RegressionData data = this->data(moved, delays);
  const estimation::RegressionEstimate found = estimation::estimate(data, estimation::Method::kOls, options);
  Estimate all{.known = found.usable() && found.covariance.allFinite()};
  for (Eigen::Index j = 0; j < 3; ++j)
    if (!moved[j]) all.theta(4 * j) = 1.0;
  if (!all.known) return all;
  const std::vector<Eigen::Index> places = unknowns(moved, delays);
  all.theta(places) = found.theta;
  all.covariance(places, places) = found.covariance;
  const auto n = static_cast<double>(rows_.size());
  all.residual_rms = std::sqrt((data.regressand - data.regressors * found.theta).squaredNorm() / (3.0 * n));
  // What the noise of the reference leaves unexplained, laid to the reading of one axis.
  const double excess = std::max(0.0, 1.0 - reference_noise_ / (all.residual_rms * all.residual_rms));
  all.contradicted = excess * std::pow(all.residual_rms / signal_rms(), 2.0) > kContradicted;
  for (std::size_t a = 0; a < places.size(); ++a) {
    const Eigen::Index k = places[a], j = k % 3;
    if (k != 4 * j || k >= 9) continue;
    const double size = std::hypot(all.theta(j), all.theta(3 + j), all.theta(6 + j));
    all.relative_sigma(j) = std::sqrt(all.covariance(k, k)) / size;
    if (all.contradicted) continue;
    const double white = found.covariance_white(signed_index(a), signed_index(a));
    all.attenuation(j) = std::min(kMostAttenuated, 3.0 * n * excess * white / (size * size));
  }
  return all;
}

std::optional<Solved> Equations::solve(bool delays, Moved moved) const {
  if (rows_.size() < kFewestWindows) return std::nullopt;
  Estimate found = estimate(moved, delays);
  // One axis after the other: what one that rests leaves to the others is then theirs.
  for (int step = 0; step < 3; ++step) {
    Vector3 rest = found.relative_sigma / kUndetermined;
    for (Eigen::Index j = 0; j < 3; ++j) {
      if (!found.known) rest(j) = 1.0 + 1.0 / (1e-12 + power(j));
      if (!moved[j]) rest(j) = 0.0;
    }
    Eigen::Index least = 0;
    if (rest.maxCoeff(&least) <= 1.0 || found.contradicted) break;
    moved[least] = false;
    found = estimate(moved, delays);
  }
  if (!found.known) return std::nullopt;
  Solved solved{.matrix = inverted(found.theta.head(kUnknowns), found.covariance.topLeftCorner(kUnknowns, kUnknowns)),
                .delay = found.theta.segment<3>(kUnknowns),
                .delay_sigma = found.covariance.diagonal().segment<3>(kUnknowns).cwiseSqrt()};
  SensorMatrix& m = solved.matrix;
  if (!m.gain.allFinite()) return std::nullopt;
  m.moved = moved;
  for (Eigen::Index j = 0; j < 3; ++j)
    m.gain_sigma(j, j) =
        std::hypot(m.gain_sigma(j, j), found.attenuation(j) * m.gain(j, j) / estimation::kBeyondChance);
  m.residual_rms = found.residual_rms;
  m.signal_rms = signal_rms();
  m.rows = signed_index(rows_.size());
  return solved;
}

}  // namespace veridyn::recording::internal
