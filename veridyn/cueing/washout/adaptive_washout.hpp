#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the adaptive washout.
class AdaptiveDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  double onset = 1.0;         ///< break frequency of surge and sway [rad/s]
  double tilt = 2.0;          ///< how fast tilt goes where it is desired [rad/s]
  double adaptation = 2.0;    ///< how fast the gains follow [1/s]
  double shift_weight = 4.0;  ///< of the squared shift over the platform's range, against a force of 1 m/s^2 squared
  double speed_weight = 1.0;  ///< the same of its rate, over range and second
  double gain_weight = 1.0;   ///< of the squared deviation of gains from nominal
  double most_gain = 2.0;     ///< over nominal

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override {
    return std::make_unique<AdaptiveDesign>(*this);
  }
};

/// Classical filters whose gains follow the steepest descent of a momentary cost (Parrish, Dieudonne & Martin 1975,
/// J Aircraft 12:44; Nahon & Reid 1990, J Guid Control Dyn 13:356). Of each pair of axes, with f and a scaled:
///
///     x'' = p1 a - 2 w x' - w^2 x,  theta' = limited(p2 w_t (asin(f/g) - theta))
///     J = 1/2 [e^2 + w_x (x/X)^2 + w_v (x'/X)^2 + w_p (p1 - 1)^2 + w_p (p2 - 1)^2],  e = f - x'' - g sin(theta)
///     p' = -G dJ/dp / (1 + (de/dp)^2)
///
/// with the derivatives of x, x' and theta along p from their own differential equations. Dividing by 1 + (de/dp)^2
/// bounds the descent by G times the error whatever the input; p stays between 0 and `most_gain`; without motion all
/// that is left of dJ/dp is w_p (p - 1), and the gains return to nominal.
class AdaptiveWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  AdaptiveWashout(const AdaptiveDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<AdaptiveWashout>(*this); }

  /// Gains p1 and p2 of sway and roll, of surge and pitch.
  [[nodiscard]] std::array<Eigen::Vector2d, 2> gains() const;

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  enum : Eigen::Index { kShift, kSpeed, kTilt, kShiftGain, kTiltGain, kShiftAlong, kSpeedAlong, kTiltAlong, kStates };
  using State = Eigen::Matrix<double, kStates, 1>;
  struct Pair {
    double range = 0.0;  ///< of the shift [m]; 0: the platform has none
    State state = State::Zero();
    PairedInput input = PairedInput::Zero();
    [[nodiscard]] State rate(const State& x, const PairedInput& u, const AdaptiveDesign& d) const;
    [[nodiscard]] double shift_acceleration(const State& x, const PairedInput& u, const AdaptiveDesign& d) const;
    PairedOutput step(const PairedInput& now, const AdaptiveDesign& d, SampleStep step);
  };

  AdaptiveDesign design_;
  SharedChannels shared_;
  std::array<Pair, 2> pairs_;
};

}  // namespace veridyn::cueing
