#include "veridyn/vehicle/identification/fit/estimated_drive_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace veridyn::vehicle {
namespace {

/// Of all DriveUnknowns, as far as the estimate has it.
Eigen::MatrixXd drive_covariance(const estimation::Estimate& estimate) {
  const auto n = static_cast<Eigen::Index>(kDriveUnknowns);
  const auto at = [&](std::size_t k) {
    return std::find(kDriveUnknownNames.begin(), kDriveUnknownNames.end(), estimate.parameters[k].name) -
           kDriveUnknownNames.begin();
  };
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    for (std::size_t j = 0; j < estimate.parameters.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      if (at(i) >= n || at(j) >= n || row >= estimate.covariance.rows() || column >= estimate.covariance.cols())
        continue;
      const double c = estimate.covariance(row, column);
      if (std::isfinite(c)) covariance(at(i), at(j)) = c;
    }
  }
  return covariance;
}

}  // namespace

EstimatedDriveModel estimated_drive_model(const estimation::Estimate& estimate,
                                          const VehicleParameters<double>& vehicle, const DriveModelOptions& options) {
  EstimatedDriveModel given{vehicle, options, drive_covariance(estimate)};
  const auto take = [&](std::string_view name, double& to) {
    const estimation::Parameter* e = estimate.find(std::string(name));
    const bool known = e != nullptr && std::isfinite(e->value);
    if (known) to = e->value;
    return known;
  };
  VehicleParameters<double>& p = given.vehicle;
  for (const auto& [name, to] : {std::pair{"C_f", &p.C_f}, std::pair{"C_r", &p.C_r}, std::pair{"I_z", &p.I_z}}) {
    if (!take(name, *to)) given.missing.emplace_back(name);
  }
  const double L = p.wheelbase();
  take("a", p.a);
  p.b = L - p.a;
  constexpr std::array kOfVehicle{DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA};
  for (const DriveUnknown u : kAllDriveUnknowns) {
    if (is_bias(u) || std::ranges::find(kOfVehicle, u) != kOfVehicle.end()) continue;
    take(kDriveUnknownNames[u], given.options.start[u]);
  }
  given.options.effects[DriveEffect::kDownforce] = estimate.find("downforce_f") != nullptr;
  given.options.effects[DriveEffect::kPedals] = estimate.find("load_sensitivity") != nullptr;
  // Its angles are each segment's own.
  given.options.effects[DriveEffect::kBank] =
      estimate.structure.find(kDriveEffectNames[DriveEffect::kBank]) != std::string::npos;
  if (estimate.find("roll_gradient") != nullptr) given.options.structure = DriveStructure::kRoll;
  if (estimate.find("relaxation_length") != nullptr) given.options.structure = DriveStructure::kRelaxation;
  if (estimate.find("mu") != nullptr) {
    const bool has_shape = estimate.find("C") != nullptr;
    if (estimate.find("roll_gradient") != nullptr)
      given.options.structure = has_shape ? DriveStructure::kMagicFormula : DriveStructure::kSaturation;
    if (estimate.find("relaxation_length") == nullptr) given.options.start[DriveUnknown::kRelaxationLength] = 0.0;
    given.options.tyre = has_shape ? kDriveTyre<SimpleMagicFormulaTyre> : kDriveTyre<FialaTyre>;
  }
  return given;
}

}  // namespace veridyn::vehicle
