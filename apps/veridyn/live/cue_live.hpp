#pragma once

#include "apps/veridyn/run/domains.hpp"

namespace veridyn::app {

/// `veridyn cue STUDY --live`: runs the rig until Ctrl-C or --seconds, records it, and reports.
int cue_live(const StudyRun& run);

/// `veridyn cue --replay RUN.vlr`: the same report of a recorded run, whose orders are computed again and compared.
int cue_replay(const Arguments& arguments);

}  // namespace veridyn::app
