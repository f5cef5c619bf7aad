#include "veridyn/vehicle/identification/estimated_vehicle.hpp"

#include <cmath>

namespace veridyn::vehicle {
Vehicle estimated_vehicle(Vehicle vehicle, std::span<const estimation::Parameter> parameters,
                          const DriveModelOptions& model) {
  const auto take_fitted = [&](const char* name, double& to) {
    const estimation::Parameter* p = estimation::find_parameter(parameters, name);
    if (p == nullptr || !std::isfinite(p->value)) return false;
    to = p->value;
    return true;
  };
  const auto take = [&](const char* name, double& to) {
    const estimation::Parameter* p = estimation::find_parameter(parameters, name);
    return p != nullptr && p->status != estimation::ParameterStatus::kNotExcited && take_fitted(name, to);
  };
  VehicleParameters<double>& p = vehicle.parameters;
  const double wheelbase = p.wheelbase();
  const bool stiff_front = take("C_f", p.C_f), stiff_rear = take("C_r", p.C_r);
  take("I_z", p.I_z);
  if (take("a", p.a)) p.b = wheelbase - p.a;
  take("relaxation_length", vehicle.relaxation_length);
  double C = model.start[DriveUnknown::kShape], E = model.start[DriveUnknown::kCurvature];
  const bool limited = take_fitted("mu", p.mu);
  const bool has_shape = take_fitted("C", C) || model.tyre == DriveTyre::kMagicFormula;
  if (limited && has_shape) {
    take_fitted("E", E);
    auto tyres = tyres_by_numbers<SimpleMagicFormulaTyre<double>>(p);
    tyres.front.C = tyres.rear.C = C;
    tyres.front.E = tyres.rear.E = E;
    vehicle.tyres = tyres;
    vehicle.tyre_text = "magic formula";
  } else if (limited) {
    vehicle.tyres = tyres_by_numbers<FialaTyre<double>>(p);
    vehicle.tyre_text = "fiala";
  } else if (stiff_front || stiff_rear) {
    vehicle.tyres = tyres_by_numbers<LinearTyre<double>>(p);
    vehicle.tyre_text = "linear";
  }
  return vehicle;
}

}  // namespace veridyn::vehicle
