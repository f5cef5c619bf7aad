#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/tables/npy.hpp"

namespace veridyn::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostEntries = 10000;
constexpr int kDeepest = 8;

/// The arrays of one folder: its path below the root, part by part, and file names without their ending.
using Parts = std::vector<std::string>;
using Folders = std::map<Parts, std::set<std::string>>;

Folders find_arrays(const fs::path& root) {
  Folders folders;
  std::error_code error;
  fs::recursive_directory_iterator entries(root, error);
  std::size_t count = 0;
  while (!error && entries != fs::recursive_directory_iterator()) {
    if (++count > kMostEntries || entries.depth() > kDeepest)
      throw InputError(root.string(), fmt::format("holds more than {} files or {} levels of folders: is this a log?",
                                                  kMostEntries, kDeepest));
    const fs::path& path = entries->path();
    std::error_code kind_error;
    if (path.extension() == ".npy" && entries->is_regular_file(kind_error)) {
      Parts parts;
      for (const fs::path& part : path.parent_path().lexically_relative(root)) {
        if (part != ".") parts.push_back(internal::printable(part.string()));
      }
      folders[parts].insert(path.stem().string());
    }
    entries.increment(error);
  }
  if (error) throw InputError(root.string(), "cannot be read: " + error.message());
  return folders;
}

class FolderReader {
 public:
  explicit FolderReader(const fs::path& root) : root_(root), folders_(find_arrays(root)) {}

  Log run() {
    log_.source = root_.string();
    log_.format = "NumPy arrays";
    const std::size_t shared = shared_by_pairs();
    for (const auto& [parts, names] : folders_) {
      std::set<std::string> rest = names;
      if (names.contains("t") && names.contains("value")) {
        rest.erase("t");
        rest.erase("value");
        LogTopic topic;
        topic.name = fmt::format("{}", fmt::join(parts.begin() + signed_index(shared), parts.end(), "."));
        if (topic.name.empty()) topic.name = parts.empty() ? "value" : parts.back();
        const NpyArray times = read(parts, "t");
        add(std::move(topic), times, {{"", read(parts, "value")}}, parts, "t");
      }
      for (const std::string& name : names) {
        constexpr std::string_view kEnding = "_times";
        if (!name.ends_with(kEnding) || !rest.contains(name)) continue;
        take_series(parts, name, name.substr(0, name.size() - kEnding.size() + 1), rest);
      }
      for (const std::string& name : rest) unused_.push_back(path_of(parts, name));
    }
    if (log_.topics.empty())
      throw InputError(log_.source,
                       "is a directory without NumPy arrays that have stamps (t.npy alongside value.npy, or "
                       "NAME_times.npy alongside "
                       "NAME_*.npy); expected such a folder or a file");
    if (!unused_.empty()) {
      const std::size_t shown = std::min<std::size_t>(unused_.size(), 6);
      log_.damage.notes.push_back(fmt::format("{} arrays without stamps were left out: {}{}", unused_.size(),
                                              fmt::join(unused_.begin(), unused_.begin() + signed_index(shown), ", "),
                                              shown < unused_.size() ? ", ..." : ""));
    }
    internal::finish(log_);
    return std::move(log_);
  }

 private:
  struct Series {
    std::string name;
    NpyArray array;
  };

  [[nodiscard]] static std::string path_of(const Parts& parts, const std::string& name) {
    std::string path;
    for (const std::string& part : parts) path += part + "/";
    return path + internal::printable(name) + ".npy";
  }

  [[nodiscard]] NpyArray read(const Parts& parts, const std::string& name) const {
    fs::path path = root_;
    for (const std::string& part : parts) path /= part;
    path /= name + ".npy";
    const MappedFile file(path);
    return read_npy(file.bytes(), path.string());
  }

  /// How many leading folders all pairs of t and value have in common, without the last.
  [[nodiscard]] std::size_t shared_by_pairs() const {
    const Parts* first = nullptr;
    std::size_t shared = 0;
    for (const auto& [parts, names] : folders_) {
      if (!names.contains("t") || !names.contains("value")) continue;
      if (first == nullptr) {
        first = &parts;
        shared = parts.empty() ? 0 : parts.size() - 1;
        continue;
      }
      std::size_t same = 0;
      while (same < shared && same < parts.size() && parts[same] == (*first)[same]) ++same;
      shared = same;
    }
    return shared;
  }

  void take_series(const Parts& parts, const std::string& stamps, const std::string& prefix,
                   std::set<std::string>& rest) {
    const NpyArray times = read(parts, stamps);
    if (times.shape.size() != 1) return;
    std::vector<Series> series;
    for (const std::string& name : std::set<std::string>(rest)) {
      if (name == stamps || !name.starts_with(prefix)) continue;
      NpyArray array = read(parts, name);
      if (array.rows() != times.rows()) continue;
      series.push_back({internal::printable(name), std::move(array)});
      rest.erase(name);
    }
    rest.erase(stamps);
    if (series.empty()) return;
    LogTopic topic;
    topic.name = fmt::format("{}", fmt::join(parts, "."));
    add(std::move(topic), times, std::move(series), parts, stamps);
  }

  void add(LogTopic topic, const NpyArray& times, std::vector<Series> series, const Parts& parts,
           const std::string& stamps_name) {
    const bool vector = times.shape.size() == 1 || times.columns.size() == 1;
    if (!vector) throw InputError(path_of(parts, stamps_name), "stamps must be a vector");
    for (const Series& one : series) {
      if (one.array.rows() != times.rows())
        throw InputError(root_.string(), fmt::format("{} has {} stamps for {} rows of values",
                                                     path_of(parts, stamps_name), times.rows(), one.array.rows()));
    }
    if (times.rows() == 0) {
      unused_.push_back(path_of(parts, stamps_name));
      return;
    }
    OrderedStamps ordered = order_stamps(times.columns.front().numbers());
    const bool all = ordered.row.empty() && !ordered.time.empty();
    for (Series& one : series) {
      const std::size_t count = one.array.columns.size();
      for (std::size_t c = 0; c < count; ++c) {
        LogField field;
        field.name = count > 1 ? fmt::format("{}[{}]", one.name, c) : one.name;
        Column& column = one.array.columns[c];
        field.values = all ? std::move(column) : column.picked(ordered.row);
        topic.fields.push_back(std::move(field));
      }
    }
    topic.spikes = ordered.spikes;
    topic.reordered = ordered.reordered;
    topic.doubled = ordered.doubled;
    topic.time = make_time_base(std::move(ordered.time));
    log_.topics.push_back(std::move(topic));
  }

  fs::path root_;
  Folders folders_;
  Log log_;
  std::vector<std::string> unused_;
};

}  // namespace

Log read_npy_folder(const fs::path& folder) { return FolderReader(folder).run(); }

}  // namespace veridyn::io
