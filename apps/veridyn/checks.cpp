// veridyn checks: everything that is checked, with limits and their sources.
#include <fmt/format.h>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/estimation/judgement/check_table.hpp"

namespace veridyn::app {
namespace {

using estimation::CheckInfo;
using estimation::Outcome;

int checks(const Arguments& arguments) {
  if (arguments.common.json) {
    Summary all = Summary::array();
    for (const CheckInfo& info : estimation::all_checks()) {
      if (info.check == estimation::Check::kUnknown) continue;
      Summary purposes = Summary::array();
      for (const estimation::Purpose purpose : estimation::kPurposes)
        if (info.bears_on.contains(purpose)) purposes.push_back(estimation::to_string(purpose));
      Summary one = Summary::object({{"check", info.name},
                                     {"of", estimation::to_string(info.of)},
                                     {"compares", info.compares},
                                     {"unit", info.unit},
                                     {"care", rule_of(info, Outcome::kCare)},
                                     {"failed", rule_of(info, Outcome::kFailed)},
                                     {"key", info.key},
                                     {"source", source_of(info)}});
      one["bears_on"] = std::move(purposes);
      all.push_back(std::move(one));
    }
    Summary summary = Summary::object();
    summary["checks"] = std::move(all);
    print_summary(summary, arguments.common);
    return kDone;
  }
  print_text(estimation::checks_in_markdown());
  return kDone;
}

}  // namespace

Command checks_command() {
  return {.name = "checks",
          .summary = "everything that is checked of a recording or an estimate, with limits and where these come from",
          .arguments = {},
          .example = "veridyn checks --json",
          .run = checks};
}

}  // namespace veridyn::app
