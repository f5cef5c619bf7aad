#pragma once

/// The motion of a vehicle on a motion platform, and what its driver feels.
///
///     cueing::read_study(study, progress)         // read: platform, algorithms, a recorded or simulated drive
///     cueing::cue(drive, progress)                // all algorithms on the drive: motion of the platform, scores
///     cueing::difference(a, b, ...)               // of two scores, with its interval
///     cueing::built_in_platform("three_axis")     // or Platform::read
///     cueing::CueingChain                         // algorithm, guard and platform, one sample at a time
///
/// Component `cueing`.

#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"
#include "veridyn/cueing/score/cueing_score.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"
#include "veridyn/vehicle.hpp"
