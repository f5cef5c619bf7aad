#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the classical algorithm for platforms that turn and heave but do not shift.
class ThreeAxisDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  std::array<double, 3> bound = {10.0, 10.0, 10.0};  ///< of accelerations, surge, sway, heave [m/s^2]
  double instant = 0.6;                              ///< share of the onset that tilt stands for
  double sustained = 1.0;                            ///< share of the lasting force
  double onset = 2.0;                                ///< high-pass of the onset, second order [rad/s]
  double onset_rate = 6.0 * kDegree;                 ///< greatest rate of the onset's tilt [rad/s]
  double tilt = 3.0;                                 ///< low-pass of the lasting force, second order [rad/s]
  double heave_jerk = 100.0;                         ///< greatest change of heave's acceleration [m/s^3]

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override {
    return std::make_unique<ThreeAxisDesign>(*this);
  }
};

/// The classical algorithm where there is no surge and no sway: the beginnings of a force are a tilt as well, of a
/// channel of their own that may turn faster.
///
///     onset      asin(high-pass(bounded gain f) / g), its rate limited by onset_rate
///     slope      asin(low-pass(bounded gain f) / g), its rate limited by tilt_rate
///     angle      instant onset + sustained slope + gain omega through `TurnChannel`
///     heave      rate-limited, bounded gain a_z through `ShiftChannel`
class ThreeAxisWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  explicit ThreeAxisWashout(const ThreeAxisDesign& design);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<ThreeAxisWashout>(*this); }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  ThreeAxisDesign design_;
  SharedChannels shared_;
  std::array<numerics::CausalFilter, 2> high_pass_, low_pass_;
  std::array<TiltCoordination, 2> onset_, slope_;
  double heave_ = 0.0;  ///< rate-limited acceleration down [m/s^2]
};

}  // namespace veridyn::cueing
