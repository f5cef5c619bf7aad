#pragma once

#include <Eigen/Core>
#include <complex>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::aircraft {

/// The motions that a small disturbance of steady flight is made of.
enum class FlightMode { kShortPeriod, kPhugoid, kRoll, kDutchRoll, kSpiral };
inline constexpr std::size_t kFlightModes = 5;  ///< values of FlightMode
/// "short period".
inline constexpr EnumArray<FlightMode, std::string_view, kFlightModes> kFlightModeNames{
    {"short period", "phugoid", "roll", "Dutch roll", "spiral"}};

/// A mode of the motion about a trim: it goes as Re(e^(s t)).
struct LinearMode {
  FlightMode mode = FlightMode::kShortPeriod;
  std::complex<double> s;  ///< of a pair that with imag > 0
  Eigen::VectorXcd left;   ///< left eigenvector: left' x of a motion x' = A x goes as e^(s t) alone

  [[nodiscard]] bool stable() const { return s.real() < 0.0; }
};

/// The modes of straight flight, from the blocks [u w q theta] and [v p r phi] of `linearise`. Of the first the two
/// eigenvalues further from zero are the short period. Of the second a pair is the Dutch roll, of two real ones the
/// faster is roll and the slower spiral; a slower pair is called spiral (with roll coupled into it), and of four real
/// ones the middle two Dutch roll. Two real ones of one name are two entries.
[[nodiscard]] std::vector<LinearMode> linear_modes(const LinearModel& model);

}  // namespace veridyn::aircraft
