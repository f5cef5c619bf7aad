#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the algorithm with a return mode.
class ReturnDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  double onset = 1.0;        ///< high-pass of surge and sway, second order [rad/s]
  double threshold = 0.17;   ///< a force below this brings the platform back to neutral [m/s^2]
  double home = 2.0;         ///< how fast it returns: critically damped [rad/s]
  double home_force = 0.15;  ///< greatest acceleration on the way back to neutral, below what is felt [m/s^2]

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override { return std::make_unique<ReturnDesign>(*this); }
};

/// Tilt coordination without a low-pass and a mode that brings the platform back, after You, Lee, Kang & Yoo 2005 (J
/// Mech Sci Technol 19:272). The tilt stands for all of the force that the shift does not render at the moment, and
/// goes there at once, no faster than tilt_rate:
///
///     onset mode   shift'' = high-pass(gain a); tilt -> asin((gain f - shift'') / g)
///     return mode  while |gain f| is below the threshold: shift'' = 2 w (v - shift') within home_force, tilt -> 0,
///                  v the speed back that half of home_force can brake, -w/2 shift close to neutral
///
/// A shift so fast that home_force would not end it within four fifths of the range is braked harder, and that is felt.
///
/// After a return the shift is led back to where the high-pass would have it, in the same way.
class ReturnWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  ReturnWashout(const ReturnDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<ReturnWashout>(*this); }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  /// Surge with pitch or sway with roll.
  struct Pair {
    double reach = 0.0;                               ///< of the shift to either side [m]; 0: it cannot
    Eigen::Vector4d state = Eigen::Vector4d::Zero();  ///< shift, its rate; the same of the high-pass
    PairedInput input = PairedInput::Zero();
    TiltCoordination tilt;
    PairedOutput step(const PairedInput& now, const ReturnDesign& design, SampleStep step);
  };

  ReturnDesign design_;
  SharedChannels shared_;
  std::array<Pair, 2> pairs_;
};

}  // namespace veridyn::cueing
