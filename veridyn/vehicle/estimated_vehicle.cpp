#include "veridyn/vehicle/estimated_vehicle.hpp"

#include <cmath>

namespace veridyn::vehicle {
namespace {

/// Driving stiffness over cornering stiffness of one tyre where a study does not give it, as `read_vehicle` assumes.
constexpr double kSlipStiffness = 1.3;

template <typename Tyre>
AxleTyres<Tyre> tyres_of(const VehicleParameters<double>& p) {
  const auto axle = [&](double C) {
    Tyre tyre;
    tyre.stiffness = C;
    tyre.slip_stiffness = kSlipStiffness * C;
    tyre.mu = p.mu;
    return tyre;
  };
  return {axle(p.C_f), axle(p.C_r)};
}

}  // namespace

Vehicle estimated_vehicle(Vehicle vehicle, std::span<const estimation::Parameter> parameters) {
  const auto take = [&](const char* name, double& to) {
    for (const estimation::Parameter& p : parameters) {
      if (p.name != name || p.status == estimation::ParameterStatus::kNotExcited || !std::isfinite(p.value)) continue;
      to = p.value;
      return true;
    }
    return false;
  };
  VehicleParameters<double>& p = vehicle.parameters;
  const double wheelbase = p.wheelbase();
  const bool stiff = take("C_f", p.C_f) | take("C_r", p.C_r);
  take("I_z", p.I_z);
  if (take("a", p.a)) p.b = wheelbase - p.a;
  take("relaxation_length", vehicle.relaxation_length);
  double C = 0.0, E = 0.0;
  const bool limited = take("mu", p.mu);
  if (limited && take("C", C)) {
    take("E", E);
    const PerWheel<double> load = static_loads(p, kGravity);
    auto tyres = tyres_of<SimpleMagicFormulaTyre<double>>(p);
    tyres.front.nominal_load = load[kFrontLeft];
    tyres.rear.nominal_load = load[kRearLeft];
    tyres.front.C = tyres.rear.C = C;
    tyres.front.E = tyres.rear.E = E;
    vehicle.tyres = tyres;
    vehicle.tyre_text = "magic formula";
  } else if (limited) {
    vehicle.tyres = tyres_of<FialaTyre<double>>(p);
    vehicle.tyre_text = "fiala";
  } else if (stiff) {
    vehicle.tyres = tyres_of<LinearTyre<double>>(p);
    vehicle.tyre_text = "linear";
  }
  return vehicle;
}

}  // namespace veridyn::vehicle
