#include "apps/veridyn/run/version.hpp"

namespace veridyn::app {

// VERIDYN_VERSION is defined for this source alone, so that a new version compiles one file again.
std::string_view version() { return VERIDYN_VERSION; }

std::string program_name() { return "veridyn " + std::string(version()); }

}  // namespace veridyn::app
