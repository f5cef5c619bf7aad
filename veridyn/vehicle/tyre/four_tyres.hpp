#pragma once

#include "veridyn/vehicle/tyre/tyre.hpp"
#include "veridyn/vehicle/tyre/wheel_arrays.hpp"

namespace veridyn::vehicle {

/// The four tyres of a vehicle together, so that a kind of tyre may calculate all of them at once: a specialisation
/// with the same functions. Here one after the other.
template <typename Tyre>
class FourTyres {
 public:
  explicit FourTyres(const PerWheel<Tyre>& tyres) : tyres_(tyres) {}

  /// The tyres' `forces`, wheel by wheel. @param camber of all wheels [rad]
  template <typename Scalar>
  void forces(const WheelArray<Scalar>& load, const WheelArray<Scalar>& slip_ratio,
              const WheelArray<Scalar>& slip_angle, const Scalar& camber, WheelArray<Scalar>& Fx,
              WheelArray<Scalar>& Fy) const {
    const auto of = [&](std::size_t wheel) {
      return tyres_[wheel].forces(load[wheel], slip_ratio[wheel], slip_angle[wheel], camber);
    };
    const TyreForces<Scalar> fl = of(0), fr = of(1), rl = of(2), rr = of(3);
    Fx << fl.Fx, fr.Fx, rl.Fx, rr.Fx;
    Fy << fl.Fy, fr.Fy, rl.Fy, rr.Fy;
  }
  [[nodiscard]] const PerWheel<Tyre>& tyres() const { return tyres_; }

 private:
  PerWheel<Tyre> tyres_;
};

}  // namespace veridyn::vehicle
