#include "veridyn/aircraft/information_bound.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace veridyn::aircraft {
namespace {

AngleBound bound(double length, double intensity, double airspeed, double vane_sigma, double rate_Hz) {
  using Eigen::Matrix2d, Eigen::Vector2d;
  const double step = airspeed / (length * rate_Hz);
  const double e = std::exp(-step);
  Matrix2d F, Pi;
  F << e, 0.0, step * e, e;
  Pi << 0.5, 0.25, 0.25, 0.25;
  const Matrix2d Q = Pi - F * Pi * F.transpose();
  const double gain = intensity * std::sqrt(3.0) / airspeed;
  const Vector2d H(gain, -gain * (1.0 - 1.0 / std::sqrt(3.0)));

  // Both recursions forget their start within a few correlation times of the gust.
  const int steps = static_cast<int>(std::ceil(40.0 / step));
  Matrix2d before = Pi, after = Pi;
  Vector2d K = Vector2d::Zero();
  double S = 1.0;
  for (int i = 0; i < steps; ++i) {
    S = H.dot(before * H) + vane_sigma * vane_sigma;
    K = before * H / S;
    after = before - S * K * K.transpose();
    before = F * after * F.transpose() + Q;
  }
  const Matrix2d C = Matrix2d::Identity() - K * H.transpose();
  Matrix2d Lambda = Matrix2d::Zero();
  for (int i = 0; i < steps; ++i) {
    Lambda = F.transpose() * (H * H.transpose() / S + C.transpose() * Lambda * C) * F;
  }
  const Matrix2d smoothed = after - after * Lambda * after;
  return {std::sqrt(H.dot(after * H)), std::sqrt(H.dot(smoothed * H))};
}

}  // namespace

InformationBound information_bound(const DrydenSettings& spectrum, double airspeed, double vane_sigma, double rate_Hz) {
  return {bound(spectrum.Lw, spectrum.sigma_w, airspeed, vane_sigma, rate_Hz),
          bound(spectrum.Lv, spectrum.sigma_v, airspeed, vane_sigma, rate_Hz)};
}

}  // namespace veridyn::aircraft
