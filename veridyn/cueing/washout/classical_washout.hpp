#pragma once

#include <array>

#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/washout/washout_channels.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// The classical washout's gains and break frequencies. The defaults are those of the SIMONA simulator's OMCT entry.
class ClassicalDesign final : public WashoutDesign {
 public:
  std::array<double, 3> force_gain = {0.6, 0.6, 0.5};  ///< surge, sway, heave
  std::array<double, 3> rate_gain = {0.6, 0.6, 0.6};   ///< roll, pitch, yaw
  std::array<double, 3> onset = {0.8, 1.0, 1.0};       ///< high-pass of the accelerations, second order [rad/s]
  std::array<double, 3> recentre = {0.0, 0.0, 0.2};    ///< a further first-order high-pass of them [rad/s]; 0: none
  double tilt = 2.0;                                   ///< low-pass of tilt coordination, second order [rad/s]
  double tilt_rate = 3.0 * kDegree;                    ///< greatest rate of tilt coordination [rad/s]
  std::array<double, 3> turn = {1.0, 0.8, 1.0};        ///< high-pass of the rates, second order [rad/s]
  double zeta = 1.0;                                   ///< damping ratio of all second-order filters

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override;
};

/// The classical algorithm (Schmidt & Conrad 1970, NASA CR-1601; Reid & Nahon 1985, UTIAS 296) with exact
/// discretisation of its filters for motion on lines between samples:
///
///     shift      gain a through `ShiftChannel`
///     tilt       gain f through a low-pass and `TiltCoordination`
///     angle      tilt + gain omega through `TurnChannel`
///
/// a = f + g is taken from the specific force with the attitude; without one the vehicle is taken for level. f holds
/// gravity, so that a slope of the road tilts the platform too.
class ClassicalWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  explicit ClassicalWashout(const ClassicalDesign& design);

  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<ClassicalWashout>(*this); }

  /// Roll and pitch of tilt coordination alone [rad].
  [[nodiscard]] std::array<double, 2> tilt() const { return {tilt_[0].tilt(), tilt_[1].tilt()}; }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  ClassicalDesign design_;
  std::array<ShiftChannel, 3> shift_;
  std::array<TurnChannel, 3> turn_;
  std::array<numerics::CausalFilter, 2> low_pass_;  ///< of the forces that roll and pitch stand for
  std::array<TiltCoordination, 2> tilt_;            ///< roll, pitch
};

}  // namespace veridyn::cueing
