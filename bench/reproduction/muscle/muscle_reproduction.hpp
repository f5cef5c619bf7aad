#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "veridyn/core/check_outcome.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/study/task_study.hpp"

namespace veridyn::muscle {

/// One way to find a hidden person, compared with others.
struct ComparedCase {
  std::string name;
  std::vector<int> tasks = {};      ///< of the 42 elbow tasks, to estimate from
  double load = 1.0;                ///< in the hand in these [kg]
  double spread = 0.05;             ///< of the hidden values about the model's
  bool published = false;           ///< by the published search; else least squares with exact sensitivities
  std::size_t evaluations = 20000;  ///< of the published search, at most, each of all tasks
};

/// What a case found of one person.
struct ComparedPerson {
  std::uint64_t seed = 0;           ///< of the hidden values and of the search
  std::string trouble = {};         ///< why there is no estimate; empty: there is one
  double parameter_error = kNaN;    ///< root mean square over the unknowns of (estimate - truth)/truth
  double identified_error = kNaN;   ///< the largest of those that are called identified; NaN: none is
  double trained = kNaN;            ///< NRMSE, mean over the tasks that were estimated from
  double unseen = kNaN;             ///< NRMSE, mean over those held out
  int identified = 0, covered = 0;  ///< unknowns called identified; of these inside their 95 % interval
  int at_bound = 0;
  estimation::SimulationCount simulations = {};
  double seconds = 0.0;  ///< all but the controls of the tasks, on all threads
};

/// What a check looks at: a number of each person.
enum class ComparedQuantity { kParameterError, kIdentifiedError, kTrained, kUnseen, kSimulations, kSeconds };
/// "parameter error", "error of identified parameters", "trained NRMSE", "unseen NRMSE", "simulations", "seconds".
[[nodiscard]] std::string_view to_string(ComparedQuantity quantity);
/// Simulations with and without derivatives count as one each.
[[nodiscard]] double value_of(const ComparedPerson& person, ComparedQuantity quantity);

/// A case with all its persons.
struct ComparedOutcome {
  ComparedCase setting;
  std::vector<ComparedPerson> persons;

  /// Of those that have an estimate; NaN where none has.
  [[nodiscard]] double median(ComparedQuantity quantity) const;
  [[nodiscard]] double largest(ComparedQuantity quantity) const;
};

/// A published result and ours: one row of `veridyn reproduce muscle`, described by one study
/// (examples/reproduce/muscle): that of `veridyn identify` for a simulated person, whose held-out tasks are the unseen
/// ones of every case, and
///
///     finding = "what was published, in words"
///     conditions = "why these tasks, noise and bounds"
///     [compare]
///     persons = 3                     # hidden persons, with seeds from the study's on
///     [[case]]                        # ways to find them
///     name = "four tasks"
///     numbers = [8, 12, 29, 33]       # tasks.numbers when left out
///     load = "1 kg"                   # tasks.load when left out
///     spread = "20 %"                 # person.spread when left out
///     route = "published"             # "gradient" when left out
///     evaluations = 20000             # published: at most
///     [[expect]]                      # what must come out
///     quantity = "unseen NRMSE"       # see `ComparedQuantity`
///     case = "four tasks"
///     statistic = "median"            # over the persons; or "largest"
///     below = 1e-3                    # and/or, in comparison with another case,
///     than = "one task"
///     lessened_by = "90 %"            # at least
///     published = "-97.9 %"           # printed alongside
///     [[expect]]
///     covered = ["four tasks"]        # 90 to 98 % of all identified unknowns of these cases inside their 95 %
///     intervals
struct MuscleReproduction {
  std::string title;
  std::string finding;
  std::string conditions;
  TaskStudy study;
  std::vector<ComparedOutcome> cases;
  std::vector<CheckOutcome> checks;
  bool interrupted = false;

  /// All checks.
  [[nodiscard]] bool passed() const;
};

/// Reads the study, estimates every person in every case, checks what is expected.
/// @throws InputError naming file, line and key.
[[nodiscard]] MuscleReproduction reproduce_muscle(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
