#pragma once

#include <Eigen/Core>
#include <complex>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::aircraft {

/// The natural motions of an aircraft in straight flight.
enum class Mode { kShortPeriod, kPhugoid, kDutchRoll, kRoll, kSpiral };
inline constexpr std::size_t kModes = 5;  ///< values of Mode
/// As in results.
inline constexpr EnumArray<Mode, std::string_view, kModes> kModeNames{
    {"short_period", "phugoid", "dutch_roll", "roll", "spiral"}};
/// "short period".
[[nodiscard]] std::string_view words_of(Mode mode);

/// A mode of the motion about a trim: it goes as Re(e^(s t)).
struct LinearMode {
  Mode mode = Mode::kShortPeriod;
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
