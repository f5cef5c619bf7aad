#pragma once

#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the washout whose neutral place moves.
class MovingOriginDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  double onset = 0.8;         ///< high-pass of surge and sway, second order [rad/s]
  double tilt = 2.0;          ///< low-pass of tilt coordination, second order [rad/s]
  double fades = 1.5;         ///< time constant with which an acceleration is foreseen to fade [s]
  double use = 0.8;           ///< share of the range that is to be used
  double origin_force = 0.1;  ///< acceleration with which the origin moves, below what is felt [m/s^2]

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override {
    return std::make_unique<MovingOriginDesign>(*this);
  }
};

/// Predictive washout with a dynamic origin, after the idea of Wang (dynamic washout origin from the extreme motion
/// that is foreseen): the classical filters, and from their state and an acceleration that fades, how far the shift
/// will go. Where that is beyond the range in use, the place to which the filters bring the platform back moves the
/// other way, so slowly that nobody feels it; else it goes back to the middle.
///
///     extremes   of x'' = a exp(-t/T) - 2 z w x' - w^2 x from now on, at 12 moments of the next 3/w
///     origin     x0'' = limited(-2 h x0' - h^2 (x0 - x0*)), x0* = what the extremes exceed the range by, negative
class MovingOriginWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  MovingOriginWashout(const MovingOriginDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<MovingOriginWashout>(*this); }

  /// Where surge and sway come back to [m].
  [[nodiscard]] Eigen::Vector2d origin() const { return {pairs_[1].state(2), -pairs_[0].state(2)}; }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  static constexpr int kMoments = 12;
  struct Pair {
    double range = 0.0;                               ///< of the shift [m]; 0: the platform has none
    Eigen::Vector4d state = Eigen::Vector4d::Zero();  ///< shift, its rate; origin, its rate
    double input = 0.0;
    numerics::CausalFilter low_pass;
    TiltCoordination tilt;
    PairedOutput step(const PairedInput& now, const MovingOriginWashout& of, SampleStep step);
  };
  /// By how much the shift will leave the range in use, with its sign [m].
  [[nodiscard]] double excess(const Pair& pair, double acceleration) const;
  [[nodiscard]] static Pair pair_of(const MovingOriginDesign& design, const Platform& platform, Eigen::Index pair);

  MovingOriginDesign design_;
  SharedChannels shared_;
  std::array<Eigen::Matrix<double, 1, 3>, kMoments> foreseen_;  ///< shift over shift, rate and acceleration of now
  std::array<Pair, 2> pairs_;
};

}  // namespace veridyn::cueing
