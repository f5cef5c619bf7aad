#include "veridyn/io/ros/bag_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/ros/bag_database.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/io/ros/ros_log.hpp"

namespace veridyn::io {
namespace internal {
namespace {

bool is_bag_file(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".mcap" || extension == ".db3";
}

/// "drive_10.mcap" after "drive_9.mcap".
bool in_order(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string x = a.filename().string(), y = b.filename().string();
  return x.size() != y.size() ? x.size() < y.size() : x < y;
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (is_bag_file(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files, in_order);
  return files;
}

std::string_view without_quotes(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"'"), end = text.find_last_not_of(" \t\r\"'");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end + 1 - begin);
}

}  // namespace

std::vector<std::string> bag_files(std::string_view metadata) {
  std::vector<std::string> files;
  bool listing = false;
  while (!metadata.empty()) {
    const std::size_t end = std::min(metadata.find('\n'), metadata.size());
    const std::string_view line = metadata.substr(0, end);
    metadata.remove_prefix(std::min(end + 1, metadata.size()));
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) continue;
    const std::string_view item = line.substr(begin);
    if (item.starts_with("relative_file_paths:")) {
      listing = true;
    } else if (listing && item.starts_with("- ")) {
      if (const std::string_view name = without_quotes(item.substr(2)); !name.empty()) files.emplace_back(name);
    } else {
      listing = false;
    }
  }
  return files;
}

}  // namespace internal

bool is_bag_folder(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / "metadata.yaml", error) && !internal::files_in(folder).empty();
}

Log read_bag_folder(const std::filesystem::path& folder) {
  Log log;
  log.source = folder.string();
  log.format = "ROS 2 bag";
  std::vector<std::filesystem::path> files;
  for (const std::string& name : internal::bag_files(MappedFile(folder / "metadata.yaml").bytes())) {
    // Early versions wrote the bag's own folder ahead of the names.
    files.push_back(folder / std::filesystem::path(name).filename());
  }
  if (files.empty()) files = internal::files_in(folder);
  internal::RosLog messages;
  std::size_t read = 0;
  std::optional<InputError> first;
  for (const std::filesystem::path& path : files) {
    try {
      const MappedFile file(path);
      if (is_mcap(file.bytes())) {
        internal::add_mcap(file.bytes(), messages, log);
      } else if (is_sqlite(file.bytes())) {
        internal::add_bag_database(path, messages, log);
      } else {
        throw InputError(path.string(), path.extension() == ".zstd"
                                            ? "is compressed: unpack it with unzstd"
                                            : "is neither an MCAP recording nor an SQLite database");
      }
      ++read;
    } catch (const InputError& error) {
      if (!first) first = error;
      log.damage.notes.push_back(fmt::format("left out: {}", error.what()));
    }
  }
  if (read == 0) throw first ? *first : InputError(log.source, "holds no files of a bag");
  messages.finish(log);
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
