#include "veridyn/io/tables/csv_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::io {
namespace {

/// Begins of PX4's topics.
constexpr std::array<std::string_view, 14> kTopics = {
    "vehicle_", "sensor_", "actuator_", "estimator_", "battery_",   "airspeed", "differential_pressure",
    "input_rc", "manual_", "position_", "mission",    "telemetry_", "cpuload",  "commander_state"};

std::size_t topic_begin(std::string_view stem) {
  std::size_t begin = std::string_view::npos;
  for (const std::string_view topic : kTopics) {
    const std::size_t found = stem.find(topic);
    if (found != std::string_view::npos && (found == 0 || stem[found - 1] == '_')) begin = std::min(begin, found);
  }
  return begin;
}

std::vector<std::filesystem::path> tables_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_regular_file(error) && lower(entry.path().extension().string()) == ".csv")
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// A table of the folder as it was read.
struct FolderTable {
  std::filesystem::path path;
  std::string name;
  Log log;
};

/// Where clocks restart, leaves the same part of every table: the one that is asked for, or the longest of the largest
/// table. Tables that do not have as many parts as that are left out: which part they are of is not known.
void read_one_part(std::vector<FolderTable>& tables, const TableOptions& options, Log& whole) {
  const auto rows = [](const FolderTable& t) { return t.log.parts > 0 ? t.log.topics.front().size() : 0; };
  const auto largest = std::ranges::max_element(tables, {}, rows);
  if (largest == tables.end() || rows(*largest) == 0) return;
  whole.part = largest->log.part;
  whole.parts = largest->log.parts;
  TableOptions same = options;
  same.part = whole.part;
  std::erase_if(tables, [&](const FolderTable& t) {
    if (t.log.parts == whole.parts) return false;
    whole.damage.notes.push_back(
        t.log.parts == 0 ? fmt::format("left out: {}: its clock does not restart as those of the other tables do; "
                                       "which of their {} parts it is of is not known",
                                       t.path.string(), whole.parts)
                         : fmt::format("left out: {}: has {} parts, other tables have {}", t.path.string(), t.log.parts,
                                       whole.parts));
    return true;
  });
  for (FolderTable& t : tables)
    if (t.log.part != whole.part) t.log = read_csv_file(t.path, same);
}

}  // namespace

std::string table_name(const std::filesystem::path& path, const std::string& prefix) {
  std::string stem = path.stem().string();
  if (!prefix.empty() && stem.starts_with(prefix)) stem.erase(0, prefix.size());
  const std::size_t underscore = stem.rfind('_');
  if (underscore == std::string::npos || underscore + 2 != stem.size()) return stem;
  const char digit = stem.back();
  if (digit < '0' || digit > '9') return stem;
  std::string topic = stem.substr(0, underscore);
  return digit == '0' ? topic : fmt::format("{}[{}]", topic, digit);
}

std::string log_prefix(std::span<const std::filesystem::path> paths) {
  std::string prefix;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string stem = paths[i].stem().string();
    if (i == 0) {
      const std::size_t begin = topic_begin(stem);
      if (begin == 0 || begin == std::string::npos) {
        // A topic that is not known here, or no prefix: another table tells, if any does.
        prefix = stem;
        continue;
      }
      prefix = stem.substr(0, begin);
      continue;
    }
    const auto differ = std::mismatch(prefix.begin(), prefix.end(), stem.begin(), stem.end()).first;
    prefix.erase(differ, prefix.end());
  }
  const bool known = std::any_of(paths.begin(), paths.end(), [&](const std::filesystem::path& path) {
    const std::size_t begin = topic_begin(path.stem().string());
    return begin != std::string::npos && begin > 0 && begin <= prefix.size();
  });
  if (!known) return {};
  for (const std::filesystem::path& path : paths)
    if (const std::size_t begin = topic_begin(path.stem().string()); begin != std::string::npos)
      prefix.resize(std::min(prefix.size(), begin));
  return prefix;
}

bool is_csv_folder(const std::filesystem::path& folder) { return !tables_in(folder).empty(); }

Log read_csv_folder(const std::filesystem::path& folder, const TableOptions& options) {
  const std::vector<std::filesystem::path> paths = tables_in(folder);
  const std::string prefix = log_prefix(paths);
  Log whole;
  whole.source = folder.string();
  whole.format = "folder of CSV";
  std::string first_refusal;
  std::vector<FolderTable> tables;
  for (const std::filesystem::path& path : paths) {
    try {
      tables.push_back({path, table_name(path, prefix), read_csv_file(path, options)});
    } catch (const InputError& refusal) {
      if (first_refusal.empty()) first_refusal = refusal.what();
      whole.damage.notes.push_back(fmt::format("left out: {}", refusal.what()));
    }
  }
  read_one_part(tables, options, whole);
  for (FolderTable& table : tables) {
    Log& part = table.log;
    if (whole.frame == Frame::kUnspecified) whole.frame = part.frame;
    for (LogTopic& topic : part.topics) {
      topic.name = table.name;
      whole.topics.push_back(std::move(topic));
    }
    for (const auto& [key, value] : part.information)
      whole.information.emplace(fmt::format("{}: {}", table.name, key), value);
    whole.damage.records_lost += part.damage.records_lost;
    for (const std::string& note : part.damage.notes)
      whole.damage.notes.push_back(fmt::format("{}: {}", table.name, note));
  }
  if (whole.topics.empty())
    throw InputError(whole.source, fmt::format("holds no table of a recording: {}", first_refusal));
  internal::finish(whole);
  return whole;
}

}  // namespace veridyn::io
