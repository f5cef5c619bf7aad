#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/export/complete_subject.hpp"
#include "veridyn/aircraft/model/linear_modes.hpp"
#include "veridyn/aircraft/model/trim.hpp"

namespace veridyn::aircraft {

/// What a mode did in flight.
enum class ModeVerdict {
  kAsPredicted,   ///< it grew or died away as its eigenvalue says, within a quarter or 0.02 1/s
  kOtherwise,     ///< it did not: the model is not what its tangent says, even at small angles
  kNotSeparated,  ///< it went before it could be followed, or no surface moves it
};

/// A mode, and how fast it grew after a doublet [1/s]; negative: it died away.
struct FlownMode {
  LinearMode linear;
  std::string_view surface;  ///< that was moved
  double growth = 0.0;
  ModeVerdict verdict = ModeVerdict::kNotSeparated;
};

/// A flight of an aircraft that is to be exported: trimmed, then a doublet of each surface, hands off.
struct TrialFlight {
  ExportCondition condition;
  Trim trim;
  bool without_asymmetry = false;  ///< flown without CY_0, Cl_0, Cn_0: with them it is not level without bank
  std::vector<FlownMode> modes;    ///< empty where there is no trim

  /// Whether it was trimmed, and every mode that could be followed did what the model says.
  [[nodiscard]] bool as_predicted() const;
  /// Names of modes that grow.
  [[nodiscard]] std::vector<std::string> unstable() const;
};

/// Flies a complete subject by the equations of motion, without a pilot: from the trim a doublet of the deflection,
/// half a second to each side, so large that the linear motion stays within 1 deg of alpha and beta and 10 deg/s. Each
/// mode is followed by its left eigenvector, which the other modes do not touch, from the end of the doublet over two
/// of its time constants (up to 20 s), and its growth is the slope of the logarithm of its size. A mode is followed
/// after the doublet of the surface that moves it most.
[[nodiscard]] TrialFlight fly_trial(const CompletedSubject& completed);

/// Altitude at which the standard atmosphere has this density [m], from -2 to 20 km.
[[nodiscard]] double standard_altitude(double density);

/// Trim and modes for people, a line each.
[[nodiscard]] std::vector<std::string> trial_lines(const TrialFlight& trial);

}  // namespace veridyn::aircraft
