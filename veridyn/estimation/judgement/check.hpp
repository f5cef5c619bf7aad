#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::estimation {

/// Everything that is checked of a recording or an estimate, in any domain. The tables in `checks/` say of each what is
/// compared with which limits, where these come from, and what it bears on; a check is added there and where it is
/// made, nowhere else.
enum class Check : std::uint16_t {
#define VERIDYN_CHECK(check, ...) check,
#include "veridyn/estimation/judgement/checks/all.inc"
#undef VERIDYN_CHECK
};

/// Who is checked; a heading of docs/judgement.md.
enum class CheckedOf { kRecording, kFlight, kCoefficient, kDrive, kVehicle, kLimb, kRegression, kTracking, kAny };

/// In their order.
inline constexpr std::array<Cause, kCauses> kAllCauses = [] {
  std::array<Cause, kCauses> all{};
  for (std::size_t i = 0; i < kCauses; ++i) all[i] = static_cast<Cause>(i);
  return all;
}();

/// Where the limits of a check come from.
struct LimitSource {
  enum class Kind {
    kLogic,     ///< no number: it follows from what the words mean, or what was asked for is not there
    kCitation,  ///< printed elsewhere
    kCampaign,  ///< alarms counted over recordings without a fault
    kLevel,     ///< a test whose rate of false alarms is its level
    kDerived    ///< computed from what the estimate states: bands of 95 %, bounds of a search
  };
  Kind kind = Kind::kLogic;
  std::string_view text = {};  ///< the source; of a campaign its test and its alarms
};

[[nodiscard]] constexpr LimitSource citation(std::string_view text) { return {LimitSource::Kind::kCitation, text}; }
[[nodiscard]] constexpr LimitSource campaign(std::string_view text) { return {LimitSource::Kind::kCampaign, text}; }
[[nodiscard]] constexpr LimitSource level(std::string_view text) { return {LimitSource::Kind::kLevel, text}; }
[[nodiscard]] constexpr LimitSource derived(std::string_view text) { return {LimitSource::Kind::kDerived, text}; }

/// A sentence, and which rows say it. `{about}`, `{value}`, `{sigma}`, `{limit}`, `{cause}` and the keys of the row's
/// figures stand for what the row holds, with a format as of fmt: `{value:.2f}`. A number is given in percent, in
/// milliseconds or in degrees by `{value_percent}`, `{value_ms}`, `{value_deg}`.
struct Phrase {
  std::string_view text = {};
  std::optional<Outcome> outcome = {};
  std::optional<Cause> cause = {};

  constexpr Phrase() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a text alone is for every row
  constexpr Phrase(const char* any) : text(any) {}
  constexpr Phrase(Outcome which, std::string_view sentence) : text(sentence), outcome(which) {}
  constexpr Phrase(Cause which, std::string_view sentence) : text(sentence), cause(which) {}
  constexpr Phrase(Outcome which, Cause why, std::string_view sentence) : text(sentence), outcome(which), cause(why) {}

  [[nodiscard]] constexpr bool fits(const Evidence& row) const {
    return outcome.value_or(row.outcome) == row.outcome && cause.value_or(row.cause) == row.cause;
  }
};
/// The first that fits a row is its sentence.
using Phrases = std::array<Phrase, 10>;
constexpr Phrase if_passed(std::string_view text) { return {Outcome::kPassed, text}; }
constexpr Phrase if_unverified(std::string_view text) { return {Outcome::kNotVerified, text}; }
constexpr Phrase if_care(std::string_view text) { return {Outcome::kCare, text}; }
constexpr Phrase if_missing(std::string_view text) { return {Outcome::kMissing, text}; }
constexpr Phrase if_failed(std::string_view text) { return {Outcome::kFailed, text}; }
constexpr Phrase if_cause(Cause cause, std::string_view text) { return {cause, text}; }

/// What is to be known of a check before any recording.
struct CheckInfo {
  Check check = {};
  CheckedOf of = CheckedOf::kAny;
  std::string_view name = {};      ///< "frozen samples": of reports, and with '_' for ' ' its name in files
  std::string_view compares = {};  ///< the statistic in words
  std::string_view unit = {};      ///< of statistic and limits; "1" where they are ratios
  Tolerance tolerance = kNoLimits;
  std::string_view key = {};     ///< of the study, which sets the limit in place of the tolerance's
  std::string_view care = {};    ///< when it is "with care", where the tolerance does not say all
  std::string_view failed = {};  ///< when it has failed, likewise
  Purposes bears_on = {};
  LimitSource source = {};
  Phrases says = {};    ///< what was seen and what it means, without a full stop
  Phrases advice = {};  ///< what to do; of a row that passed nothing is said
};

/// All, in the order of the enumeration.
[[nodiscard]] std::span<const CheckInfo> all_checks();
[[nodiscard]] const CheckInfo& info_of(Check check);
/// "frozen samples".
[[nodiscard]] std::string_view to_string(Check check);
/// By its name; `Check::kUnknown` for one that this version does not have.
[[nodiscard]] Check check_named(std::string_view name);

/// "frozen samples"; of a row.
[[nodiscard]] std::string_view name_of(const Evidence& row);
/// Of its value and limit: "s", "p", "reading over truth".
[[nodiscard]] std::string_view unit_of(const Evidence& row);
/// What a row has seen, in English: the sentence of its check with the row's numbers.
[[nodiscard]] std::string says(const Evidence& row);
/// Whether a text holds a name as a word of its own: what need not be named again.
[[nodiscard]] bool mentions(std::string_view text, std::string_view name);
/// What to do where it did not pass; empty where nothing is to be done.
[[nodiscard]] std::string advice_of(const Evidence& row);

/// A row whose outcome follows from the limits of its check, beyond kBeyondChance standard errors. Its limit is the one
/// that decided, else the nearest. Missing where the value is NaN.
[[nodiscard]] Evidence row_of(Check check, std::string about, double value, double sigma = 0.0);
/// What a share R2 of unseen motion is worth: failed below `least`, with care below kHoldOutCare (or `least`, where a
/// study asks for more).
[[nodiscard]] Outcome outcome_of_hold_out(double r2, double least);
/// A row whose outcome the caller reached: by logic, by a test's p, or by a limit of the study.
[[nodiscard]] Evidence row_of(Check check, std::string about, Outcome outcome);

}  // namespace veridyn::estimation
