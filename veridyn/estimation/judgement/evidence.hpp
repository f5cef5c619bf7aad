#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
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

/// One check of a recording or an estimate: a statistic against its limit, and what follows. No verdict is reached in
/// another way, and whatever a report calls good or bad is a row of these.
struct Evidence {
  std::string name = {};   ///< "hold-out", "accelerometer against velocity and attitude"
  std::string about = {};  ///< the group of parameters ("CL") or sensor that it is about; empty: all
  Outcome outcome = Outcome::kPassed;
  double value = 0.0;  ///< the statistic; NaN where there is none
  double limit = 0.0;
  std::string scale = {};  ///< of value and limit: "p", "share of the variance", "sigma", "m/s"
  std::string text = {};   ///< what was seen and what it means, one sentence without a full stop
  Purposes bears_on = {};
  std::string advice = {};  ///< what to do; empty where nothing is to be done

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
};

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
