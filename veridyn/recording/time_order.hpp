#pragma once

#include <limits>
#include <string>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/recording/delays.hpp"

namespace veridyn::recording {

/// What a delay report is about, for its row.
struct TimeOrder {
  double early_s = 0.03;       ///< beyond three standard errors: recorded too late after (or before) what it goes with
  double failed_s = kNever_s;  ///< and failed
  bool is_control = false;     ///< the report's group moves what its reference shows: a surface, the steering
  std::string key = {};        ///< of the study that takes its delay; empty: "delays.GROUP"

  static constexpr double kNever_s = std::numeric_limits<double>::infinity();
};

/// Whether what a report is about shows something before its reference does, which no sensor can: by how much it is
/// early beyond chance.
[[nodiscard]] bool is_early(const DelayReport& report, const TimeOrder& order);

/// Whether a control seems to be recorded too early, by more than `order.early_s` and chance, but what else moves the
/// vehicle is too much to be sure (DelayFinding::kInDoubt).
[[nodiscard]] bool is_doubtful(const DelayReport& report, const TimeOrder& order);

/// Whether a report is of a channel that moves against what its reference implies.
[[nodiscard]] bool is_opposite(const DelayReport& report);

/// Row Check::kOrderInTime of a report that `is_early`: failed beyond `order.failed_s` and chance, else with care.
[[nodiscard]] estimation::Evidence early_row(const DelayReport& report, const TimeOrder& order);

/// Row Check::kOrderInTime of a report that `is_doubtful`, with care.
[[nodiscard]] estimation::Evidence doubtful_row(const DelayReport& report, const TimeOrder& order);

/// Row Check::kSignAgainstOthers of a report that `is_opposite`, with care.
[[nodiscard]] estimation::Evidence opposite_row(const DelayReport& report);

}  // namespace veridyn::recording
