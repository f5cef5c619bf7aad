#pragma once

#include <array>

#include "veridyn/vehicle/tyre/four_tyres.hpp"
#include "veridyn/vehicle/tyre/magic_formula.hpp"

namespace veridyn::vehicle {

/// Four Magic Formula tyres in the lanes of vectors: the equations of `MagicFormulaTyre`, without branches. Forces are
/// those of the tyres one by one to a few units in the last place of friction times load; equal lanes give equal bits,
/// and all processors the same ones. Does not throw or allocate.
template <>
class FourTyres<MagicFormulaTyre<double>> {
 public:
  explicit FourTyres(const PerWheel<MagicFormulaTyre<double>>& tyres);

  /// See the general one.
  void forces(const WheelArray<double>& load, const WheelArray<double>& slip_ratio,
              const WheelArray<double>& slip_angle, const double& camber, WheelArray<double>& Fx,
              WheelArray<double>& Fy) const;
  [[nodiscard]] const PerWheel<MagicFormulaTyre<double>>& tyres() const { return tyres_; }

 private:
  PerWheel<MagicFormulaTyre<double>> tyres_;
  bool together_;          ///< whether all share combined slip in the same way, one that is written for vectors
  bool stiffens_ = false;  ///< whether any has PKX3
  /// A number of each tyre; of both directions of each: lanes 0 to 3 along x, 4 to 7 along y.
  using Lanes = std::array<double, 4>;
  using Pairs = std::array<double, 8>;
  struct alignas(64) Coefficients {
    Pairs mu, mu_load, mu_camber;                ///< friction; with load; with camber squared
    Pairs SH, SH_load, SH_camber;                ///< horizontal shifts
    Pairs SV, SV_load, SV_camber, SV_both;       ///< vertical shifts over load
    Pairs E, E_load, E_load2, E_sign, E_camber;  ///< curvature
    Pairs C, per_C;                              ///< shape
    Pairs camber;                                ///< scaling of camber
    Lanes K_x, K_x_load, K_x_exponent, K_y, K_y_load, K_y_camber;
    Lanes side;                                      ///< -1: mirrored
    Lanes per_nominal, lowest, per_lowest, highest;  ///< loads [N]
    Lanes kappa_min, kappa_max, alpha_min, alpha_max, gamma_min, gamma_max;
  } c_;
};

}  // namespace veridyn::vehicle
