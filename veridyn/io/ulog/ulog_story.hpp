#pragma once

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Adds the events of a ULog's topic vehicle_status: changes of flight mode and arming.
void read_ulog_events(Log& log);

}  // namespace veridyn::io
