#include "veridyn/io/read.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/io/formats_not_read.hpp"
#include "veridyn/io/log/log_parts.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/log_formats.hpp"
#include "veridyn/io/packets/packet_log.hpp"
#include "veridyn/io/ros/bag_folder.hpp"
#include "veridyn/io/tables/csv_folder.hpp"
#include "veridyn/io/tables/npy.hpp"

namespace veridyn::io {
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
  if (is_npy(bytes))
    throw InputError(path.string(), "is one NumPy array without stamps; give the folder that holds it and its t.npy");
  const LogFormat* expected = log_format_by_suffix(path);
  const LogFormat* format = log_format_of(bytes);
  // One line of text proves no table.
  const bool doubtful = format != nullptr && format->recognition == Recognition::kText && expected != format &&
                        bytes.find('\n') == std::string_view::npos;
  if (format == nullptr || doubtful) {
    const std::string claim =
        expected == nullptr ? "" : fmt::format(" (its name promises {}, its content is not)", expected->name);
    throw InputError(path.string(), fmt::format("not a known log{}; known are {}", claim, list_of_log_formats()));
  }
  Log log = format->read_file != nullptr ? format->read_file(path, options.csv)
                                         : format->read(bytes, path.string(), options.csv);
  if (expected != nullptr && expected != format) {
    log.damage.notes.push_back(
        fmt::format("the name promises {}, the content is {} and was read as such", expected->name, format->name));
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
