#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/synthetic_logs.hpp"

namespace veridyn::testing {

/// Writes what MATLAB writes into level 5 files of objects, as the documents of the project matio (foreverallama,
/// docs/subsystem_data_format.md and field_contents.md) describe it.
class MatObjectWriter {
 public:
  static std::string element(std::uint32_t type, const std::string& data) {
    std::string bytes = pack(type, static_cast<std::uint32_t>(data.size())) + data;
    bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
    return bytes;
  }
  static std::string array(std::uint32_t kind, int rows, int columns, const std::string& content,
                           const std::string& name = "") {
    return element(
        14, element(6, pack(kind, std::uint32_t{0})) + element(5, pack(rows, columns)) + element(1, name) + content);
  }
  static std::string reals(const std::vector<double>& values, int columns = 1) {
    std::string bytes;
    for (const double v : values) bytes += pack(v);
    return array(6, static_cast<int>(values.size()) / columns, columns, element(9, bytes));
  }
  static std::string words(const std::vector<std::uint32_t>& values) {
    std::string bytes;
    for (const std::uint32_t v : values) bytes += pack(v);
    return array(13, static_cast<int>(values.size()), 1, element(6, bytes));
  }
  static std::string text(const std::string& value) {
    return array(4, 1, static_cast<int>(value.size()), element(16, value));
  }
  static std::string cells(const std::vector<std::string>& items) {
    std::string content;
    for (const std::string& item : items) content += item;
    return array(1, 1, static_cast<int>(items.size()), content);
  }
  static std::string fields(const std::vector<std::pair<std::string, std::string>>& items) {
    std::string names, content;
    for (const auto& [name, value] : items) {
      std::string padded = name;
      padded.resize(32, '\0');
      names += padded;
      content += value;
    }
    return array(2, 1, 1, pack(std::uint16_t{5}, std::uint16_t{4}, std::int32_t{32}) + element(1, names) + content);
  }
  static std::string opaque(const std::string& name, const std::string& of_class, const std::string& content) {
    return element(14, element(6, pack(std::uint32_t{17}, std::uint32_t{0})) + element(1, name) + element(1, "MCOS") +
                           element(1, of_class) + content);
  }

  /// Adds an object with its properties, of which `saved` are those that its class saves by `any`; returns what refers
  /// to it.
  std::string add(const std::string& of_class, const std::vector<std::pair<std::string, std::string>>& properties,
                  bool saved = false) {
    std::uint32_t id = 0;
    for (std::size_t i = 0; i < classes_.size(); ++i)
      if (classes_[i] == of_class) id = static_cast<std::uint32_t>(i + 1);
    if (id == 0) {
      classes_.push_back(of_class);
      id = static_cast<std::uint32_t>(classes_.size());
    }
    std::vector<std::uint32_t>& block = saved ? saved_ : usual_;
    std::uint32_t& count = saved ? saved_count_ : usual_count_;
    block.push_back(static_cast<std::uint32_t>(properties.size()));
    for (const auto& [name, value] : properties) {
      block.insert(block.end(), {index(name), 1U, static_cast<std::uint32_t>(contents_.size())});
      contents_.push_back(value);
    }
    if (block.size() % 2 != 0) block.push_back(0);
    ++count;
    objects_.insert(objects_.end(), {id, 0U, 0U, saved ? count : 0U, saved ? 0U : count, 0U});
    return words({0xdd000000U, 2U, 1U, 1U, static_cast<std::uint32_t>(objects_.size() / 6 - 1), id});
  }
  void variable(const std::string& name, const std::string& of_class, const std::string& reference) {
    variables_ += opaque(name, of_class, reference);
  }
  [[nodiscard]] std::string bytes(std::uint32_t version = 4) {
    std::vector<std::uint32_t> classes{0, 0, 0, 0};
    for (const std::string& c : classes_) classes.insert(classes.end(), {0U, index(c), 0U, 0U});
    std::string names;
    for (const std::string& n : names_) names += n + '\0';
    names.resize((names.size() + 7) / 8 * 8, '\0');
    std::string regions, offsets;
    std::size_t at = 40 + names.size();
    for (const auto& region : {classes, saved_, objects_, usual_, std::vector<std::uint32_t>{0, 0}}) {
      offsets += pack(static_cast<std::uint32_t>(at));
      for (const std::uint32_t word : region) regions += pack(word);
      at += 4 * region.size();
    }
    for (int i = 0; i < 3; ++i) offsets += pack(static_cast<std::uint32_t>(at));
    const std::string metadata = pack(version, static_cast<std::uint32_t>(names_.size())) + offsets + names + regions;
    std::vector<std::string> all{array(9, static_cast<int>(metadata.size()), 1, element(2, metadata)), element(14, "")};
    all.insert(all.end(), contents_.begin(), contents_.end());
    for (int i = 0; i < 3; ++i) all.push_back(cells({}));
    std::string subsystem =
        std::string("\0\1IM\0\0\0\0", 8) + fields({{"MCOS", opaque("", "FileWrapper__", cells(all))}});
    std::string file = "MATLAB 5.0 MAT-file, written by a test";
    file.resize(116, ' ');
    file += pack(static_cast<std::uint64_t>(128 + variables_.size())) + std::string("\0\1IM", 4);
    return file + variables_ + array(9, 1, static_cast<int>(subsystem.size()), element(2, subsystem));
  }

 private:
  std::uint32_t index(const std::string& name) {
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (names_[i] == name) return static_cast<std::uint32_t>(i + 1);
    names_.push_back(name);
    return static_cast<std::uint32_t>(names_.size());
  }

  std::vector<std::string> names_, classes_, contents_;
  std::vector<std::uint32_t> objects_{0, 0, 0, 0, 0, 0}, saved_{0, 0}, usual_{0, 0};
  std::uint32_t saved_count_ = 0, usual_count_ = 0;
  std::string variables_;
};

inline std::string mat_duration(MatObjectWriter& file, const std::vector<double>& ms) {
  return file.add("duration", {{"millis", MatObjectWriter::reals(ms)}, {"fmt", MatObjectWriter::text("s")}});
}

inline std::vector<std::pair<std::string, std::string>> timetable_fields(const std::string& times, double rows) {
  return {{"data",
           MatObjectWriter::cells({MatObjectWriter::reals({1, 2, 3}), MatObjectWriter::reals({1, 2, 3, 10, 20, 30}, 2),
                                   MatObjectWriter::cells({MatObjectWriter::text("no number")})})},
          {"varNames", MatObjectWriter::cells(
                           {MatObjectWriter::text("p"), MatObjectWriter::text("acc"), MatObjectWriter::text("mode")})},
          {"numRows", MatObjectWriter::reals({rows})},
          {"numVars", MatObjectWriter::reals({3})},
          {"rowTimes", times}};
}

inline std::string timetable_mat(const std::string& times, MatObjectWriter file, double rows = 3.0) {
  const std::string any = MatObjectWriter::fields(timetable_fields(times, rows));
  file.variable("flight", "timetable", file.add("timetable", {{"any", any}}, true));
  return file.bytes();
}

}  // namespace veridyn::testing
