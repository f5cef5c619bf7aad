#pragma once

#include <filesystem>
#include <optional>

#include "veridyn/core/recording.hpp"
#include "veridyn/io/log/log.hpp"
#include "veridyn/io/packets/packet_layout.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::io {

/// What to do with a file of any format.
struct ReadOptions {
  TableOptions csv;  ///< of tables: CSV, NumPy arrays, arrays of MATLAB files
  RecordingOptions recording;
  std::optional<PacketLayout> packet;  ///< the file holds such packets, one after the other
};

/// Reads a log of any known format: files of the formats in `log_formats.hpp`, bags of ROS 2 as folders, and folders of
/// CSV or of NumPy arrays (`npy.hpp`). The content decides; the name's extension only where the content does not
/// decide, and a name that promises another format than the content is noted in the damage. Where pauses or restarts
/// part it, the parts are noted, and `csv.part` reads one (`choose_part`).
/// @throws InputError when the file is missing, empty, or of no known format.
[[nodiscard]] Log read_log(const std::filesystem::path& path, const ReadOptions& options = {});

/// As `read_log`, turned into channels.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace veridyn::io
