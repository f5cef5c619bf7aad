#include "veridyn/recording/time_order.hpp"

#include <algorithm>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::kBeyondChance;
using estimation::Outcome;

/// `give_s` is the delay that the study would have to state.
Evidence order_row(const DelayReport& report, const TimeOrder& order, Outcome outcome, double give_s) {
  Evidence row = estimation::row_of(Check::kOrderInTime, report.group, outcome);
  row.value = report.delay_s;
  row.sigma = report.sigma_s;
  row.limit = (report.delay_s < 0.0 ? -1.0 : 1.0) * (outcome == Outcome::kFailed ? order.failed_s : order.early_s);
  return std::move(row)
      .with("early", -report.delay_s)
      .with("reference", report.reference)
      .with("give", order.key.empty() ? "delays." + report.group : order.key)
      .with("give_s", give_s);
}

}  // namespace

bool is_early(const DelayReport& report, const TimeOrder& order) {
  const double limit = std::max(order.early_s, kBeyondChance * report.sigma_s);
  return report.determined() && report.delay_s < -limit && report.correlation > 0.0;
}

bool is_doubtful(const DelayReport& report, const TimeOrder& order) {
  const double limit = std::max(order.early_s, kBeyondChance * report.sigma_s);
  return report.finding == DelayFinding::kInDoubt && report.delay_s > limit;
}

bool is_opposite(const DelayReport& report) { return report.finding == DelayFinding::kOppositeSign; }

Evidence early_row(const DelayReport& report, const TimeOrder& order) {
  const bool failed = report.delay_s + kBeyondChance * report.sigma_s < -order.failed_s;
  Evidence row = order_row(report, order, failed ? Outcome::kFailed : Outcome::kCare,
                           order.is_control ? -report.delay_s : report.delay_s);
  row.cause = order.is_control ? Cause::kDelay : Cause::kStamps;
  return row;
}

Evidence doubtful_row(const DelayReport& report, const TimeOrder& order) {
  Evidence row = order_row(report, order, Outcome::kCare, -report.delay_s);
  row.cause = Cause::kLag;
  return row;
}

Evidence opposite_row(const DelayReport& report) {
  Evidence row = estimation::row_of(Check::kSignAgainstOthers, report.group, report.correlation);
  row.cause = Cause::kSign;
  return std::move(row).with("reference", report.reference);
}

}  // namespace veridyn::recording
