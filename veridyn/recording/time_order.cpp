#include "veridyn/recording/time_order.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace veridyn::recording {
namespace {

estimation::Evidence order_row(std::string name, std::string about, double value, double limit, const char* scale) {
  return {.name = std::move(name),
          .about = std::move(about),
          .outcome = estimation::Outcome::kCare,
          .value = value,
          .limit = limit,
          .scale = scale,
          .bears_on = estimation::kAllPurposes};
}

}  // namespace

bool is_early(const DelayReport& report, const TimeOrder& order) {
  const double limit = std::max(order.early_s, estimation::kBeyondChance * report.sigma_s);
  return report.delay_s < -limit && report.correlation > 0.0;
}

bool is_doubtful(const DelayReport& report, const TimeOrder& order) {
  return report.finding == DelayFinding::kInDoubt && report.delay_s > std::max(order.early_s, estimation::kBeyondChance * report.sigma_s);
}

bool is_opposite(const DelayReport& report) {
  return report.finding == DelayFinding::kOppositeSign;
}

estimation::Evidence early_row(const DelayReport& report, const TimeOrder& order) {
  estimation::Evidence row = order_row("order in time", report.group, report.delay_s, order.early_s, "s");
  row.text = order.is_control ? fmt::format("{} is recorded {:.2f} s after its effect", report.group, -report.delay_s)
                              : fmt::format("{} shows the motion {:.2f} s before {}", report.group, -report.delay_s,
                                            report.reference);
  row.advice = fmt::format("check the stamps of {}, or give its delay: delays.{} = \"{:.0f} ms\"", report.group,
                           report.group, 1000.0 * (order.is_control ? -report.delay_s : report.delay_s));
  return row;
}

estimation::Evidence doubtful_row(const DelayReport& report, const TimeOrder& order) {
  estimation::Evidence row = order_row("order in time", report.group, report.delay_s, order.early_s, "s");
  row.text = fmt::format(
      "{} goes best with {} if it is recorded {:.3f} +- {:.3f} s early, as a command before its servo moves; that was "
      "not taken off, since more of the motion is unexplained than {} explains",
      report.group, report.reference, report.delay_s, report.sigma_s, report.group);
  row.advice = fmt::format("measure servo and link on the ground, or take it off: delays.{} = \"{:.0f} ms\"",
                           report.group, -1000.0 * report.delay_s);
  return row;
}

estimation::Evidence opposite_row(const DelayReport& report) {
  estimation::Evidence row =
      order_row("sign against the other sensors", report.group, report.correlation, 0.0, "correlation");
  row.text = fmt::format("{} moves against what {} implies (correlation {:.2f})", report.group, report.reference,
                         report.correlation);
  row.advice = fmt::format("check the sign of {}", report.group);
  return row;
}

estimation::Evidence late_row(const std::string& sensor, const std::string& shown_by, double delay_s, double limit_s) {
  estimation::Evidence row = order_row(fmt::format("delay of the {}", sensor), sensor, delay_s, limit_s, "s");
  row.text = fmt::format("the {} is {:.2f} s late: the {}, which follows from it, shows the motion before", sensor,
                         delay_s, shown_by);
  row.advice = fmt::format("check the {}'s stamps and the filter that its values went through", sensor);
  return row;
}

}  // namespace veridyn::recording
