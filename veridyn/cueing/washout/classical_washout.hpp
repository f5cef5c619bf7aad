#pragma once

#include <array>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/cueing/washout/washout.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"

namespace veridyn::cueing {

/// The classical washout's gains and break frequencies. The defaults are those of the SIMONA simulator's OMCT entry.
struct ClassicalOptions {
  std::array<double, 3> force_gain = {0.6, 0.6, 0.5};  ///< surge, sway, heave
  std::array<double, 3> rate_gain = {0.6, 0.6, 0.6};   ///< roll, pitch, yaw
  std::array<double, 3> onset = {0.8, 1.0, 1.0};       ///< high-pass of the accelerations, second order [rad/s]
  std::array<double, 3> recentre = {0.0, 0.0, 0.2};    ///< a further first-order high-pass of them [rad/s]; 0: none
  double tilt = 2.0;                                   ///< low-pass of tilt coordination, second order [rad/s]
  double tilt_rate = 3.0 * kDegree;                    ///< greatest rate of tilt coordination [rad/s]
  std::array<double, 3> turn = {1.0, 0.8, 1.0};        ///< high-pass of the rates, second order [rad/s]
  double zeta = 1.0;                                   ///< damping ratio of all second-order filters

  /// Reads `[washout]` with these keys, rates with units ("3 deg/s"). @throws InputError with file, line and key.
  [[nodiscard]] static ClassicalOptions read(const StudyTable& table);
  /// @throws InputError naming key, value and rule.
  void validate() const;
};

/// The classical algorithm (Schmidt & Conrad 1970, NASA CR-1601; Reid & Nahon 1985, UTIAS 296) with exact
/// discretisation of its filters for motion on lines between samples:
///
///     shift      gain a / (s^2 + 2 zeta w s + w^2) [s / (s + recentre)]: acceleration through the high-pass, twice
///                integrated, in one filter without a pole at zero, so that it cannot drift
///     tilt       asin(low-pass(gain f)/g), its rate limited below what is felt as a turn; |f/g| is taken for 1 at most
///     angle      tilt + gain omega s / (s^2 + 2 zeta w s + w^2)
///
/// a = f + g is taken from the specific force with the attitude; without one the vehicle is taken for level. f holds
/// gravity, so that a slope of the road tilts the platform too.
class ClassicalWashout final : public Washout {
 public:
  /// @throws as `ClassicalOptions::validate`.
  explicit ClassicalWashout(const ClassicalOptions& options);

  PlatformCommand reset(const recording::MotionSample& sample) override;
  PlatformCommand step(const recording::MotionSample& sample, double step) override;
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<ClassicalWashout>(*this); }

  /// Roll and pitch of tilt coordination alone [rad].
  [[nodiscard]] const std::array<double, 2>& tilt() const { return tilt_; }

 private:
  using Filter = numerics::CausalFilter;
  /// Position and acceleration, or angle and rate, that follow from one input.
  struct Channel {
    Filter place, change;
  };
  [[nodiscard]] static Channel shift_channel(const ClassicalOptions& options, std::size_t axis);
  [[nodiscard]] static Channel turn_channel(const ClassicalOptions& options, std::size_t axis);
  /// @param step nothing: reset
  [[nodiscard]] PlatformCommand filtered(const recording::MotionSample& sample, std::optional<double> step);

  ClassicalOptions options_;
  std::array<Channel, 3> shift_, turn_;
  std::array<Filter, 2> low_pass_;  ///< of f_y and f_x
  std::array<double, 2> tilt_{};    ///< roll, pitch
};

}  // namespace veridyn::cueing
