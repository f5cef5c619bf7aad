#pragma once

/// Musculoskeletal models: motions, muscle forces, and the parameters of a person's muscles.
///
///     muscle::load_model("arm26.osim")            // read: an OpenSim model, or a built-in one ("arm")
///     muscle::read_study(study, progress)         // a motion and what to compute of it, and
///     muscle::run_study(motion, progress)         // from excitations forward, or which excitations it takes
///     muscle::read_task_study(study, progress)    // a person's recorded tasks, and
///     muscle::identify(tasks, progress)           // muscle parameters with error bars, verdict, evidence
///     muscle::validate(tasks, estimate, progress) // does the estimate predict other tasks?
///     file.write(analysis.identified, "me.osim")  // export; state_storage and control_storage for OpenSim
///
/// Without a study: `MusculoskeletalSystem` is a model made ready, `SystemEvaluator` has the derivatives of its states,
/// `simulate_forward`, `computed_muscle_control`, `optimise_motion` are the methods by themselves. Component `muscle`.

#include "veridyn/io.hpp"
#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/study/identify_muscles.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"
#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"
