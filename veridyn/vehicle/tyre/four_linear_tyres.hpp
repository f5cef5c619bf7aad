#pragma once

#include "veridyn/vehicle/tyre/four_tyres.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {

/// Four linear tyres at once: the forces of `LinearTyre` one by one, to the last bit. Does not throw or allocate.
template <>
class FourTyres<LinearTyre<double>> {
 public:
  explicit FourTyres(const PerWheel<LinearTyre<double>>& tyres) : tyres_(tyres) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      slip_stiffness_[i] = tyres[i].slip_stiffness;
      stiffness_[i] = tyres[i].stiffness;
      limited_ = limited_ || tyres[i].mu < kInfinity;
    }
  }

  /// See the general one.
  void forces(const WheelArray<double>& load, const WheelArray<double>& slip_ratio,
              const WheelArray<double>& slip_angle, const double& camber, WheelArray<double>& Fx,
              WheelArray<double>& Fy) const {
    if (limited_) return within_friction(load, slip_ratio, slip_angle, camber, Fx, Fy);
    Fx = slip_stiffness_ * slip_ratio;
    Fy = stiffness_ * slip_angle;
  }
  [[nodiscard]] const PerWheel<LinearTyre<double>>& tyres() const { return tyres_; }

 private:
  [[gnu::noinline]] void within_friction(const WheelArray<double>& load, const WheelArray<double>& slip_ratio,
                                         const WheelArray<double>& slip_angle, double camber, WheelArray<double>& Fx,
                                         WheelArray<double>& Fy) const {
    for (std::size_t i = 0; i < kWheels; ++i) {
      const TyreForces<double> force = tyres_[i].forces(load[i], slip_ratio[i], slip_angle[i], camber);
      Fx[i] = force.Fx;
      Fy[i] = force.Fy;
    }
  }

  PerWheel<LinearTyre<double>> tyres_;
  WheelArray<double> slip_stiffness_, stiffness_;
  bool limited_ = false;  ///< whether any has a friction limit
};

}  // namespace veridyn::vehicle
