#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn {

// The keys of tables: veridyn/core/study_keys.hpp.
struct StudyKey;
struct StudyKeys;
template <typename T>
class KeyTable;

namespace internal {
struct StudyNode;
}

/// A table of a study file: typed access to its keys, every error with file, line and key.
///
/// A number with a unit is written either plainly (then it is in the SI unit, radians for angles) or as text with any
/// unit of the same dimension: `mass = 12.6`, `mass = "27.8 lb"`, `M_alpha0 = "27 deg"`. Each read marks its key as
/// known; `finish()` then refuses unknown keys, which are the misspelt ones. A table is known when it was opened: to
/// ask whether it is there says nothing about what is in it.
///
/// All readers throw InputError, for example
/// `study.toml:14: subject.mass = -1 must be > 0`, `study.toml:3: subject.span: unit 'kg' is a mass [kg], expected a
/// length [m]`.
class StudyTable {
 public:
  /// An empty table named `path`, as if the study had `[path]` with nothing in it.
  explicit StudyTable(std::string path = {});

  [[nodiscard]] bool has(std::string_view key) const;
  /// `key`, or `old_key`, what it was called in earlier versions, where the study has that one; the study then holds a
  /// note that says the new name.
  [[nodiscard]] std::string_view renamed(std::string_view key, std::string_view old_key) const;
  /// Marks a key as known with all that is in it, for a table that nothing can be said about here.
  void accept(std::string_view key) const;
  /// Keys in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// A finite number in SI. `unit` is the expected SI unit, such as "kg" or "rad/s".
  [[nodiscard]] double number(std::string_view key, std::string_view unit) const;
  [[nodiscard]] double number_or(std::string_view key, std::string_view unit, double otherwise) const;
  /// As `number`, and > 0.
  [[nodiscard]] double positive(std::string_view key, std::string_view unit) const;
  [[nodiscard]] double positive_or(std::string_view key, std::string_view unit, double otherwise) const;
  [[nodiscard]] std::optional<double> optional_number(std::string_view key, std::string_view unit) const;
  [[nodiscard]] long long integer(std::string_view key) const;
  [[nodiscard]] long long integer_or(std::string_view key, long long otherwise) const;
  [[nodiscard]] bool flag_or(std::string_view key, bool otherwise) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] std::string text_or(std::string_view key, std::string_view otherwise) const;
  /// A text that is one of `choices`.
  [[nodiscard]] std::string choice_or(std::string_view key, std::span<const std::string> choices,
                                      std::string_view otherwise) const;
  /// An array of numbers, each as in `number`. A single number counts as an array of one.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, std::string_view unit) const;
  [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
  /// A path; a relative one is taken from the folder of the file that states it: the study's, or that of the file from
  /// which it takes its subject.
  [[nodiscard]] std::filesystem::path file(std::string_view key) const;
  [[nodiscard]] std::vector<std::filesystem::path> files(std::string_view key) const;

  /// Kinds of value, to distinguish `CL = ["1", "alpha"]` from `CL = { 1 = 0.3, alpha = 4.5 }`.
  [[nodiscard]] bool is_table(std::string_view key) const;
  [[nodiscard]] bool is_array(std::string_view key) const;
  [[nodiscard]] bool is_text(std::string_view key) const;
  [[nodiscard]] bool is_number(std::string_view key) const;

  /// A table within; must be there.
  [[nodiscard]] StudyTable table(std::string_view key) const;
  /// A table within, or an empty one of that name.
  [[nodiscard]] StudyTable table_or_empty(std::string_view key) const;
  /// An array of tables `[[key]]`; empty when absent.
  [[nodiscard]] std::vector<StudyTable> tables(std::string_view key) const;

  /// "study.toml:14: subject.mass", for errors about a value's meaning.
  [[nodiscard]] std::string place(std::string_view key) const;
  /// Throws InputError at `place(key)`.
  [[noreturn]] void fail(std::string_view key, std::string_view what) const;
  /// Dotted name of this table, "subject.geometry"; empty at the root.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Refuses keys that were not read, here and in every table within, naming the nearest known key.
  void finish() const;

 private:
  friend class Study;
  StudyTable(std::shared_ptr<internal::StudyNode> node, std::string path);
  std::shared_ptr<internal::StudyNode> node_;
  std::string path_;
};

/// A study: a TOML file that says what the physical thing is, where its data are and what to find out.
class Study {
 public:
  /// Reads a study. Each override is "key=value" with a dotted key (`data.rate=50`, `subject.mass="27 lb"`), as from
  /// `--set`; a value that is not TOML by itself is taken as text.
  /// @throws InputError with file, line and column when it is missing or not TOML.
  [[nodiscard]] static Study load(const std::filesystem::path& path, std::span<const std::string> overrides = {});
  /// The same from text; `name` stands in messages, relative files start from `folder`.
  [[nodiscard]] static Study parse(std::string_view text, std::string name, const std::filesystem::path& folder = {},
                                   std::span<const std::string> overrides = {});

  [[nodiscard]] const StudyTable& root() const { return root_; }
  /// File name as given, for messages.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// What its author should know: keys that have a new name. One line each.
  [[nodiscard]] const std::vector<std::string>& notes() const;
  /// The study after its overrides, as TOML: what a result has to keep to be reproduced. Relative paths that the file
  /// of a subject stated are absolute in it once they have been read.
  [[nodiscard]] std::string to_toml() const;

 private:
  Study() = default;
  StudyTable root_;
  std::string name_;
  std::filesystem::path folder_;
};

}  // namespace veridyn
