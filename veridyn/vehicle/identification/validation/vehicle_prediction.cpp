#include "veridyn/vehicle/identification/validation/vehicle_prediction.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

constexpr auto index_of(DriveUnknown u) { return static_cast<std::size_t>(u); }

}  // namespace

Eigen::VectorXd fit_drive_biases(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                 const VehicleParameters<double>& vehicle, const DriveModelOptions& options,
                                 Progress& progress) {
  DriveModelOptions biases_only = options;
  biases_only.free.fill(false);
  for (const DriveUnknown u : {DriveUnknown::kSteerBias, DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias})
    biases_only.free[u] = true;
  biases_only = with_course(std::move(biases_only), signals.lateral_by_course);
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA})
    biases_only.start[u] = kNaN;
  const DriveParametricModel model(signals, spans, vehicle, biases_only);
  const estimation::OutputErrorEstimate biases = estimation::output_error(model, model.measured(), {}, progress);
  if (biases.usable()) return biases.theta;
  Eigen::VectorXd theta(kDriveUnknowns);
  for (std::size_t i = 0; i < kDriveUnknowns; ++i) theta(i) = model.parameters()[i].start;
  return theta;
}

DriveTheta theta_of(const VehicleProblem& problem, const VehicleEstimate& estimate,
                    const estimation::OutputErrorEstimate* output_error, Progress& progress) {
  if (estimate.method == VehicleMethod::kOutputError && output_error != nullptr) {
    return {output_error->theta,
            output_error->total_covariance().unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; })};
  }
  VehicleParameters<double> p = problem.start;
  p.C_f = estimate.find("C_f")->value;
  p.C_r = estimate.find("C_r")->value;
  p.I_z = estimate.find("I_z")->value;
  DriveTheta theta;
  theta.covariance = Eigen::MatrixXd::Zero(kDriveUnknowns, kDriveUnknowns);
  const Eigen::MatrixXd axles = estimate.covariance.topLeftCorner(3, 3);
  if (axles.allFinite()) theta.covariance.topLeftCorner(3, 3) = axles;
  theta.value = fit_drive_biases(problem.signals, problem.segments.identification, p, problem.options.model, progress);
  return theta;
}

DriveValidation with_noisier_inputs(const VehicleProblem& problem, const DriveTheta& theta, const DriveValidation& fit,
                                    Progress& progress) {
  DriveSignals noisier = problem.signals;
  for (const DriveSignal which : {DriveSignal::kSteer, DriveSignal::kSpeed}) {
    GridSignal& signal = noisier[which];
    numerics::RandomStream noise(1, kDriveSignalNames[which]);
    for (double& v : signal.value) v += signal.sigma * noise.normal();
  }
  DriveValidation other = predict_drive(noisier, problem.segments.identification, problem.start, problem.options.model,
                                        {theta.value}, progress);
  const auto compare = [&](const char* name, std::vector<double> PredictedStretch::*series) {
    std::vector<double> x, y;
    for (std::size_t s = 0; s < std::min(other.stretches.size(), fit.stretches.size()); ++s) {
      const std::vector<double>&a = fit.stretches[s].*series, &b = other.stretches[s].*series;
      if (a.size() != b.size()) continue;
      x.insert(x.end(), a.begin(), a.end());
      y.insert(y.end(), b.begin(), b.end());
    }
    for (estimation::PredictedQuantity& q : other.quantities) {
      if (q.name == name) q.fit = numerics::fit_measures(x, y);
    }
  };
  compare("yaw_rate", &PredictedStretch::yaw_rate_predicted);
  compare("accel_y", &PredictedStretch::accel_y_predicted);
  compare("lateral_velocity", &PredictedStretch::lateral_velocity_predicted);
  return other;
}

}  // namespace veridyn::vehicle
