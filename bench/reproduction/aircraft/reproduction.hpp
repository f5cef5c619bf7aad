#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/reproduction/aircraft/batch_experiment.hpp"
#include "bench/reproduction/aircraft/tracking_experiment.hpp"
#include "veridyn/core/check_outcome.hpp"

namespace veridyn::aircraft {

/// A published result and ours: one row of `veridyn reproduce aircraft`, described by a separate study
/// (examples/reproduce/aircraft). In addition to `[subject]`, `[flight]` and `[experiment]` the study holds
///
///     title = "CY, OLS, exact regressors"
///     finding = "what was published, in words"
///     conditions = "why this noise, excitation and duration"
///     [published.OLS]            # published estimates by method and parameter
///     CY_beta = -0.9804
///     [experiment]               # see ExperimentOptions, and
///     methods = ["OLS", "GTLS"]  # batch: these methods once a seed
///     [[experiment.tracker]]     # or recursive: see read_trackers
///     [expect]                   # what must be seen; every key is optional
///     unbiased = "OLS"           # mean over the seeds within 0.1 of an estimate's scatter of the truth, and within 1
///     %
///                                # where the truth is larger than ten times the scatter
///     covers = "OLS"             # 95 % intervals hold the truth in 93 to 97 % of the seeds, every parameter
///     biased = "OLS"             # some mean is off by more than three times the scatter
///     output_error_below = { GTLS = 0.02 }     # largest over rows and seeds; see BatchStatistics::output_error
///     output_error_above = { OLS = 0.10 }
///     never_settles = ["OLS"]    # trackers; see TrackingRun::settling_s
///     settles = ["PCA-GTLS"]
///     settles_when_excited = "PCA-GTLS"        # in every repetition first every direction is excited, then the
///                                # estimate settles: the other order fails
///     known_when_excited = "PCA-GTLS"          # the same of the time from which it is known, see TrackingRun::known_s
///     settles_last = ["variable"]              # settles in the last phase, in every repetition
///     loses = { tracker = "GTLS", from = "350 s", to = "480 s" }  # is far off at some time in between: some
///                                # parameter's error moves the coefficient by more than half of its deviation
///     faster = { tracker = "variable", than = "constant", factor = 5 }  # median settling after the first change
///     no_false_alarm = ["variable"]            # neither detector nor forgetting before the first change
///     false_alarm_rate = ["variable"]          # no more than the stated rate explains (95 %), in at least as many
///                                # hours as no alarm at all would take to show it: three times its interval
///     detects = ["variable"]     # every change within `detection_window`, in every repetition
///     detection_window = "30 s"
///     holds = { tracker = "PCA-GTLS", from = "50 s", to = "300 s" }   # no parameter's error moves the coefficient by
///                                # more than 5 % of its deviation in 90 % of that time, though a direction was
///                                unexcited # in more than a tenth of it
///     cut_off = { tracker = "constant", seconds = 99.8 }      # time to 5 % weight, printed to a tenth of a second
struct Reproduction {
  std::string title;
  std::string finding;
  std::string conditions;
  std::map<std::string, std::map<std::string, double>> published;
  ExperimentOptions options;
  std::optional<BatchExperiment> batch;
  std::optional<TrackingExperiment> tracking;
  std::vector<CheckOutcome> checks;
  bool interrupted = false;

  [[nodiscard]] bool passed() const;
};

/// Reads the study, runs its experiment and checks what it expects.
/// @throws InputError naming file, line and key.
[[nodiscard]] Reproduction reproduce(const StudyTable& root, Progress& progress);

}  // namespace veridyn::aircraft
