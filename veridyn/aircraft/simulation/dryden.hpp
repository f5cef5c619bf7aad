#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// Scale lengths [m] and intensities [m/s] of Dryden turbulence (MIL-F-8785C).
struct DrydenSettings {
  double Lu = 200.0, Lv = 200.0, Lw = 50.0;
  double sigma_u = 0.0, sigma_v = 0.0, sigma_w = 0.0;  ///< standard deviations; all zero is calm air

  [[nodiscard]] bool calm() const { return sigma_u == 0.0 && sigma_v == 0.0 && sigma_w == 0.0; }
  friend bool operator==(const DrydenSettings&, const DrydenSettings&) = default;
};

/// "none", "low_light", "low_moderate", "medium_light", "medium_moderate": low is 50 m, medium 600 m (Beard & McLain
/// 2012, table 4.1).
/// @throws InputError naming the nearest one.
[[nodiscard]] DrydenSettings dryden_settings(std::string_view name, std::string_view place);

/// The key `turbulence` of a table of keys; `others` are names besides those above, the first the default.
[[nodiscard]] StudyKey turbulence_key(std::vector<std::string> others, std::string says);

/// Reads such a key: a name as above, or a table { Lu, Lv, Lw, sigma_u, sigma_v, sigma_w } ([m], [m/s]).
[[nodiscard]] DrydenSettings read_dryden(const StudyTable& table, std::string_view key);

/// The two-state filter of lateral and vertical gusts over one step, in normalised states.
///
/// H(s) = sigma sqrt(3 b) (s + b/sqrt 3) / (s + b)^2 with b = Va/L, driven by white noise of two-sided power spectral
/// density 1, so that the variance of the gust is sigma^2. With z1' = -b z1 + sqrt(b) w, z2' = b (z1 - z2) the gust is
/// sigma sqrt 3 (z1 + (1/sqrt 3 - 1) z2), and the stationary covariance of z is [1/2 1/4; 1/4 1/4] whatever b is: a
/// change of airspeed leaves the states stationary. `transition` and `noise` (a lower Cholesky factor) are exact for
/// any theta = b h >= 0: P = transition P transition' + noise noise' holds to rounding.
struct DrydenStep {
  double decay;                      ///< e^-theta
  double coupling;                   ///< theta e^-theta: transition = [decay 0; coupling decay]
  double noise11, noise21, noise22;  ///< Cholesky factor of the covariance added in the step
  explicit DrydenStep(double theta);
};

/// Gusts along body axes [m/s] that an aircraft meets as it flies through frozen turbulence, with an exact
/// discretisation for any step. First order along x (Hu = sigma sqrt(2 b) / (s + b), b = Va/Lu), second order along y
/// and z.
class DrydenGusts {
 public:
  /// Starts in the stationary state.
  DrydenGusts(const DrydenSettings& settings, numerics::RandomStream random);

  /// Goes on by `step` [s] at airspeed `Va` [m/s].
  void advance(double step, double Va);
  /// [u, v, w].
  [[nodiscard]] std::array<double, 3> gust() const;

 private:
  struct Pair {
    double z1 = 0.0, z2 = 0.0;
  };
  void advance(Pair& pair, double theta);

  DrydenSettings settings_;
  numerics::RandomStream random_;
  double u_ = 0.0;  ///< in units of sigma_u
  Pair v_, w_;
};

}  // namespace veridyn::aircraft
