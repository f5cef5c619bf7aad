#include "veridyn/muscle/muscle_keys.hpp"

#include "veridyn/muscle/study/motion_table.hpp"
#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"
#include "veridyn/muscle/study/muscle_study_unknowns.hpp"
#include "veridyn/muscle/study/task_study.hpp"

namespace veridyn::muscle {

std::vector<StudyKeys> study_keys() {
  return all_of(internal::subject_keys(), internal::load_keys(), MotionTable::keys(), internal::ramp_keys(),
                internal::external_load_keys(), TasksTable::keys(), TaskTable::keys(), EmgSettings::keys(),
                parameter_keys(), output_keys(), SimulatedPerson::keys(), MuscleIdentifyTable::keys(), posterior_keys(),
                sensitivity_keys());
}

}  // namespace veridyn::muscle
