#pragma once

/// A motion platform behind a vehicle as it drives: packets in, orders out.
///
///     live::read_live_study(study)                // read: where packets come from, the platform, the algorithm
///     live::LiveRig                               // packets, requests and times in, orders out: deterministic
///     live::LiveLoop                              // calls it at an even rate, between UdpLinks (sockets)
///     live::SignChecker                           // are the telemetry's axes, signs and units right?
///     live::LiveRecorder, live::read_live_file    // the recording of a run
///     live::replay(file, ...)                     // the same run again, bit for bit
///     live::VirtualVehicle, VirtualPlatform       // both ends without hardware
///
/// `UdpLinks` needs a library that was built with sockets; other `LiveLinks` are yours to write. Component `live`.

#include "veridyn/cueing.hpp"
#include "veridyn/live/recording/live_file.hpp"
#include "veridyn/live/recording/live_recorder.hpp"
#include "veridyn/live/rig/live_loop.hpp"
#include "veridyn/live/rig/live_replay.hpp"
#include "veridyn/live/rig/live_rig.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/rig/running_loop.hpp"
#include "veridyn/live/rig/udp_links.hpp"
#include "veridyn/live/telemetry/sign_checker.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"
