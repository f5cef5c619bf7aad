#pragma once

#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/four_tyres.hpp"

namespace veridyn::vehicle {

/// Four Fiala tyres at once: the equations of `FialaTyre`, without branches on single wheels. Forces are those of the
/// tyres one by one to a few units in the last place; equal wheels give equal bits. Does not throw or allocate.
template <>
class FourTyres<FialaTyre<double>> {
 public:
  explicit FourTyres(const PerWheel<FialaTyre<double>>& tyres) : tyres_(tyres) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      slip_stiffness_[i] = tyres[i].slip_stiffness;
      stiffness_[i] = tyres[i].stiffness;
      slides_at_[i] = 3.0 * tyres[i].mu;
    }
  }

  /// See the general one.
  void forces(const WheelArray<double>& load, const WheelArray<double>& slip_ratio,
              const WheelArray<double>& slip_angle, const double& /*camber*/, WheelArray<double>& Fx,
              WheelArray<double>& Fy) const {
    using Wheels = WheelArray<double>;
    const Wheels linear_x = slip_stiffness_ * slip_ratio, linear_y = stiffness_ * slip_angle;
    const Wheels squared = linear_x * linear_x + linear_y * linear_y;
    // In units of where the whole contact slides: 3 mu F_z; 0 with infinite friction.
    const Wheels s = squared.sqrt() / (slides_at_ * load);
    Wheels share = 1.0 - s * (1.0 - s * (1.0 / 3.0));
    if (!((s < 1.0) && (load > 0.0)).all()) limit(load, squared, s, share);
    Fx = share * linear_x;
    Fy = share * linear_y;
  }
  [[nodiscard]] const PerWheel<FialaTyre<double>>& tyres() const { return tyres_; }

 private:
  /// Wheels that slide, and those off the ground.
  [[gnu::noinline]] static void limit(const WheelArray<double>& load, const WheelArray<double>& squared,
                                      const WheelArray<double>& s, WheelArray<double>& share) {
    for (Eigen::Index w = 0; w < 4; ++w) {
      if (!(s[w] < 1.0)) share[w] = squared[w] > 0.0 ? 1.0 / (3.0 * s[w]) : 1.0;
      if (!(load[w] > 0.0)) share[w] = 0.0;
    }
  }

  PerWheel<FialaTyre<double>> tyres_;
  WheelArray<double> slip_stiffness_, stiffness_;
  WheelArray<double> slides_at_;  ///< 3 mu
};

}  // namespace veridyn::vehicle
