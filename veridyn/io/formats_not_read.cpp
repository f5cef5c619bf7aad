#include "veridyn/io/formats_not_read.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/text.hpp"

namespace veridyn::io {
namespace {

struct NotRead {
  std::string_view begin;
  std::string_view what;
  std::string_view instead;
};

constexpr NotRead kNotRead[] = {
    {"MDF     ", "an ASAM MDF measurement (.mf4, .mdf)", "export its channels as CSV, for instance with asammdf"},
    {"UnFinMF ", "an unfinished ASAM MDF measurement", "finalise it, and export its channels as CSV"},
    {"LOGG", "a Vector BLF log of a bus", "decode it with its DBC and export the signals as CSV"},
    {"#ROSBAG V", "a bag of ROS 1", "convert it to MCAP (mcap convert) or to a bag of ROS 2 (rosbags-convert)"},
    {"\x28\xb5\x2f\xfd", "compressed by Zstandard", "unpack it (unzstd)"},
    {"PAR1", "a Parquet table", "export it as CSV"},
    {"\x89HDF\r\n\x1a\n", "an HDF5 file without MATLAB's header", "save it by MATLAB as -v7.3, or export it as CSV"},
    {"VERSION \"", "a DBC, which describes the signals of a CAN bus and holds no recording",
     "decode the bus log with it and give the signals as CSV"},
};

/// A line of `candump -L`: "(1436509052.249713) can0 044#2A366C2BBA".
bool is_candump(std::string_view bytes) {
  const std::string_view line = bytes.substr(0, std::min<std::size_t>(bytes.find('\n'), 200));
  const std::size_t close = line.find(") ");
  if (line.empty() || line.front() != '(' || close == std::string_view::npos) return false;
  const std::string_view stamp = line.substr(1, close - 1);
  return stamp.find_first_not_of("0123456789.") == std::string_view::npos && line.find('#', close) != line.npos;
}

/// A Vector ASC log begins with its date and the base of its numbers.
bool is_asc(std::string_view bytes) {
  const std::string start = lower(bytes.substr(0, 300));
  return start.starts_with("date ") && start.find("\nbase ") != std::string::npos;
}

}  // namespace

std::optional<std::string> format_not_read(std::string_view bytes) {
  const auto sentence = [](std::string_view what, std::string_view instead) {
    return fmt::format("is {}, which is not read: {}", what, instead);
  };
  for (const NotRead& known : kNotRead)
    if (bytes.starts_with(known.begin)) return sentence(known.what, known.instead);
  if (is_candump(bytes)) return sentence("a CAN log of candump", "decode it with its DBC and give the signals as CSV");
  if (is_asc(bytes)) return sentence("a Vector ASC log of a bus", "decode it with its DBC and give the signals as CSV");
  if (bytes.starts_with("PK\x03\x04") && bytes.substr(0, 4096).find("[Content_Types].xml") != std::string_view::npos)
    return sentence("an Excel workbook", "save the sheet as CSV");
  return std::nullopt;
}

}  // namespace veridyn::io
