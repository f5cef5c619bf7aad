#include "veridyn/estimation/judgement/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/limits.hpp"

namespace veridyn::estimation {
namespace {

constexpr std::array kTable{
#define VERIDYN_CHECK(row_check, ...) CheckInfo{.check = Check::row_check, __VA_ARGS__},
#include "veridyn/estimation/judgement/checks/all.inc"
#undef VERIDYN_CHECK
};

/// The limit that decided a row: the failed one where it failed, else that of "with care"; on the side of the value.
double limit_for(double value, Outcome outcome, const Tolerance& t) {
  const bool failed = outcome == Outcome::kFailed;
  const double low = failed ? t.lowest : t.low, high = failed ? t.highest : t.high;
  if (!std::isfinite(low) && !std::isfinite(high)) return kNaN;
  if (!std::isfinite(low)) return high;
  if (!std::isfinite(high)) return low;
  return std::abs(value - low) < std::abs(value - high) ? low : high;
}

}  // namespace

std::span<const CheckInfo> all_checks() { return kTable; }

const CheckInfo& info_of(Check check) { return kTable[static_cast<std::size_t>(check)]; }

std::string_view to_string(Check check) { return info_of(check).name; }

Check check_named(std::string_view name) {
  const auto found = std::ranges::find(kTable, name, &CheckInfo::name);
  return found == kTable.end() ? Check::kUnknown : found->check;
}

std::string_view to_string(Cause cause) {
  static constexpr std::array<std::string_view, kCauses> kNames{
      "none",       "unit",         "scale",     "sign",    "axis",  "frame",        "swap",
      "gravity",    "delay",        "zero",      "place",   "lag",   "frozen",       "held",
      "saturation", "resolution",   "spikes",    "stamps",  "noise", "missing",      "excitation",
      "length",     "missing term", "collinear", "subject", "bound", "other subject"};
  return kNames[static_cast<std::size_t>(cause)];
}

Evidence row_of(Check check, std::string about, double value, double sigma) {
  const CheckInfo& info = info_of(check);
  // A statistic that is missing does not pass.
  Evidence row =
      row_of(check, std::move(about), std::isnan(value) ? Outcome::kMissing : outcome_of(value, sigma, info.tolerance));
  row.value = value;
  row.sigma = sigma;
  row.limit = limit_for(value, row.outcome, info.tolerance);
  return row;
}

Outcome outcome_of_hold_out(double r2, double least) {
  if (!(r2 >= least)) return Outcome::kFailed;
  return r2 < kHoldOutCare ? Outcome::kCare : Outcome::kPassed;
}

Evidence row_of(Check check, std::string about, Outcome outcome) {
  const CheckInfo& info = info_of(check);
  Evidence row{.check = check,
               .about = std::move(about),
               .outcome = outcome,
               .value = kNaN,
               .limit = kNaN,
               .bears_on = info.bears_on};
  return row;
}

}  // namespace veridyn::estimation
