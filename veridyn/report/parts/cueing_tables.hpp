#pragma once

#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The correlation of a cue, and where there is none: below all others.
[[nodiscard]] double correlation(const cueing::AlgorithmResult& algorithm, cueing::Cue cue);
/// The algorithm that correlates best in a cue.
[[nodiscard]] const cueing::AlgorithmResult& best_of(const cueing::CueingResult& result, cueing::Cue cue);

/// The score of each algorithm in one cue.
[[nodiscard]] Table score_table(const cueing::CueingResult& result, cueing::Cue cue);
/// Perceived errors of both pairs of axes alongside the least that is possible.
[[nodiscard]] Table perceived_table(const cueing::CueingResult& result);
/// The best algorithm of a cue against each other one, in words.
[[nodiscard]] List differences(const cueing::CueingResult& result);
/// Each algorithm against the first one, in the cues of forces.
[[nodiscard]] Table against_first(const cueing::CueingResult& result);
/// Range, rates and jerk of each axis that moves.
[[nodiscard]] Table workspace_table(const cueing::CueingStudy& study, const cueing::CueingResult& result);
/// The largest false cues of each algorithm.
[[nodiscard]] Table false_cue_table(const cueing::CueingResult& result);
/// How many false cues of each kind there are, and how long they last.
[[nodiscard]] Table false_cue_counts(const cueing::CueingResult& result);
/// What tuning gained, and the knobs that it turned.
[[nodiscard]] Section tuning_section(const cueing::CueingResult& result);

}  // namespace veridyn::report
