#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace veridyn::testing {

/// Writes ArduPilot DataFlash records as the autopilot does, for tests and benchmarks.
class DataFlashWriter {
 public:
  using Value = std::variant<double, std::string>;

  /// Starts with the FMT that describes itself unless told otherwise.
  explicit DataFlashWriter(bool self_description = true);

  /// A FMT record; with `length` other than 0 a length unlike the sum of the characters.
  void format(std::uint8_t type, const std::string& name, const std::string& characters, const std::string& labels,
              std::uint8_t length = 0);
  /// FMTU for a type; needs the formats of `write_unit_tables`.
  void units(const std::string& name, const std::string& unit_ids, const std::string& multiplier_ids);
  /// FMT of UNIT, MULT and FMTU and the entries that flight messages use.
  void unit_tables();
  /// A record; numbers in physical units (c C e E L are stored as the scaled integers).
  void record(const std::string& name, const std::vector<Value>& values);
  void raw(std::string_view bytes) { bytes_.append(bytes); }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  struct Known {
    std::uint8_t type;
    std::string characters;
    std::uint32_t length;
  };
  std::string bytes_;
  std::map<std::string, Known> formats_;
};

/// Writes PX4 ULog messages.
class ULogWriter {
 public:
  explicit ULogWriter(std::uint64_t start_us = 1000000, bool flags = true);

  void message(char type, std::string_view body);
  void format(const std::string& definition) { message('F', definition); }
  void information(const std::string& key, std::string_view value);
  void information_part(bool continued, const std::string& key, std::string_view value);
  void parameter(const std::string& name, float value);
  void parameter(const std::string& name, std::int32_t value);
  void default_parameter(std::uint8_t kinds, const std::string& name, float value);
  void subscribe(std::uint16_t id, const std::string& topic, std::uint8_t instance = 0);
  void unsubscribe(std::uint16_t id);
  void data(std::uint16_t id, std::string_view payload);
  void text(char level, std::uint64_t time_us, const std::string& words);
  void tagged_text(char level, std::uint16_t tag, std::uint64_t time_us, const std::string& words);
  void sync();
  void dropout(std::uint16_t duration_ms);
  void raw(std::string_view bytes) { bytes_.append(bytes); }
  /// Sets the flag and the offset (0 to 2) of data that are appended from here on.
  void append_from_here(int index);

  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// The bytes of numbers one after the other, as in a packed C struct.
template <typename... Numbers>
std::string pack(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

/// A DataFlash log of about `megabytes` with the messages of a fixed-wing flight in their usual shares.
[[nodiscard]] std::string synthetic_dataflash(double megabytes);
/// The same for ULog.
[[nodiscard]] std::string synthetic_ulog(double megabytes);

/// A small log with everything a reader meets: units, instances, texts, arrays, modes, parameters.
[[nodiscard]] std::string small_dataflash();
[[nodiscard]] std::string small_dataflash_text();
[[nodiscard]] std::string small_ulog();
[[nodiscard]] std::string small_csv();
/// An uncompressed level 5 MAT file: a struct `flight` with time, p and q, a text, and a table.
[[nodiscard]] std::string small_mat();

}  // namespace veridyn::testing
