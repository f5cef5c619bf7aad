#include "veridyn/vehicle/tracking/known_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/vehicle/identification/fit/estimated_drive_model.hpp"
#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"

namespace veridyn::vehicle {
namespace {

constexpr auto place(DriveUnknown u) { return signed_index(static_cast<std::size_t>(u)); }

/// All that is estimated beside the stiffnesses and is no bias of a sensor.
bool is_body(DriveUnknown u) {
  return u == DriveUnknown::kIz || (u >= DriveUnknown::kMu && u <= DriveUnknown::kRollDamping) ||
         u == DriveUnknown::kA || u == DriveUnknown::kAccelYScale || u == DriveUnknown::kSteerScale;
}

/// What the covariance of the stiffnesses owes to the body's, S_cb S_bb^-1 S_bc: it would not be there if the body were
/// known exactly.
Eigen::Matrix2d owed_to_body(const Eigen::MatrixXd& S) {
  std::vector<Eigen::Index> body;
  for (const DriveUnknown u : kAllDriveUnknowns)
    if (is_body(u) && S(place(u), place(u)) > 0.0) body.push_back(place(u));
  if (body.empty()) return Eigen::Matrix2d::Zero();
  const std::vector<Eigen::Index> axles{place(DriveUnknown::kCf), place(DriveUnknown::kCr)};
  // In units of the body's own standard deviations, which lie orders of magnitude apart.
  const Eigen::VectorXd scale = S.diagonal()(body).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd across = scale.asDiagonal() * Eigen::MatrixXd(S(body, axles));
  const Eigen::MatrixXd inner = scale.asDiagonal() * Eigen::MatrixXd(S(body, body)) * scale.asDiagonal();
  return across.transpose() * numerics::solve_symmetric(inner, across);
}

std::array<double, 3> body_sigma(const estimation::Estimate& estimate, const EstimatedDriveModel& model) {
  const VehicleParameters<double>& p = model.vehicle;
  Eigen::Matrix2d owed = owed_to_body(model.covariance);
  // Structures that are left open have other bodies.
  const auto doubt = [&](const char* name) {
    const auto found = estimate.fit.find(fmt::format("{}.structure_doubt", name));
    return found == estimate.fit.end() ? 0.0 : found->second;
  };
  owed(0, 0) += std::pow(doubt("C_f"), 2);
  owed(1, 1) += std::pow(doubt("C_r"), 2);
  const double gain = 0.5 * p.mass / p.wheelbase();
  const Eigen::Vector2d slope(-gain * p.b / (p.C_f * p.C_f), gain * p.a / (p.C_r * p.C_r));
  return {std::sqrt(std::max(0.0, owed(0, 0))) / p.C_f, std::sqrt(std::max(0.0, owed(1, 1))) / p.C_r,
          std::sqrt(std::max(0.0, slope.dot(owed * slope)))};
}

/// How the tyres of an estimate saturate where the body leans.
AnyRollingBicycle tyres_of(const estimation::Estimate& estimate, const EstimatedDriveModel& model,
                           const BodyRoll<double>& roll) {
  const auto bicycle = [&](const auto& tyres) -> AnyRollingBicycle {
    using Tyre = std::decay_t<decltype(tyres.front)>;
    RollingBicycle<double, Tyre> out{.bicycle = {.parameters = model.vehicle,
                                                 .front = tyres.front,
                                                 .rear = tyres.rear,
                                                 .gravity = model.options.gravity},
                                     .roll = roll};
    using Effect = LoadTransfer<double>::Effect;
    const PerDriveUnknown<double>& value = model.options.start;
    const auto has = [&](DriveUnknown u) { return estimate.find(std::string(kDriveUnknownNames[u])) != nullptr; };
    if (has(DriveUnknown::kLoadTransfer))
      out.load_transfer = {.effect = Effect::kLoads, .share = value[DriveUnknown::kLoadTransfer]};
    if (has(DriveUnknown::kLoadTransferLoss))
      out.load_transfer = {.effect = Effect::kLoss, .loss = value[DriveUnknown::kLoadTransferLoss]};
    if (has(DriveUnknown::kLoadTransferBalance)) out.load_transfer.balance = value[DriveUnknown::kLoadTransferBalance];
    return out;
  };
  Vehicle start;
  start.parameters = model.vehicle;
  const Vehicle vehicle = estimated_vehicle(std::move(start), estimate.parameters, model.options);
  return std::visit(
      [&]<typename Tyre>(const AxleTyres<Tyre>& tyres) {
        if constexpr (TyreByNumbers<Tyre> && !std::is_same_v<Tyre, LinearTyre<double>>)
          return bicycle(tyres);
        else
          return bicycle(tyres_by_numbers<LinearTyre<double>>(model.vehicle));
      },
      vehicle.tyres);
}

std::string described(const KnownBody& body) {
  const std::string lean = body.roll.gradient > 0.0
                               ? fmt::format("a body that leans {:.2g} deg per g at {:.2g} Hz",
                                             deg_per_g(body.roll.gradient), body.roll.frequency / (2.0 * kPi))
                               : std::string("a body that does not lean");
  const std::string lag = body.relaxation_length > 0.0
                              ? fmt::format("tyres that follow after {:.2f} m", body.relaxation_length)
                              : std::string("tyres that push at once");
  return fmt::format("I_z {:.4g} kg m^2, {}, {}{}{}", body.I_z, lean, lag, is_linear(body.tyres) ? "" : " and saturate",
                     body.accepted ? "" : "; what it comes from was not accepted");
}

}  // namespace

KnownBody known_body(const estimation::Estimate& estimate, const VehicleParameters<double>& vehicle,
                     const DriveModelOptions& options) {
  const EstimatedDriveModel model = estimated_drive_model(estimate, vehicle, options);
  const PerDriveUnknown<double>& value = model.options.start;
  const auto has = [&](DriveUnknown u) {
    const estimation::Parameter* p = estimate.find(std::string(kDriveUnknownNames[u]));
    return p != nullptr && std::isfinite(p->value);
  };
  KnownBody body{.source = BodySource::kEstimate, .I_z = model.vehicle.I_z};
  const BodyRoll<double> roll{.gradient = value[DriveUnknown::kRollGradient],
                              .frequency = value[DriveUnknown::kRollFrequency],
                              .damping = value[DriveUnknown::kRollDamping],
                              .arm = value[DriveUnknown::kRollArm]};
  const bool moves = roll.gradient > 0.0 && roll.frequency > 0.0 && roll.damping > 0.0 && std::isfinite(roll.arm);
  if (has(DriveUnknown::kRollGradient) && moves) body.roll = roll;
  if (has(DriveUnknown::kRelaxationLength)) body.relaxation_length = value[DriveUnknown::kRelaxationLength];
  if (has(DriveUnknown::kAccelYScale)) body.accel_scale = value[DriveUnknown::kAccelYScale];
  if (has(DriveUnknown::kSteerScale)) body.steer_scale = value[DriveUnknown::kSteerScale];
  if (has(DriveUnknown::kA)) body.a = value[DriveUnknown::kA];
  body.accepted = std::ranges::none_of(estimate.parameters, [](const estimation::Parameter& p) {
    return p.status == estimation::ParameterStatus::kRejected || p.status == estimation::ParameterStatus::kImplausible;
  });
  body.tyres = tyres_of(estimate, model, body.roll);
  body.sigma = body_sigma(estimate, model);
  body.text = fmt::format("from the estimate: {}", described(body));
  return body;
}

KnownBody learned_body(const DriveSignals& signals, const DriveSegmentOptions& segment_options,
                       const VehicleParameters<double>& vehicle, const DriveSignalOptions& signal_options,
                       const VehicleIdentifyOptions& options, Progress& progress) {
  KnownBody none{.I_z = vehicle.I_z};
  const auto without = [&](std::string_view why) {
    none.text = fmt::format("{}: taken for a car that does not lean, with the I_z that the study gives", why);
    return none;
  };
  DriveSegments segments;
  try {
    segments = find_drive_segments(signals, segment_options);
  } catch (const InputError& error) {
    return without(fmt::format("the beginning of the drive shows nothing of the body ({})", error.what()));
  }
  if (segments.identification.empty()) return without("no stretch of the beginning is lively enough to show the body");
  const VehicleIdentification found =
      identify_parameters({signals, segments, vehicle, signal_options, options}, progress);
  const VehicleEstimate* best = found.best();
  if (best == nullptr || !best->usable) return without("the beginning of the drive does not show the body");
  KnownBody body = known_body(make_vehicle_estimate(found, ""), vehicle, options.model);
  body.source = BodySource::kLearned;
  body.text = fmt::format("learned from the first {:.0f} s: {}",
                          signals.grid.at(signals.size() - 1) - signals.grid.at(0), described(body));
  return body;
}

}  // namespace veridyn::vehicle
