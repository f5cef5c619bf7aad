#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/uncertainty/ensemble_sampler.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"
#include "veridyn/muscle/identification/published_route.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"
#include "veridyn/muscle/study/muscle_study_tasks.hpp"
#include "veridyn/muscle/study/muscle_subject.hpp"

namespace veridyn::muscle {

/// A person whose recording is simulated, to see what a study would find: what is hidden is known.
struct SimulatedPerson {
  double spread = 0.05;  ///< hidden parameters: the model's times 1 +- at most this, uniform
  std::map<std::string, double, std::less<>> values;  ///< unknowns that are set instead, by name
  bool millard = false;  ///< with the muscles of Millard et al. in place of the model's: a model that is wrong
  /// With another model's bodies, joints and paths, with the same coordinates and muscles: geometry that is wrong.
  std::shared_ptr<const MusculoskeletalSystem> body = {};
  double load_factor = 1.0;           ///< the loads of the tasks are this much heavier than the study says
  double noise = 1e-3;                ///< standard deviation of measured angles and positions [rad or m]
  double noise_correlation_s = 0.0;   ///< of that noise, first order: exp(-dt/this) from sample to sample; 0: white
  double moment_noise = 0.1;          ///< of measured moments and forces that `[[output]]` says no other of [N m or N]
  std::optional<double> emg_noise{};  ///< of the EMG's value; else as the study's `[emg]` says
};

/// A study that estimates a person's muscles from tasks, read and checked.
struct TaskStudy {
  MuscleSubject subject;
  std::vector<Task> tasks;
  double accuracy = 1e-6;
  std::vector<MuscleUnknown> unknowns;  ///< each with a prior: its own, or that of its bounds
  std::vector<MuscleOutput> outputs;
  std::optional<EmgSettings> emg;  ///< muscles along recorded angles; else tasks are simulated forward
  std::optional<SimulatedPerson> person;
  std::optional<PublishedRouteOptions> published;  ///< the published search in place of `search`
  TaskEstimateOptions search;
  std::optional<ElbowTaskOptions> elbow;  ///< as `StudyTasks`
  bool advice = false;                    ///< say which further elbow task would lessen the widest interval most
  std::vector<std::string> profiles;      ///< parameters whose profile likelihood is followed
  std::optional<estimation::EnsembleOptions> posterior;  ///< sample it
  bool estimate_start = false;                           ///< pose and speed where each task begins are unknown too
  std::uint64_t seed = 1;
  std::vector<std::string> notes;
  std::vector<std::filesystem::path> inputs;
};

/// Whether a muscle study has tasks.
[[nodiscard]] bool has_tasks(const StudyTable& root);

/// Reads a study: `[subject]` as `read_study`, `[emg]` as `read_emg`, `[tasks]` and `[[task]]` as `read_tasks`,
/// `[[parameter]]` and
/// `[[output]]` as `read_unknowns` and `read_outputs`, and
///
///     seed = 1
///     [person]                       # simulated: its motions are what a recording would be
///     spread = "5 %"                 # hidden parameters, within so much of the model's; drawn by the seed
///     noise = "0.06 deg"             # of the measured angles; of other outputs that of [[output]]
///     noise_correlation = "20 ms"    # correlation time of that noise, first order; 0: white
///     muscles = "millard"            # of another class than the model's, to see what is said of a wrong model
///     model = "turned.osim"          # with the bodies, joints and paths of another model, likewise
///     load_factor = 1.0              # true load over the stated one, likewise
///     moment_noise = "0.1 N m"       # with [emg]: of the measured moments, unless [[output]] says it
///     emg_noise = "20 %"             # with [emg]: of the EMG, where the study says otherwise in [emg]
///     [person.parameters]            # hidden values of single unknowns, by the unknown's name
///     "BRA.max_isometric_force" = 1000
///     [identify]
///     route = "gradient"             # least squares with exact sensitivities; "published": particle swarm until every
///                                    # task holds the tolerance, then pattern search, values only
///     tolerance = "1 %"              # published: greatest NRMSE of a task
///     evaluations = 20000            # published: at most, each of all tasks
///     log = "search.csv"             # published: every evaluation; a log that is there is continued
///     bounds = "20 %"                # of the unknowns where the study has no [[parameter]]
///     starts = 3                     # gradient: searches
///     screened = 16                  # points whose fit is looked at to choose where they begin
///     advice = true                  # which further elbow task would lessen the widest interval most; false when left
///                                    # out where controls are recorded: those of a task to come are not known
///     profiles = ["BRA.tendon_slack_length"]  # profile likelihood of these; true: of all that are not fixed
///     posterior = true               # draws of the posterior by an ensemble of walkers; or a table with its options:
///     # posterior = { walkers = 40, steps = 4000, effective = 1000 }
///     estimate_start = true          # pose and speed at the beginning too; true when left out with recordings
///
/// Without `[[parameter]]`: max_isometric_force, optimal_fiber_length and tendon_slack_length of every muscle; with
/// `[emg]` excitation_gain of every muscle, within 50 %. Without `[[output]]`: the values of all coordinates that move
/// in some task; with `[emg]` their moments. `[motion]`, of `veridyn simulate`, may stay in the study.
/// @throws InputError with file, line and key.
[[nodiscard]] TaskStudy read_task_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
