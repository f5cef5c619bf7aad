#pragma once

#include <array>

#include "veridyn/vehicle/tyre/four_tyres.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

namespace veridyn::vehicle {

/// Four simple Magic Formula tyres in the lanes of vectors: the equations of `SimpleMagicFormulaTyre`, without
/// branches. Forces are those of the tyres one by one to a few units in the last place of friction times load; equal
/// lanes give equal bits, and all processors the same ones. Does not throw or allocate.
template <>
class FourTyres<SimpleMagicFormulaTyre<double>> {
 public:
  explicit FourTyres(const PerWheel<SimpleMagicFormulaTyre<double>>& tyres);

  /// See the general one.
  void forces(const WheelArray<double>& load, const WheelArray<double>& slip_ratio,
              const WheelArray<double>& slip_angle, const double& camber, WheelArray<double>& Fx,
              WheelArray<double>& Fy) const;
  [[nodiscard]] const PerWheel<SimpleMagicFormulaTyre<double>>& tyres() const { return tyres_; }

 private:
  PerWheel<SimpleMagicFormulaTyre<double>> tyres_;
  bool bends_ = false;  ///< whether any has a curvature E
  /// A number of each tyre.
  using Lanes = std::array<double, 4>;
  struct alignas(32) Coefficients {
    Lanes slip_stiffness, stiffness;  ///< times 1 + q^2
    Lanes saturation;                 ///< q^2
    Lanes per_nominal;                ///< [1/N]
    Lanes mu, mu_load, one_less_p;    ///< friction; p; 1 - p
    Lanes C, E;
  } c_{};
};

}  // namespace veridyn::vehicle
