#include "veridyn/vehicle/tyre/four_simple_magic_formula.hpp"

#include <cstring>

#include "veridyn/vehicle/tyre/lanes.hpp"

namespace veridyn::vehicle {

FourTyres<SimpleMagicFormulaTyre<double>>::FourTyres(const PerWheel<SimpleMagicFormulaTyre<double>>& tyres)
    : tyres_(tyres) {
  for (std::size_t i = 0; i < kWheels; ++i) {
    const SimpleMagicFormulaTyre<double>& t = tyres[i];
    const double q = t.stiffness_saturation * t.stiffness_saturation;
    c_.slip_stiffness[i] = t.slip_stiffness * (1.0 + q), c_.stiffness[i] = t.stiffness * (1.0 + q);
    c_.saturation[i] = q;
    c_.per_nominal[i] = 1.0 / t.nominal_load;
    c_.mu[i] = t.mu, c_.mu_load[i] = t.mu_load, c_.one_less_p[i] = 1.0 - t.mu_load;
    c_.C[i] = t.C, c_.E[i] = t.E;
    bends_ = bends_ || t.E != 0.0;
  }
}

VERIDYN_WIDE void FourTyres<SimpleMagicFormulaTyre<double>>::forces(const WheelArray<double>& load_of,
                                                                    const WheelArray<double>& ratio_of,
                                                                    const WheelArray<double>& angle_of,
                                                                    const double& /*camber*/, WheelArray<double>& Fx,
                                                                    WheelArray<double>& Fy) const {
  using namespace in_lanes;
  const auto four = [](const Lanes& lanes) __attribute__((always_inline)) { return from(lanes.data()); };
  const Coefficients& k = c_;
  // What the load decides, while the slips are still on their way.
  const Four load = from_halves(load_of.data()), x = load * four(k.per_nominal);
  const Four gain = x / (1.0 + four(k.saturation) * x * x);
  const Four D = four(k.mu) * load / (four(k.one_less_p) + four(k.mu_load) * x);
  const Four per_CD = 1.0 / (four(k.C) * D);

  const Four linear_x = gain * four(k.slip_stiffness) * from_halves(ratio_of.data());
  const Four linear_y = gain * four(k.stiffness) * from_halves(angle_of.data());
  const Four squared = linear_x * linear_x + linear_y * linear_y, linear = root(squared);
  Four y = linear * per_CD;
  if (bends_) {
    const Four E = four(k.E);
    y = where(E != 0.0, y - E * (y - arc_tangent(y)), y);
  }
  const Four curve = D / linear * sine(four(k.C) * arc_tangent(y));
  const Four share = where(squared > 0.0, curve, all(1.0));
  const FourBits on_ground = load > 0.0;
  const Four along = where(on_ground, share * linear_x, Four{}), across = where(on_ground, share * linear_y, Four{});
  std::memcpy(Fx.data(), &along, sizeof along);
  std::memcpy(Fy.data(), &across, sizeof across);
}

}  // namespace veridyn::vehicle
