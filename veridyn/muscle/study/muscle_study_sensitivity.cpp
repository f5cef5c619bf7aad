#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"

#include <fmt/format.h>

#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"
#include "veridyn/muscle/study/muscle_study_tasks.hpp"
#include "veridyn/muscle/study/muscle_study_unknowns.hpp"

namespace veridyn::muscle {

const KeyTable<SensitivityStudyOptions>& sensitivity_keys() {
  constexpr long long kMaxSamples = 10000000;
  using Sampling = MuscleSamplingOptions;
  using Cover = CoverOptions;
  static const auto sampling =
      KeyTable<Sampling>("sensitivity")
          .count("samples", &Sampling::samples, 1, kMaxSamples,
                 "points of the Sobol sequence for each muscle, a power of two uses it best")
          .number("range", &Sampling::range, "1", share_up_to(0.49), "share by which F0, L0 and LS go up and down")
          .flag("scrambled", &Sampling::scrambled,
                "random digital shift of the sequence, from `seed`; `false`: as it is, as published")
          .number("accuracy", &Sampling::accuracy, "1", internal::kAccuracies, "of the simulations");
  static const auto cover =
      KeyTable<Cover>("sensitivity")
          .count("choose", &Cover::tasks, 0, kMaxSamples, "tasks; 0: as few as excite every muscle")
          .number("cover_share", &Cover::share, "1", share_up_to(1.0),
                  "a task excites a muscle with this share of the greatest NRMSE that any task has of it")
          .number("least_nrmse", &Cover::least_nrmse, "1", share_up_to(1.0),
                  "below it in every task a muscle counts as excited by none");
  static const auto table = KeyTable<SensitivityStudyOptions>("sensitivity", "Which muscle moves which task.")
                                .with(&SensitivityStudyOptions::sampling, sampling)
                                .with(&SensitivityStudyOptions::cover, cover);
  return table;
}

SensitivityStudy read_sensitivity_study(const Study& source, Progress& progress) {
  const StudyTable& root = source.root();
  SensitivityStudy study;
  study.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  const StudyTable table = root.table_or_empty("sensitivity");
  study.options = sensitivity_keys().read(table);
  study.options.sampling.seed = study.seed;
  study.options.indices = estimation::read_index_options(table, study.seed);
  study.subject = internal::read_subject(root, progress);
  study.title = study.subject.title;
  const Model& model = study.subject.system->model();
  if (study.subject.system->path_source() == PathSource::kAsOpenSim)
    root.table("subject").fail("paths", "= \"opensim\" is for comparisons only; take \"exact\" or \"fitted\"");
  study.options.inputs = read_unknowns(root, model);
  StudyTasks read = read_tasks(root, study.subject, read_outputs(root, model));
  study.notes = std::move(read.notes);
  for (Task& task : read.tasks) {
    if (task.hold_out) {
      study.notes.push_back(fmt::format("held out for validation: {}", task.name));
    } else {
      study.tasks.push_back(std::move(task));
    }
  }
  study.inputs = study.subject.inputs;
  study.inputs.insert(study.inputs.end(), read.inputs.begin(), read.inputs.end());
  for (const char* other : {"motion", "identify", "person", "validate", "emg"}) root.accept(other);
  root.finish();
  return study;
}

}  // namespace veridyn::muscle
