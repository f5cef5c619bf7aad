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

  [[nodiscard]] static const KeyTable<SimulatedPerson>& keys();
};

/// `[identify]` of a muscle study as it is written.
struct MuscleIdentifyTable {
  bool published = false;  ///< the route
  double tolerance = PublishedRouteOptions{}.tolerance;
  std::size_t evaluations = 20000;
  std::filesystem::path log;
  double bounds = 0.2;
  TaskEstimateOptions search;
  std::optional<bool> advice, estimate_start;

  [[nodiscard]] static const KeyTable<MuscleIdentifyTable>& keys();
};
/// `[identify.posterior]`.
[[nodiscard]] const KeyTable<estimation::EnsembleOptions>& posterior_keys();

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
/// `[[parameter]]` and `[[output]]` as `read_unknowns` and `read_outputs`, `[person]` and `[identify]`.
///
/// Without `[[parameter]]`: max_isometric_force, optimal_fiber_length and tendon_slack_length of every muscle; with
/// `[emg]` excitation_gain of every muscle, within 50 %. Without `[[output]]`: the values of all coordinates that move
/// in some task; with `[emg]` their moments. `[motion]`, of `veridyn simulate`, may stay in the study.
/// @throws InputError with file, line and key.
[[nodiscard]] TaskStudy read_task_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
