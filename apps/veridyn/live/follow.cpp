// Following a recording while it is being written, for `veridyn track --live` of every domain.
#include "apps/veridyn/live/follow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Bytes of all files of the recording; 0 while one is missing.
std::uintmax_t size_of(const std::vector<std::filesystem::path>& files) {
  std::uintmax_t sum = 0;
  for (const auto& file : files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) return 0;
    sum += size;
  }
  return sum;
}

}  // namespace

FollowOptions FollowOptions::of(const Arguments& arguments) {
  return {.idle_s = arguments.number("--idle"), .interval_s = arguments.number("--interval")};
}

std::vector<std::filesystem::path> followed_files(const StudyTable& root) {
  if (!root.has("data")) root.fail("data", "is missing: --live follows the recording that it names");
  const StudyTable data = root.table("data");
  for (const char* key : {"runs", "run", "holdout_runs"})
    if (data.has(key)) data.fail(key, "is for several recordings; --live follows one: data.file = \"flight.csv\"");
  return data.files(data.has("file") ? "file" : "files");
}

void follow_files(const std::vector<std::filesystem::path>& files, const FollowOptions& follow,
                  const CommonOptions& options, const std::function<void(bool finished)>& advance) {
  std::uintmax_t seen = 0;
  std::string obstacle;
  double pause_s = follow.interval_s;
  Clock::time_point grown = Clock::now();
  print_line(options, fmt::format("following {}; ends {:g} s after the last new data, or with Ctrl-C",
                                  files.front().string(), follow.idle_s));
  while (true) {
    const bool stop = options.interruption.requested();
    const std::uintmax_t size = size_of(files);
    const bool news = size != seen;
    if (news) grown = Clock::now();
    const bool finished = stop || (!news && Clock::now() - grown > std::chrono::duration<double>(follow.idle_s));
    if (news || finished) {
      seen = size;
      const Clock::time_point begun = Clock::now();
      try {
        advance(finished);
        obstacle.clear();
      } catch (const InputError& error) {
        // The head of a log may hold too little yet; what is wrong for good is still wrong at the end.
        if (finished) throw;
        if (obstacle != error.what()) print_line(options, fmt::format("waiting: {}", error.what()));
        obstacle = error.what();
      }
      // A long log takes longer to read: never more than a third of the time.
      const double took = std::chrono::duration<double>(Clock::now() - begun).count();
      pause_s = std::max(follow.interval_s, 2.0 * took);
    }
    if (finished) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(news ? pause_s : std::min(pause_s, 0.2)));
  }
}

}  // namespace veridyn::app
