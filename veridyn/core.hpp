#pragma once

/// What every domain shares: studies, recordings, errors with their place, progress.
///
///     const Study study = Study::load("study.toml");       // or Study::parse(text, name)
///     Progress silent;                                     // TerminalProgress shows a bar
///     Recording recording;                                 // named channels, each with unit and time base
///     recording.add(make_channel("airspeed", "m/s", make_time_base({0.0, 0.1}), {15.0, 15.5}));
///
/// Numbers are SI and radians. What is wrong with an input is an InputError, which names file, line and key.
/// Component `core`.

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/units.hpp"
