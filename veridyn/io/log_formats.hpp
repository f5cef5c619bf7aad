#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io {

/// How sure the content is of its format, and so in which order formats are tried.
enum class Recognition {
  kBeginning,  ///< known by its first bytes: tried first
  kContent,    ///< known by what is found further on, which a file of the first kind may hold by chance
  kText,       ///< any text may be it: tried last, and taken of a single line only where the file's name agrees
};

/// A format of logs that are one file: all that the rest of the library, the program, tests and fuzzing know of it.
struct LogFormat {
  std::string_view key;                    ///< names its fuzz target and corpus
  std::string_view name;                   ///< as messages name it
  std::string_view listed;                 ///< as the list of known formats names it; empty: another row names it
  std::vector<std::string_view> suffixes;  ///< of its files, small letters with the dot
  Recognition recognition;
  bool (*is)(std::string_view bytes);
  /// The log in `bytes`; `source` is its name in messages.
  /// @throws InputError when the bytes are not of this format.
  Log (*read)(std::string_view bytes, const std::string& source, const TableOptions& options);
  /// The same where a library opens the file by its name; otherwise null.
  Log (*read_file)(const std::filesystem::path& path, const TableOptions& options) = nullptr;
  bool table = false;  ///< its readers respect the options
};

/// All formats, in the order in which messages list them. A new format is a new row.
[[nodiscard]] std::span<const LogFormat> log_formats();

/// The format that the content shows, null where it shows none.
[[nodiscard]] const LogFormat* log_format_of(std::string_view bytes);

/// The format that the file's suffix promises, in large letters too; null where it promises none.
[[nodiscard]] const LogFormat* log_format_by_suffix(const std::filesystem::path& path);

/// All formats in a sentence: "ArduPilot DataFlash (.bin, .log), PX4 ULog (.ulg), ... and CSV".
[[nodiscard]] const std::string& list_of_log_formats();

}  // namespace veridyn::io
