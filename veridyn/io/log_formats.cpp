#include "veridyn/io/log_formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/dataflash/dataflash_text.hpp"
#include "veridyn/io/matlab/mat.hpp"
#include "veridyn/io/mavlink/tlog.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/io/packets/packet_log.hpp"
#include "veridyn/io/ros/bag_database.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/io/tables/npz.hpp"
#include "veridyn/io/ulog/ulog.hpp"

namespace veridyn::io {
namespace {

/// A reader that needs nothing but the bytes.
template <Log (*kRead)(std::string_view, std::string)>
Log read_bytes(std::string_view bytes, const std::string& source, const TableOptions&) {
  return kRead(bytes, source);
}

/// A reader of tables.
template <auto kRead>
Log read_table_bytes(std::string_view bytes, const std::string& source, const TableOptions& options) {
  return kRead(bytes, source, options);
}

bool holds_packets(std::string_view bytes) { return packets_in(bytes) != nullptr; }

Log read_packets(std::string_view bytes, const std::string& source, const TableOptions&) {
  const PacketLayout* layout = packets_in(bytes);
  if (layout == nullptr) throw InputError(source, "holds no packets that are known");
  return packet_log(*layout, bytes, source);
}

Log read_bag(const std::filesystem::path& path, const TableOptions&) { return read_bag_database(path); }

bool is_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 4096);
  return std::none_of(start.begin(), start.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\n' && c != '\r' && c != '\t';
  });
}

/// fuzz/CMakeLists.txt reads the keys of these rows.
std::vector<LogFormat> make_log_formats() {
  using enum Recognition;
  return {
      {.key = "dataflash",
       .name = "ArduPilot DataFlash",
       .listed = "ArduPilot DataFlash (.bin, .log)",
       .suffixes = {".bin"},
       .recognition = kContent,
       .is = is_dataflash,
       .read = read_bytes<read_dataflash>},
      {.key = "dataflash_text",
       .name = "ArduPilot DataFlash text",
       .listed = "",
       .suffixes = {".log"},
       .recognition = kContent,
       .is = is_dataflash_text,
       .read = read_bytes<read_dataflash_text>},
      {.key = "ulog",
       .name = "PX4 ULog",
       .listed = "PX4 ULog (.ulg)",
       .suffixes = {".ulg", ".ulog"},
       .recognition = kBeginning,
       .is = is_ulog,
       .read = read_bytes<read_ulog>},
      {.key = "tlog",
       .name = "MAVLink telemetry log",
       .listed = "MAVLink telemetry (.tlog)",
       .suffixes = {".tlog"},
       .recognition = kBeginning,
       .is = is_tlog,
       .read = read_bytes<read_tlog>},
      {.key = "mcap",
       .name = "MCAP",
       .listed = "MCAP (.mcap)",
       .suffixes = {".mcap"},
       .recognition = kBeginning,
       .is = is_mcap,
       .read = read_bytes<read_mcap>},
      {.key = "bag_database",
       .name = "ROS 2 bag",
       .listed = "ROS 2 bags (.db3, or their folder)",
       .suffixes = {".db3"},
       .recognition = kBeginning,
       .is = is_sqlite,
       .read = read_bytes<read_bag_database>,
       .read_file = read_bag},
      {.key = "mat",
       .name = "MATLAB",
       .listed = "MATLAB (.mat)",
       .suffixes = {".mat"},
       .recognition = kBeginning,
       .is = is_mat,
       .read = read_table_bytes<read_mat>,
       .read_file = read_mat_file,
       .table = true},
      {.key = "storage",
       .name = "OpenSim storage",
       .listed = "OpenSim storage (.sto, .mot)",
       .suffixes = {".sto", ".mot"},
       .recognition = kContent,
       .is = is_storage,
       .read = read_bytes<read_storage_log>},
      {.key = "npz",
       .name = "NumPy arrays",
       .listed = "NumPy arrays (.npz, or folders of .npy)",
       .suffixes = {".npz"},
       .recognition = kBeginning,
       .is = is_npz,
       .read = read_table_bytes<read_npz>,
       .table = true},
      {.key = "packet",
       .name = "telemetry packets",
       .listed = "telemetry packets of games",
       .suffixes = {},
       .recognition = kContent,
       .is = holds_packets,
       .read = read_packets},
      {.key = "csv",
       .name = "CSV",
       .listed = "CSV",
       .suffixes = {".csv", ".tsv", ".txt"},
       .recognition = kText,
       .is = is_text,
       .read = read_table_bytes<read_csv>,
       .table = true},
  };
}

}  // namespace

std::span<const LogFormat> log_formats() {
  static const std::vector<LogFormat> formats = make_log_formats();
  return formats;
}

const LogFormat* log_format_of(std::string_view bytes) {
  for (const Recognition turn : {Recognition::kBeginning, Recognition::kContent, Recognition::kText})
    for (const LogFormat& format : log_formats())
      if (format.recognition == turn && format.is(bytes)) return &format;
  return nullptr;
}

const LogFormat* log_format_by_suffix(const std::filesystem::path& path) {
  const std::string suffix = lower(path.extension().string());
  for (const LogFormat& format : log_formats())
    if (std::find(format.suffixes.begin(), format.suffixes.end(), suffix) != format.suffixes.end()) return &format;
  return nullptr;
}

const std::string& list_of_log_formats() {
  static const std::string list = [] {
    std::vector<std::string_view> names;
    for (const LogFormat& format : log_formats())
      if (!format.listed.empty()) names.push_back(format.listed);
    const std::string_view last = names.back();
    names.pop_back();
    return fmt::format("{} and {}", fmt::join(names, ", "), last);
  }();
  return list;
}

}  // namespace veridyn::io
