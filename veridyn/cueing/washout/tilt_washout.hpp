#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the plain tilt channel.
class TiltDesign final : public WashoutDesign {
 public:
  std::array<double, 2> force_gain = {1.0, 1.0};  ///< surge, sway
  double tilt = 10.0;                             ///< low-pass of the forces, second order [rad/s]
  double zeta = 1.0;                              ///< its damping ratio
  double tilt_rate = 3.0 * kDegree;               ///< [rad/s]

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override { return std::make_unique<TiltDesign>(*this); }
};

/// Tilt coordination and nothing else: what any algorithm has to be better than.
class TiltWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  explicit TiltWashout(const TiltDesign& design);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<TiltWashout>(*this); }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  TiltDesign design_;
  std::array<numerics::CausalFilter, 2> low_pass_;
  std::array<TiltCoordination, 2> tilt_;
};

}  // namespace veridyn::cueing
