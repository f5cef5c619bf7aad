#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"

#include <cmath>

namespace veridyn::vehicle {
namespace {

using estimation::Parameter;

bool take_fitted(std::span<const Parameter> parameters, const char* name, double& to) {
  const Parameter* p = estimation::find_parameter(parameters, name);
  if (p == nullptr || !std::isfinite(p->value)) return false;
  to = p->value;
  return true;
}

bool take_excited(std::span<const Parameter> parameters, const char* name, double& to) {
  const Parameter* p = estimation::find_parameter(parameters, name);
  return p != nullptr && p->status != estimation::ParameterStatus::kNotExcited && take_fitted(parameters, name, to);
}

}  // namespace

VehicleParameters<double> estimated_parameters(VehicleParameters<double> vehicle,
                                               std::span<const Parameter> parameters) {
  const double wheelbase = vehicle.wheelbase();
  take_excited(parameters, "C_f", vehicle.C_f);
  take_excited(parameters, "C_r", vehicle.C_r);
  take_excited(parameters, "I_z", vehicle.I_z);
  if (take_excited(parameters, "a", vehicle.a)) vehicle.b = wheelbase - vehicle.a;
  take_fitted(parameters, "mu", vehicle.mu);
  return vehicle;
}

Vehicle estimated_vehicle(Vehicle vehicle, std::span<const Parameter> parameters, const DriveModelOptions& model) {
  const VehicleParameters<double> p = vehicle.parameters = estimated_parameters(vehicle.parameters, parameters);
  take_excited(parameters, "relaxation_length", vehicle.relaxation_length);
  const auto fitted = [&](const char* name) {
    double value = 0.0;
    return take_fitted(parameters, name, value);
  };
  const auto excited = [&](const char* name) {
    double value = 0.0;
    return take_excited(parameters, name, value);
  };
  double C = model.start[DriveUnknown::kShape], E = model.start[DriveUnknown::kCurvature];
  DriveTyre law = model.tyre;
  if (take_fitted(parameters, "C", C)) law = kDriveTyre<SimpleMagicFormulaTyre>;
  take_fitted(parameters, "E", E);
  if (fitted("mu")) {
    if (!has_unknown(law, DriveUnknown::kMu)) law = kDriveTyre<FialaTyre>;
  } else if (excited("C_f") || excited("C_r")) {
    law = kDriveTyre<LinearTyre>;
  } else {
    return vehicle;
  }
  std::visit(
      [&]<typename Tyre>(const TyreLaw<Tyre>&) {
        AxleTyres<Tyre> tyres = tyres_by_numbers<Tyre>(p);
        if constexpr (TyreWithShape<Tyre>) {
          tyres.front.C = tyres.rear.C = C;
          tyres.front.E = tyres.rear.E = E;
        }
        vehicle.tyres = tyres;
        vehicle.tyre_text = Tyre::kStudyName;
      },
      law);
  return vehicle;
}

}  // namespace veridyn::vehicle
