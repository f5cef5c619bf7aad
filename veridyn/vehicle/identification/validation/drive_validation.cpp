#include "veridyn/vehicle/identification/validation/drive_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::vehicle {
namespace {

/// Measured and modelled values of one quantity over all spans.
struct Pairs {
  std::vector<double> measured, model;
  std::vector<int> span;
  void add(const std::vector<double>& m, const std::vector<double>& p, int id) {
    for (std::size_t k = 0; k < m.size(); ++k) {
      if (!std::isfinite(m[k]) || !std::isfinite(p[k])) continue;
      measured.push_back(m[k]);
      model.push_back(p[k]);
      span.push_back(id);
    }
  }
};

/// Samples over which a residual is looked at for its memory.
constexpr std::size_t kLongestMemory = 200;

constexpr auto place_of(DriveUnknown u) { return static_cast<Eigen::Index>(u); }

struct PlanePath {
  std::vector<double> x, y;
};

/// A path turned and moved so that its first point meets that of another and the rest fits best (their complex
/// regression).
PlanePath laid_on(PlanePath path, const std::vector<double>& x_to, const std::vector<double>& y_to) {
  auto& [x, y] = path;
  std::size_t first = 0;
  while (first < x.size() && !(std::isfinite(x[first]) && std::isfinite(y[first]))) ++first;
  if (first == x.size()) return path;
  const double x0 = x[first], y0 = y[first];
  double dot = 0.0, cross = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] -= x0;
    y[k] -= y0;
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    const double px = x_to[k] - x_to[first], py = y_to[k] - y_to[first];
    dot += x[k] * px + y[k] * py;
    cross += x[k] * py - y[k] * px;
  }
  const double norm = std::hypot(dot, cross);
  const double c = norm > 0.0 ? dot / norm : 1.0, s = norm > 0.0 ? cross / norm : 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double turned = c * x[k] - s * y[k] + x_to[first];
    y[k] = s * x[k] + c * y[k] + y_to[first];
    x[k] = turned;
  }
  return path;
}

/// Measured and predicted outputs of one segment of the model.
PredictedStretch predicted_outputs(const DriveSignals& signals, const DriveParametricModel& model, std::size_t segment,
                                   const estimation::RowMatrix& y) {
  const std::size_t begin = model.first_sample(segment);
  const auto n = static_cast<std::size_t>(model.samples(segment));
  const auto measured = [&](DriveSignal which) -> std::vector<double> {
    const std::vector<double>& all = signals[which].value;
    if (all.empty()) return {};
    const auto from = all.begin() + begin;
    return {from, from + static_cast<std::ptrdiff_t>(n)};
  };
  const bool accel = signals[DriveSignal::kAccelY].available();
  const bool lateral = signals[DriveSignal::kLateralVelocity].available();
  PredictedStretch drive;
  drive.span = model.segment_span(segment);
  drive.steer = measured(DriveSignal::kSteer);
  drive.speed = measured(DriveSignal::kSpeed);
  drive.yaw_rate = measured(DriveSignal::kYawRate);
  drive.accel_y = measured(DriveSignal::kAccelY);
  drive.lateral_velocity = measured(DriveSignal::kLateralVelocity);
  for (std::size_t k = 0; k < n; ++k) {
    drive.time.push_back(signals.grid.at(begin + k));
    drive.yaw_rate_predicted.push_back(y(k, 0));
    if (accel) drive.accel_y_predicted.push_back(y(k, 1));
    if (lateral) drive.lateral_velocity_predicted.push_back(y(k, accel ? 2 : 1));
  }
  drive.x = measured(DriveSignal::kX);
  drive.y = measured(DriveSignal::kY);
  return drive;
}

/// The stretch with path and heading: trapezoids of what the model says, and of the gyro less its bias. The lateral
/// velocity is no output where it is not measured: it is integrated from yaw rate and accel_y then, from `v` on.
PredictedStretch with_path(PredictedStretch drive, const DriveSignals& signals, const Eigen::VectorXd& theta,
                           double v) {
  const bool accel = signals[DriveSignal::kAccelY].available();
  const bool lateral = signals[DriveSignal::kLateralVelocity].available();
  const double step = signals.grid.step;
  const double yaw_bias = theta(place_of(DriveUnknown::kYawRateBias));
  const double accel_bias = theta(place_of(DriveUnknown::kAccelYBias));
  const double accel_scale = 1.0 + theta(place_of(DriveUnknown::kAccelYScale));
  const double ax = signals.accel_position[0], ay = signals.accel_position[1];
  double psi = 0.0, psi_measured = 0.0, px = 0.0, py = 0.0;
  for (std::size_t k = 0; k < drive.time.size(); ++k) {
    const double r = drive.yaw_rate_predicted[k] - yaw_bias;
    if (k > 0) {
      const double r_before = drive.yaw_rate_predicted[k - 1] - yaw_bias;
      const double psi_before = psi;
      psi += 0.5 * step * (r + r_before);
      psi_measured += 0.5 * step * (drive.yaw_rate[k] + drive.yaw_rate[k - 1] - 2.0 * yaw_bias);
      const double u = 0.5 * (drive.speed[k] + drive.speed[k - 1]);
      const double middle = 0.5 * (psi + psi_before);
      if (lateral) {
        v = 0.5 * (drive.lateral_velocity_predicted[k] + drive.lateral_velocity_predicted[k - 1]);
      } else if (accel) {
        const double dr = (r - r_before) / step;
        const double a_y =
            (0.5 * (drive.accel_y_predicted[k] + drive.accel_y_predicted[k - 1]) - accel_bias) / accel_scale - ax * dr +
            ay * r * r;
        v += step * (a_y - 0.5 * (r + r_before) * u);
      }
      px += step * (u * std::cos(middle) - v * std::sin(middle));
      py += step * (u * std::sin(middle) + v * std::cos(middle));
    }
    drive.yaw_predicted.push_back(psi);
    drive.yaw.push_back(psi_measured);
    drive.x_predicted.push_back(px);
    drive.y_predicted.push_back(py);
  }
  if (!drive.x.empty()) {
    PlanePath path = laid_on({std::move(drive.x), std::move(drive.y)}, drive.x_predicted, drive.y_predicted);
    drive.x = std::move(path.x);
    drive.y = std::move(path.y);
  }
  return drive;
}

/// Standard deviations of a segment's outputs by the covariance of the parameters: a row per sample, a column per
/// output; empty where the model diverges.
Eigen::MatrixXd output_sigmas(const DriveParametricModel& model, std::size_t segment, const Eigen::VectorXd& full,
                              const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> active(kDriveUnknowns);
  std::iota(active.begin(), active.end(), Eigen::Index{0});
  estimation::ModelResponse response;
  if (!model.respond(segment, full, active, response)) return {};
  Eigen::MatrixXd sigma(model.samples(segment), model.outputs().size());
  for (Eigen::Index k = 0; k < sigma.rows(); ++k) {
    for (Eigen::Index j = 0; j < sigma.cols(); ++j) {
      const Eigen::VectorXd g = response.sensitivity.row(k * sigma.cols() + j).transpose();
      sigma(k, j) = std::sqrt(std::max(0.0, g.dot(covariance * g)));
    }
  }
  return sigma;
}

estimation::PredictedQuantity predicted_quantity(const char* name, const char* unit, const Pairs& pairs) {
  estimation::PredictedQuantity q{name, unit, numerics::fit_measures(pairs.measured, pairs.model), kNaN};
  std::vector<double> residual(pairs.measured.size());
  for (std::size_t k = 0; k < residual.size(); ++k) residual[k] = pairs.measured[k] - pairs.model[k];
  if (residual.size() <= 10) return q;
  const std::vector<double> r =
      numerics::autocorrelation(residual, std::min(kLongestMemory, residual.size() - 1), pairs.span).value;
  q.lag1 = r[1];
  q.long_run = 1.0;
  // Beyond its first zero an autocorrelation is mostly its own error.
  for (std::size_t k = 1; k < r.size() && r[k] > 0.0; ++k) q.long_run += 2.0 * r[k];
  return q;
}

/// How well all stretches together are predicted.
std::vector<estimation::PredictedQuantity> quantities_of(std::span<const PredictedStretch> stretches) {
  Pairs yaw_rate, accel_y, lateral_velocity, yaw, path;
  int id = 0;
  for (const PredictedStretch& drive : stretches) {
    yaw_rate.add(drive.yaw_rate, drive.yaw_rate_predicted, id);
    accel_y.add(drive.accel_y, drive.accel_y_predicted, id);
    lateral_velocity.add(drive.lateral_velocity, drive.lateral_velocity_predicted, id);
    yaw.add(drive.yaw, drive.yaw_predicted, id);
    path.add(drive.x, drive.x_predicted, id);
    path.add(drive.y, drive.y_predicted, id);
    ++id;
  }
  std::vector<estimation::PredictedQuantity> quantities;
  const auto add = [&](const char* name, const char* unit, const Pairs& pairs) {
    if (!pairs.measured.empty()) quantities.push_back(predicted_quantity(name, unit, pairs));
  };
  add("yaw_rate", "rad/s", yaw_rate);
  add("accel_y", "m/s^2", accel_y);
  add("lateral_velocity", "m/s", lateral_velocity);
  add("yaw", "rad", yaw);
  if (!path.measured.empty())
    quantities.push_back({"path", "m", numerics::fit_measures(path.measured, path.model), kNaN});
  return quantities;
}

/// How well roll and roll rate are predicted, where the model has them among its outputs.
std::vector<estimation::PredictedQuantity> roll_quantities_of(const DriveParametricModel& model,
                                                              const estimation::OutputErrorEstimate& predicted) {
  std::vector<estimation::PredictedQuantity> quantities;
  const std::vector<estimation::RowMatrix> measured = model.measured();
  for (std::size_t j = 0; j < model.outputs().size(); ++j) {
    const auto& [name, unit] = model.outputs()[j];
    if (name != kDriveSignalNames[DriveSignal::kRoll] && name != kDriveSignalNames[DriveSignal::kRollRate]) continue;
    Pairs pairs;
    for (std::size_t s = 0; s < model.segments(); ++s) {
      const Eigen::VectorXd seen = measured[s].col(j), said = predicted.predicted[s].col(j);
      pairs.add({seen.begin(), seen.end()}, {said.begin(), said.end()}, static_cast<int>(s));
    }
    if (!pairs.measured.empty()) quantities.push_back(predicted_quantity(name.c_str(), unit.c_str(), pairs));
  }
  return quantities;
}

/// theta with the states at a segment's beginning behind it.
Eigen::VectorXd with_initial_state(const Eigen::VectorXd& theta, const estimation::OutputErrorEstimate& fitted,
                                   std::size_t segment) {
  std::vector<double> all(theta.data(), theta.data() + theta.size());
  for (const estimation::SegmentParameter& q : fitted.segment_parameters)
    if (q.segment == segment) all.push_back(q.value);
  return Eigen::Map<const Eigen::VectorXd>(all.data(), signed_index(all.size()));
}

}  // namespace

const estimation::PredictedQuantity* DriveValidation::find(std::string_view name) const {
  for (const estimation::PredictedQuantity& q : quantities) {
    if (q.name == name) return &q;
  }
  return nullptr;
}

DriveValidation predict_drive(const DriveSignals& signals, std::span<const TimeSpan> spans,
                              const VehicleParameters<double>& vehicle, const DriveModelOptions& options,
                              const DriveTheta& theta, Progress& progress) {
  DriveValidation out;
  DriveModelOptions fixed = options;
  fixed.free.fill(false);
  for (std::size_t i = 0; i < kDriveUnknowns; ++i) fixed.start[i] = theta.value(i);
  VehicleParameters<double> p = vehicle;
  p.C_f = theta.value(place_of(DriveUnknown::kCf));
  p.C_r = theta.value(place_of(DriveUnknown::kCr));
  p.I_z = theta.value(place_of(DriveUnknown::kIz));
  const DriveParametricModel model(signals, spans, p, fixed);
  if (model.segments() == 0) {
    out.text = "there is no segment to predict";
    return out;
  }
  estimation::OutputErrorOptions oe;
  oe.covariance = estimation::CovarianceKind::kWhite;
  const estimation::OutputErrorEstimate initial = estimation::output_error(model, model.measured(), oe, progress);
  if (initial.predicted.size() != model.segments()) {
    out.text = fmt::format("the prediction failed: {}", initial.message);
    return out;
  }
  for (std::size_t s = 0; s < model.segments() && !progress.interrupted(); ++s) {
    const Eigen::VectorXd full = with_initial_state(theta.value, initial, s);
    PredictedStretch drive = with_path(predicted_outputs(signals, model, s, initial.predicted[s]), signals, theta.value,
                                       full(kDriveUnknowns));
    const Eigen::MatrixXd sigma =
        theta.covariance.size() > 0 ? output_sigmas(model, s, full, theta.covariance) : Eigen::MatrixXd();
    for (Eigen::Index k = 0; k < sigma.rows(); ++k) {
      drive.yaw_rate_sigma.push_back(sigma(k, 0));
      if (!drive.accel_y.empty()) drive.accel_y_sigma.push_back(sigma(k, 1));
    }
    out.stretches.push_back(std::move(drive));
  }
  out.quantities = quantities_of(out.stretches);
  out.roll_quantities = roll_quantities_of(model, initial);
  const estimation::PredictedQuantity* r = out.find("yaw_rate");
  out.text = r == nullptr ? "nothing to compare"
                          : fmt::format("predicts {:.1f} % of the yaw rate's variance over {} segments",
                                        100.0 * std::max(0.0, r->fit.r2), out.stretches.size());
  return out;
}

}  // namespace veridyn::vehicle
