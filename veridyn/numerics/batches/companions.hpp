#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string_view>

#include "veridyn/numerics/batches/heartbeat.hpp"
#include "veridyn/numerics/batches/process_share.hpp"

namespace veridyn::numerics {

/// The other processes of a share, which work in the same folder at the same time. Shows them that this one lives
/// (`FOLDER/process-1.alive`), and notices when one of them no longer does. Of a share that waits for nobody: nothing.
/// Not for several threads at once.
class Companions {
 public:
  Companions(std::filesystem::path folder, const ProcessShare& share);

  /// Notes that something of process `owner` (counted from 0) is waited for: `missing`, "5 blocks are missing".
  /// @return for how long it has been waited for without a break [s]; `arrived` ends that
  /// @throws std::runtime_error naming the process when it has shown no life for the share's patience, or was never
  /// seen for five times as long.
  double wait_for(std::size_t owner, std::string_view missing);
  /// What was waited for is there.
  void arrived(std::size_t owner);

 private:
  struct Watch {
    HeartbeatWatch beat;
    std::chrono::steady_clock::time_point since;
  };

  std::filesystem::path folder_;
  ProcessShare share_;
  std::unique_ptr<Heartbeat> heartbeat_;
  std::map<std::size_t, Watch> watches_;  ///< of those that are waited for
};

}  // namespace veridyn::numerics
