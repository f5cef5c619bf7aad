#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"

#include <fmt/format.h>

#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"
#include "veridyn/muscle/study/muscle_study_tasks.hpp"
#include "veridyn/muscle/study/muscle_study_unknowns.hpp"

namespace veridyn::muscle {
namespace {

std::size_t count_or(const StudyTable& table, const char* key, std::size_t otherwise, long long least) {
  const long long value = table.integer_or(key, static_cast<long long>(otherwise));
  constexpr long long kMost = 10000000;
  if (value < least || value > kMost) table.fail(key, fmt::format("= {} must be from {} to {}", value, least, kMost));
  return static_cast<std::size_t>(value);
}

double share_or(const StudyTable& table, const char* key, double otherwise, double most) {
  const double value = table.number_or(key, "1", otherwise);
  if (!(value > 0.0 && value <= most))
    table.fail(key, fmt::format("= {:g} must be above 0 and at most {:g}; \"5 %\" is 0.05", value, most));
  return value;
}

SensitivityStudyOptions read_options(const StudyTable& table, std::uint64_t seed) {
  SensitivityStudyOptions o;
  o.sampling.samples = count_or(table, "samples", o.sampling.samples, 1);
  o.sampling.range = share_or(table, "range", o.sampling.range, 0.49);
  o.sampling.scrambled = table.flag_or("scrambled", o.sampling.scrambled);
  o.sampling.accuracy = table.positive_or("accuracy", "1", o.sampling.accuracy);
  if (!(o.sampling.accuracy >= 1e-13 && o.sampling.accuracy <= 0.1))
    table.fail("accuracy", fmt::format("{:g} must be from 1e-13 to 0.1", o.sampling.accuracy));
  o.sampling.seed = seed;
  o.cover.tasks = count_or(table, "choose", o.cover.tasks, 0);
  o.cover.share = share_or(table, "cover_share", o.cover.share, 1.0);
  o.cover.least_nrmse = share_or(table, "least_nrmse", o.cover.least_nrmse, 1.0);
  o.indices = estimation::read_index_options(table, seed);
  return o;
}

}  // namespace

SensitivityStudy read_sensitivity_study(const Study& source, Progress& progress) {
  const StudyTable& root = source.root();
  SensitivityStudy study;
  study.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  study.options = read_options(root.table_or_empty("sensitivity"), study.seed);
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
