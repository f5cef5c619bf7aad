#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "veridyn/live/page/live_page.hpp"

namespace veridyn::live {

/// A run as a page shows it.
struct ShownRun {
  std::string name = {};     ///< of its recording; empty: the run is the program's own
  std::string status = {};   ///< `status_json`; empty: nothing is known of it yet
  std::string trouble = {};  ///< why it cannot be shown any further
  double length = 0.0;       ///< of what is recorded [s]
  bool grows = true;         ///< it goes on
  bool kept = false;         ///< earlier statuses can be asked for
};

/// All that a page shows, in one line.
/// @param work each an object in JSON: other work that goes on beside the runs @param refused controls of the page
[[nodiscard]] std::string page_json(std::span<const ShownRun> runs, std::span<const std::string> work,
                                    PageControls controls, std::uint64_t refused);

}  // namespace veridyn::live
