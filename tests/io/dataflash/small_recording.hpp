#pragma once

#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"

namespace veridyn::testing {

/// The small log as a recording.
inline Recording small_dataflash_recording() {
  return io::to_recording(io::read_dataflash(small_dataflash(), "small.bin"));
}

}  // namespace veridyn::testing
