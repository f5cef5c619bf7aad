#include "veridyn/vehicle/identification/drive_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "veridyn/core/constants.hpp"
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

/// The rotation about the first point that lays one path best on another (their complex regression).
void lay_on(std::vector<double>& x, std::vector<double>& y, const std::vector<double>& x_to,
            const std::vector<double>& y_to) {
  std::size_t first = 0;
  while (first < x.size() && !(std::isfinite(x[first]) && std::isfinite(y[first]))) ++first;
  if (first == x.size()) return;
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
}

}  // namespace

const PredictedDriveQuantity* DriveValidation::find(std::string_view name) const {
  for (const PredictedDriveQuantity& q : quantities) {
    if (q.name == name) return &q;
  }
  return nullptr;
}

DriveValidation predict_drive(const DriveSignals& signals, std::span<const TimeSpan> spans,
                              const VehicleParameters<double>& vehicle, const DriveModelOptions& options,
                              const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance) {
  DriveValidation out;
  DriveModelOptions fixed = options;
  fixed.free.fill(false);
  for (std::size_t i = 0; i < kDriveUnknowns; ++i) fixed.start[i] = theta(static_cast<Eigen::Index>(i));
  VehicleParameters<double> p = vehicle;
  p.C_f = theta(static_cast<Eigen::Index>(DriveUnknown::kCf));
  p.C_r = theta(static_cast<Eigen::Index>(DriveUnknown::kCr));
  p.I_z = theta(static_cast<Eigen::Index>(DriveUnknown::kIz));
  const DriveParametricModel model(signals, spans, p, fixed);
  if (model.segments() == 0) {
    out.text = "there is no segment to predict";
    return out;
  }
  const std::vector<estimation::RowMatrix> measured = model.measured();
  estimation::OutputErrorOptions oe;
  oe.covariance = estimation::CovarianceKind::kWhite;
  const estimation::OutputErrorEstimate initial = estimation::output_error(model, measured, oe);
  if (initial.predicted.size() != model.segments()) {
    out.text = fmt::format("the prediction failed: {}", initial.message);
    return out;
  }
  const bool accel = signals[DriveSignal::kAccelY].available();
  const bool lateral = signals[DriveSignal::kLateralVelocity].available();
  const bool bands = covariance.size() > 0;
  std::vector<Eigen::Index> active(kDriveUnknowns);
  std::iota(active.begin(), active.end(), Eigen::Index{0});
  const double yaw_bias = theta(static_cast<Eigen::Index>(DriveUnknown::kYawRateBias));
  const double step = signals.grid.step;
  Pairs yaw_rate, accel_y, lateral_velocity, yaw, path;
  for (std::size_t s = 0; s < model.segments(); ++s) {
    PredictedStretch drive;
    drive.span = model.segment_span(s);
    const std::size_t begin = model.first_sample(s);
    const auto n = static_cast<std::size_t>(model.samples(s));
    const estimation::RowMatrix& y = initial.predicted[s];
    Eigen::VectorXd full(static_cast<Eigen::Index>(kDriveUnknowns + 2));
    full.head(static_cast<Eigen::Index>(kDriveUnknowns)) = theta;
    for (const estimation::SegmentParameter& q : initial.segment_parameters) {
      if (q.segment == s)
        full(static_cast<Eigen::Index>(kDriveUnknowns) + (q.name == "lateral_velocity" ? 0 : 1)) = q.value;
    }
    // The lateral velocity is no output where it is not measured: it is integrated from the two that are.
    double v = full(static_cast<Eigen::Index>(kDriveUnknowns));
    const auto series = [&](std::vector<double>& to, DriveSignal which) {
      const std::vector<double>& from = signals[which].value;
      to.assign(from.begin() + static_cast<std::ptrdiff_t>(begin),
                from.begin() + static_cast<std::ptrdiff_t>(begin + n));
    };
    series(drive.steer, DriveSignal::kSteer);
    series(drive.speed, DriveSignal::kSpeed);
    series(drive.yaw_rate, DriveSignal::kYawRate);
    if (accel) series(drive.accel_y, DriveSignal::kAccelY);
    if (lateral) series(drive.lateral_velocity, DriveSignal::kLateralVelocity);
    for (std::size_t k = 0; k < n; ++k) {
      drive.time.push_back(signals.grid.at(begin + k));
      const auto row = static_cast<Eigen::Index>(k);
      drive.yaw_rate_predicted.push_back(y(row, 0));
      if (accel) drive.accel_y_predicted.push_back(y(row, 1));
      if (lateral) drive.lateral_velocity_predicted.push_back(y(row, accel ? 2 : 1));
    }
    // Path and heading: trapezoids of what the model says, and of the gyro less its bias.
    double psi = 0.0, psi_measured = 0.0, px = 0.0, py = 0.0;
    const auto [ax, ay, az] = signals.accel_position;
    static_cast<void>(az);
    const double accel_bias = theta(static_cast<Eigen::Index>(DriveUnknown::kAccelYBias));
    const double accel_scale = 1.0 + theta(static_cast<Eigen::Index>(DriveUnknown::kAccelYScale));
    for (std::size_t k = 0; k < n; ++k) {
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
              (0.5 * (drive.accel_y_predicted[k] + drive.accel_y_predicted[k - 1]) - accel_bias) / accel_scale -
              ax * dr + ay * r * r;
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
    if (signals[DriveSignal::kX].available()) {
      series(drive.x, DriveSignal::kX);
      series(drive.y, DriveSignal::kY);
      lay_on(drive.x, drive.y, drive.x_predicted, drive.y_predicted);
    }
    if (bands) {
      estimation::ModelResponse response;
      if (model.respond(s, full, active, response)) {
        const auto p_out = static_cast<Eigen::Index>(model.outputs().size());
        for (std::size_t k = 0; k < n; ++k) {
          const auto row = static_cast<Eigen::Index>(k) * p_out;
          const auto sd = [&](Eigen::Index j) {
            const Eigen::VectorXd g = response.sensitivity.row(row + j).transpose();
            return std::sqrt(std::max(0.0, g.dot(covariance * g)));
          };
          drive.yaw_rate_sigma.push_back(sd(0));
          if (accel) drive.accel_y_sigma.push_back(sd(1));
        }
      }
    }
    const int id = static_cast<int>(s);
    yaw_rate.add(drive.yaw_rate, drive.yaw_rate_predicted, id);
    accel_y.add(drive.accel_y, drive.accel_y_predicted, id);
    lateral_velocity.add(drive.lateral_velocity, drive.lateral_velocity_predicted, id);
    yaw.add(drive.yaw, drive.yaw_predicted, id);
    path.add(drive.x, drive.x_predicted, id);
    path.add(drive.y, drive.y_predicted, id);
    out.stretches.push_back(std::move(drive));
  }
  const auto judge = [&](const char* name, const char* unit, const Pairs& pairs) {
    if (pairs.measured.empty()) return;
    PredictedDriveQuantity q{name, unit, numerics::fit_measures(pairs.measured, pairs.model), kNaN};
    std::vector<double> residual(pairs.measured.size());
    for (std::size_t k = 0; k < residual.size(); ++k) residual[k] = pairs.measured[k] - pairs.model[k];
    if (residual.size() > 10) q.lag1 = numerics::autocorrelation(residual, 1, pairs.span).value[1];
    out.quantities.push_back(std::move(q));
  };
  judge("yaw_rate", "rad/s", yaw_rate);
  judge("accel_y", "m/s^2", accel_y);
  judge("lateral_velocity", "m/s", lateral_velocity);
  judge("yaw", "rad", yaw);
  if (path.measured.size() > 0) {
    Pairs once = path;
    once.span.clear();
    PredictedDriveQuantity q{"path", "m", numerics::fit_measures(once.measured, once.model), kNaN};
    out.quantities.push_back(std::move(q));
  }
  const PredictedDriveQuantity* r = out.find("yaw_rate");
  out.text = r == nullptr ? "nothing to compare"
                          : fmt::format("predicts {:.1f} % of the yaw rate's variance over {} segments",
                                        100.0 * std::max(0.0, r->fit.r2), out.stretches.size());
  return out;
}

}  // namespace veridyn::vehicle
