#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace veridyn::estimation {

/// What a result may be used for; each is graded separately.
enum class Purpose {
  kData,        ///< the recording agrees with itself and with physics
  kParameters,  ///< the numbers are physical constants of this individual, within their intervals
  kPrediction   ///< the model predicts held-out motion, inside the range that it was excited in
};
/// In the order of reports.
inline constexpr std::array<Purpose, 3> kPurposes{Purpose::kData, Purpose::kParameters, Purpose::kPrediction};
/// "data", "parameters", "prediction".
[[nodiscard]] std::string_view to_string(Purpose purpose);

/// The purposes that a check bears on: `Purpose::kData | Purpose::kParameters`.
class Purposes {
 public:
  constexpr Purposes() = default;
  constexpr Purposes(Purpose one) : bits_(1U << static_cast<unsigned>(one)) {}  // NOLINT: a purpose is a set of one
  [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
  [[nodiscard]] constexpr bool contains(Purpose purpose) const {
    return (bits_ >> static_cast<unsigned>(purpose) & 1U) != 0;
  }
  friend constexpr Purposes operator|(Purposes a, Purposes b) {
    a.bits_ |= b.bits_;
    return a;
  }

 private:
  unsigned bits_ = 0;
};
/// Both.
constexpr Purposes operator|(Purpose a, Purpose b) { return Purposes(a) | Purposes(b); }
/// What contradicts itself supports nothing.
inline constexpr Purposes kAllPurposes = Purpose::kData | Purpose::kParameters | Purpose::kPrediction;

/// What came of a check.
enum class Outcome {
  kPassed,       ///< nothing to object to
  kNotVerified,  ///< this recording cannot tell; grades are as if nothing were wrong, and the row says what is trusted
  kCare,         ///< what it bears on is at most "with care"
  kMissing,      ///< what would decide is not there: what it bears on is not judged
  kFailed        ///< what it bears on is "no"
};
/// "passed", "not verified", "with care", "missing", "failed".
[[nodiscard]] std::string_view to_string(Outcome outcome);

/// What was checked; veridyn/estimation/judgement/check.hpp names and describes them.
enum class Check : std::uint16_t;

/// What is wrong where a row did not pass.
enum class Cause {
  kNone,         ///< not known, or nothing
  kUnit,         ///< a channel in another unit than was said
  kScale,        ///< a gain that is no known unit's
  kSign,         ///< reversed
  kAxis,         ///< channels taken for each other
  kFrame,        ///< axes of another frame than was said
  kSwap,         ///< another motion than that of its name
  kGravity,      ///< gravity in or out of the specific force
  kDelay,        ///< late or early
  kZero,         ///< a constant added
  kPlace,        ///< not where the study says it is
  kLag,          ///< smoothed by a filter or a slow sensor
  kFrozen,       ///< one value while others move
  kHeld,         ///< measured more slowly than stamped
  kSaturation,   ///< clipped at the end of its range
  kResolution,   ///< steps as large as the signal
  kSpikes,       ///< samples that stand alone
  kStamps,       ///< the clock: repeated, disordered or jumping
  kNoise,        ///< more, or less, than was said
  kMissing,      ///< not recorded, or not given
  kExcitation,   ///< too little motion
  kLength,       ///< too short
  kMissingTerm,  ///< motion that the model does not have
  kCollinear,    ///< inputs that moved alike
  kSubject,      ///< mass, inertia, geometry: what the study says of the individual
  kBound,        ///< of a search
  kOtherSubject  ///< the parts are not of one individual
};
/// In the order above; kOtherSubject is the last.
inline constexpr std::size_t kCauses = static_cast<std::size_t>(Cause::kOtherSubject) + 1;
/// "none", "unit", "scale", ... as files and `--json` have it.
[[nodiscard]] std::string_view to_string(Cause cause);

/// A set of parameter groups, by their places in the analysis (an aircraft's coefficients in the order of their
/// enumeration).
class Groups {
 public:
  constexpr Groups() = default;
  /// All that there are.
  [[nodiscard]] static constexpr Groups all() { return Groups(~0U); }
  /// @param places below 32
  [[nodiscard]] static constexpr Groups of(std::initializer_list<std::size_t> places) {
    unsigned bits = 0;
    for (const std::size_t place : places) bits |= 1U << place;
    return Groups(bits);
  }
  [[nodiscard]] constexpr bool contains(std::size_t place) const { return (bits_ >> place & 1U) != 0; }

 private:
  constexpr explicit Groups(unsigned bits) : bits_(bits) {}
  unsigned bits_ = 0;
};

/// A number or a name that belongs to a row, by the key that the sentences of its check use: "begin", 12.3.
struct Figure {
  std::string key;
  std::variant<double, std::string> value;
};

/// One check of a recording or an estimate: a statistic against its limit, and what follows. No verdict is reached in
/// another way, and whatever a report calls good or bad is a row of these. Texts are for readers: nothing is decided by
/// them.
struct Evidence {
  Check check = Check{};
  std::string about = {};  ///< sensor, channel, parameter or group of parameters ("CL"); empty: all
  Cause cause = Cause::kNone;
  Outcome outcome = Outcome::kPassed;
  double value = 0.0;  ///< the statistic; NaN where there is none
  double sigma = 0.0;  ///< its standard error
  double limit = 0.0;  ///< in the unit and sense of `value`: which decided, else the nearest
  Purposes bears_on = {};
  Groups affects = Groups::all();    ///< the groups of parameters that rest on what was checked
  std::vector<Figure> figures = {};  ///< further numbers (SI units) and names

  /// Adds a figure.
  Evidence& with(std::string key, double figure) & {
    figures.push_back({std::move(key), figure});
    return *this;
  }
  Evidence& with(std::string key, std::string figure) & {
    figures.push_back({std::move(key), std::move(figure)});
    return *this;
  }
  Evidence&& with(std::string key, double figure) && { return std::move(with(std::move(key), figure)); }
  Evidence&& with(std::string key, std::string figure) && { return std::move(with(std::move(key), std::move(figure))); }
  /// Null where there is none of this key.
  [[nodiscard]] const Figure* figure(std::string_view key) const;

  [[nodiscard]] bool passed() const { return outcome == Outcome::kPassed || outcome == Outcome::kNotVerified; }
};

/// `Outcome::kPassed` or `otherwise`.
[[nodiscard]] constexpr Outcome passed_or(bool passed, Outcome otherwise) {
  return passed ? Outcome::kPassed : otherwise;
}

/// Standard errors beyond which a difference is no chance.
inline constexpr double kBeyondChance = 3.0;

/// What a statistic may be: outside of `low` to `high` with care, outside of `lowest` to `highest` failed.
struct Tolerance {
  double low = 0.0, high = 0.0, lowest = 0.0, highest = 0.0;

  /// `care` and `failed` to either side of a centre.
  [[nodiscard]] static constexpr Tolerance about(double centre, double care, double failed) {
    return {centre - care, centre + care, centre - failed, centre + failed};
  }
  /// Beyond `care` with care, beyond `failed` failed; what is small passes.
  [[nodiscard]] static constexpr Tolerance at_most(double care, double failed) {
    return {-kNone, care, -kNone, failed};
  }
  /// What is large passes.
  [[nodiscard]] static constexpr Tolerance at_least(double care, double failed) { return {care, kNone, failed, kNone}; }

  /// In place of a limit that there is not, and of one that is never reached.
  static constexpr double kNone = std::numeric_limits<double>::infinity();
};
/// Of a check that is decided otherwise.
inline constexpr Tolerance kNoLimits{-Tolerance::kNone, Tolerance::kNone, -Tolerance::kNone, Tolerance::kNone};

/// The outcome for a statistic that is somewhere from `low` to `high`: what all of that range exceeds counts.
[[nodiscard]] constexpr Outcome outcome_between(double low, double high, const Tolerance& tolerance) {
  if (high < tolerance.lowest || low > tolerance.highest) return Outcome::kFailed;
  return high < tolerance.low || low > tolerance.high ? Outcome::kCare : Outcome::kPassed;
}

/// The outcome for a statistic with a standard error: what it exceeds by more than kBeyondChance of them counts.
[[nodiscard]] constexpr Outcome outcome_of(double value, double sigma, const Tolerance& tolerance) {
  return outcome_between(value - kBeyondChance * sigma, value + kBeyondChance * sigma, tolerance);
}

}  // namespace veridyn::estimation
