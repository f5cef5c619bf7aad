#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "apps/veridyn/run/command.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::app {

/// How a recording that is still being written is followed.
struct FollowOptions {
  double idle_s = 15.0;     ///< --idle: end this long after the last new data
  double interval_s = 1.0;  ///< --interval: look for new data this often

  [[nodiscard]] static FollowOptions of(const Arguments& arguments);
};

/// Calls `advance(finished)` whenever the files have grown, and a last time with true when nothing came for long or
/// Ctrl-C was pressed. What `advance` cannot read yet (InputError) is printed and tried again; at the end it is thrown.
void follow_files(const std::vector<std::filesystem::path>& files, const FollowOptions& follow,
                  const CommonOptions& options, const std::function<void(bool finished)>& advance);

/// The files that `[data]` of a study names. @throws InputError when there is no such table.
[[nodiscard]] std::vector<std::filesystem::path> followed_files(const StudyTable& root);

}  // namespace veridyn::app
