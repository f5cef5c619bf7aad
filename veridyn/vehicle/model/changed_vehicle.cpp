#include "veridyn/vehicle/model/changed_vehicle.hpp"

#include <cmath>
#include <variant>

namespace veridyn::vehicle {
namespace {

/// A tyre with shares of its cornering stiffness and friction.
template <typename Tyre>
Tyre tyre_with(Tyre tyre, double stiffness, double friction) {
  tyre.stiffness *= stiffness;
  tyre.mu *= friction;
  return tyre;
}

MagicFormulaTyre<double> tyre_with(MagicFormulaTyre<double> tyre, double stiffness, double friction) {
  auto& c = tyre.coefficients;
  c.LKY *= stiffness;
  c.LMUX *= friction;
  c.LMUY *= friction;
  return tyre;
}

}  // namespace

Vehicle with_parameters(const Vehicle& vehicle, const VehicleParameters<double>& to) {
  const VehicleParameters<double>& from = vehicle.parameters;
  const double friction = std::isfinite(from.mu) ? to.mu / from.mu : 1.0;
  Vehicle changed = vehicle;
  changed.parameters = to;
  // Springs by table follow their rate at rest.
  changed.suspension_f.spring = vehicle.suspension_f.spring.scaled(1.0, to.K_sf / from.K_sf);
  changed.suspension_r.spring = vehicle.suspension_r.spring.scaled(1.0, to.K_sr / from.K_sr);
  changed.tyres = std::visit(
      [&]<typename Tyre>(const AxleTyres<Tyre>& t) -> VehicleTyres {
        return AxleTyres<Tyre>{tyre_with(t.front, to.C_f / from.C_f, friction),
                               tyre_with(t.rear, to.C_r / from.C_r, friction)};
      },
      vehicle.tyres);
  return changed;
}

}  // namespace veridyn::vehicle
