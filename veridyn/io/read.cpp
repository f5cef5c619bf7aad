#include "veridyn/io/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/dataflash/dataflash_text.hpp"
#include "veridyn/io/formats_not_read.hpp"
#include "veridyn/io/log/log_parts.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/matlab/mat.hpp"
#include "veridyn/io/mavlink/tlog.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/io/packets/packet_log.hpp"
#include "veridyn/io/ros/bag_database.hpp"
#include "veridyn/io/ros/bag_folder.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/io/tables/csv_folder.hpp"
#include "veridyn/io/tables/npy.hpp"
#include "veridyn/io/tables/npz.hpp"
#include "veridyn/io/ulog/ulog.hpp"

namespace veridyn::io {
namespace {

enum class Format {
  kUnknown,
  kDataFlash,
  kDataFlashText,
  kULog,
  kMat,
  kStorage,
  kNpz,
  kPackets,
  kCsv,
  kTlog,
  kMcap,
  kBag
};

Format by_extension(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".bin") return Format::kDataFlash;
  if (extension == ".log") return Format::kDataFlashText;
  if (extension == ".ulg" || extension == ".ulog") return Format::kULog;
  if (extension == ".tlog") return Format::kTlog;
  if (extension == ".mcap") return Format::kMcap;
  if (extension == ".db3") return Format::kBag;
  if (extension == ".mat") return Format::kMat;
  if (extension == ".npz") return Format::kNpz;
  if (extension == ".sto" || extension == ".mot") return Format::kStorage;
  if (extension == ".csv" || extension == ".tsv" || extension == ".txt") return Format::kCsv;
  return Format::kUnknown;
}

Format by_content(std::string_view bytes) {
  if (is_ulog(bytes)) return Format::kULog;
  if (is_mcap(bytes)) return Format::kMcap;
  if (is_sqlite(bytes)) return Format::kBag;
  if (is_mat(bytes)) return Format::kMat;
  if (is_npz(bytes)) return Format::kNpz;
  if (is_tlog(bytes)) return Format::kTlog;
  if (is_dataflash(bytes)) return Format::kDataFlash;
  if (is_dataflash_text(bytes)) return Format::kDataFlashText;
  if (is_storage(bytes)) return Format::kStorage;
  if (packets_in(bytes) != nullptr) return Format::kPackets;
  return Format::kUnknown;
}

bool is_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 4096);
  return std::none_of(start.begin(), start.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\n' && c != '\r' && c != '\t';
  });
}

const char* name_of(Format format) {
  switch (format) {
    case Format::kDataFlash:
      return "ArduPilot DataFlash";
    case Format::kDataFlashText:
      return "ArduPilot DataFlash text";
    case Format::kULog:
      return "PX4 ULog";
    case Format::kTlog:
      return "MAVLink telemetry log";
    case Format::kMcap:
      return "MCAP";
    case Format::kBag:
      return "ROS 2 bag";
    case Format::kMat:
      return "MATLAB";
    case Format::kStorage:
      return "OpenSim storage";
    case Format::kNpz:
      return "NumPy arrays";
    case Format::kPackets:
      return "telemetry packets";
    case Format::kCsv:
      return "CSV";
    case Format::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace

namespace {

/// All of a file.
Log read_whole(const std::filesystem::path& path, const ReadOptions& options) {
  if (std::error_code error; std::filesystem::is_directory(path, error)) {
    if (is_bag_folder(path)) return read_bag_folder(path);
    return is_csv_folder(path) ? read_csv_folder(path, options.csv) : read_npy_folder(path);
  }
  const MappedFile file(path);
  const std::string_view bytes = file.bytes();
  if (options.packet) return packet_log(*options.packet, bytes, path.string());
  if (const auto known = format_not_read(bytes)) throw InputError(path.string(), *known);
  const Format expected = by_extension(path);
  Format format = by_content(bytes);
  if (is_npy(bytes))
    throw InputError(path.string(), "is one NumPy array without stamps; give the folder that holds it and its t.npy");
  if (format == Format::kUnknown && is_text(bytes)) format = Format::kCsv;
  if (format == Format::kUnknown ||
      (format == Format::kCsv && expected != Format::kCsv && bytes.find('\n') == std::string_view::npos)) {
    const std::string claim = expected == Format::kUnknown
                                  ? ""
                                  : fmt::format(" (its name promises {}, its content is not)", name_of(expected));
    throw InputError(
        path.string(),
        fmt::format("not a known log{}; known are ArduPilot DataFlash (.bin, .log), PX4 ULog (.ulg), MAVLink telemetry "
                    "(.tlog), MCAP (.mcap), ROS 2 bags (.db3, or their folder), MATLAB (.mat), OpenSim storage (.sto, "
                    ".mot), NumPy arrays (.npz, or folders of .npy), "
                    "telemetry packets of games "
                    "and CSV",
                    claim));
  }
  Log log;
  switch (format) {
    case Format::kDataFlash:
      log = read_dataflash(bytes, path.string());
      break;
    case Format::kDataFlashText:
      log = read_dataflash_text(bytes, path.string());
      break;
    case Format::kULog:
      log = read_ulog(bytes, path.string());
      break;
    case Format::kTlog:
      log = read_tlog(bytes, path.string());
      break;
    case Format::kMcap:
      log = read_mcap(bytes, path.string());
      break;
    case Format::kBag:
      log = read_bag_database(path);
      break;
    case Format::kMat:
      log = read_mat_file(path, options.csv);
      break;
    case Format::kStorage:
      log = read_storage_log(bytes, path.string());
      break;
    case Format::kNpz:
      log = read_npz(bytes, path.string(), options.csv);
      break;
    case Format::kPackets:
      log = packet_log(*packets_in(bytes), bytes, path.string());
      break;
    case Format::kCsv:
    case Format::kUnknown:
      log = read_csv(bytes, path.string(), options.csv);
      break;
  }
  if (expected != Format::kUnknown && expected != format) {
    log.damage.notes.push_back(fmt::format("the name promises {}, the content is {} and was read as such",
                                           name_of(expected), name_of(format)));
  }
  return log;
}

}  // namespace

Log read_log(const std::filesystem::path& path, const ReadOptions& options) {
  Log log = read_whole(path, options);
  choose_part(log, options.csv.part);
  return log;
}

Recording read_recording(const std::filesystem::path& path, const ReadOptions& options) {
  return to_recording(read_log(path, options), options.recording);
}

}  // namespace veridyn::io
