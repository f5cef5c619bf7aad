#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// One column of an ArduPilot message: format character, place in the record, unit.
struct DataFlashColumn {
  std::string name;
  char type = 'B';           ///< format character (libraries/AP_Logger/LogStructure.h)
  std::uint32_t offset = 0;  ///< bytes from the start of the record, header included; binary logs only
  std::string unit = "1";
  double scale = 1.0;  ///< logged number times scale is in `unit`
};

/// What a FMT record says of a message type.
struct DataFlashFormat {
  std::uint8_t type = 0;
  std::uint32_t length = 0;  ///< bytes of a record with its three header bytes
  std::string name;
  std::string characters;
  std::string labels;  ///< comma separated

  friend bool operator==(const DataFlashFormat&, const DataFlashFormat&) = default;
};

/// Bytes that a format character takes; 0 when it is none of a A b B h H i I q Q f d g n N Z c C e E L M.
[[nodiscard]] std::uint32_t dataflash_size(char character);
/// 0.01 for c C e E, 1e-7 for L, otherwise 1: what the number in a binary record is to be multiplied with. Text logs
/// hold the product already.
[[nodiscard]] double dataflash_scale(char character);

/// Columns of a message without their units. Characters that run past the record's length, and everything after an
/// unknown character, are left out; names that are missing or appear twice are made up ("column3", "X_2").
[[nodiscard]] std::vector<DataFlashColumn> dataflash_columns(const DataFlashFormat& format, bool binary);

/// The format of a FMT payload (86 bytes); nothing when it cannot be one: a name that is not a word, a length below 3.
[[nodiscard]] std::optional<DataFlashFormat> parse_dataflash_format(std::string_view payload);

/// Units of the columns: what FMTU, UNIT and MULT records say, otherwise what is known of the standard messages.
class DataFlashUnits {
 public:
  void add_unit(char id, std::string_view label);
  void add_multiplier(char id, double value);
  void add_format(std::uint8_t type, std::string_view unit_ids, std::string_view multiplier_ids);

  /// Fills in unit and scale. A column whose character scales already (c C e E L) is not multiplied by its MULT again.
  void apply(const DataFlashFormat& format, std::vector<DataFlashColumn>& columns, bool binary) const;
  /// The column that numbers instances (unit character '#'; without FMTU a byte named I, Instance or Inst).
  [[nodiscard]] std::optional<std::size_t> instance_column(const DataFlashFormat& format,
                                                           const std::vector<DataFlashColumn>& columns) const;

 private:
  std::map<char, std::string> units_;
  std::map<char, double> multipliers_;
  std::array<std::optional<std::pair<std::string, std::string>>, 256> formats_;
};

/// The column with the stamps and what one count is in seconds: TimeUS, TimeMS; in old GPS messages, whose TimeMS is
/// the GPS clock, T.
struct DataFlashTime {
  std::size_t column = 0;
  double scale = 1e-6;
};
/// The stamps of a message with these columns; nothing when it has none.
[[nodiscard]] std::optional<DataFlashTime> dataflash_time(const std::vector<DataFlashColumn>& columns);

/// The unit of a standard message's field after the format character's scale: {"deg", 1}; {"1", 1} when not known.
struct KnownUnit {
  std::string unit = "1";
  double scale = 1.0;
};
/// See KnownUnit.
[[nodiscard]] KnownUnit known_ardupilot_unit(std::string_view message, std::string_view field);

/// Fills parameters, information and events from the topics PARM, MSG, VER, MODE, ARM, EV, STAT and ERR, and marks the
/// topics that describe the log itself.
void read_dataflash_events(Log& log);

}  // namespace veridyn::io
