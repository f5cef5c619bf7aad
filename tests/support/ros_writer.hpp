#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::testing {

/// Serialises a message as ROS does, number by number: XCDR version 1 after the encapsulation header (OMG DDS-XTypes
/// 1.3, 7.4), or ROS 1. Written from the specification, independent of the reader's tables.
class MessageWriter {
 public:
  enum class Kind { kLittleEndian, kBigEndian, kRos1 };
  explicit MessageWriter(Kind kind = Kind::kLittleEndian);

  template <typename Number>
  MessageWriter& number(Number value) {
    put(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <typename... Numbers>
  MessageWriter& numbers(Numbers... values) {
    (number(values), ...);
    return *this;
  }
  MessageWriter& reals(const std::vector<double>& values) {
    for (const double v : values) number(v);
    return *this;
  }
  MessageWriter& text(std::string_view text);
  /// Length and elements.
  MessageWriter& sequence(const std::vector<double>& values);
  MessageWriter& texts(const std::vector<std::string>& values);
  MessageWriter& header(std::int64_t ns, std::string_view frame);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void put(const char* bytes, std::size_t size);

  Kind kind_;
  std::string bytes_;
};

/// Writes MCAP records as the specification (mcap.dev/spec, version 0) lays them out.
class McapWriter {
 public:
  explicit McapWriter(std::string_view profile = "ros2");

  void schema(std::uint16_t id, std::string_view name, std::string_view encoding, std::string_view data);
  void channel(std::uint16_t id, std::uint16_t schema, std::string_view topic, std::string_view encoding = "cdr");
  void message(std::uint16_t channel, std::int64_t log_ns, std::string_view payload);
  /// Records from here on go into a chunk.
  void begin_chunk();
  /// Ends it: compressed by "", "lz4" or "zstd". A checksum of its own instead of the right one where `crc` is not 0.
  void end_chunk(std::string_view compression, std::uint32_t crc = 0);
  void record(unsigned char op, std::string_view body);
  /// Data end, summary with schemas, channels and statistics, footer.
  void finish();
  [[nodiscard]] std::string& bytes() { return bytes_; }

  static std::string text(std::string_view text);

 private:
  std::string bytes_, outside_, schemas_, channels_;
  std::int64_t first_ = 0, last_ = 0;
  std::uint64_t messages_ = 0;
};

/// CRC-32 (IEEE 802.3) bit by bit: 0xcbf43926 of "123456789".
[[nodiscard]] std::uint32_t crc32_of(std::string_view bytes);

/// One message of a bag.
struct BagMessage {
  int topic = 1;
  std::int64_t log_ns = 0;
  std::string payload;
};
struct BagTopic {
  int id = 1;
  std::string name, type;
  std::string definition{};  ///< in the table of ROS 2 Iron; empty: in none
};
/// Writes a database as rosbag2 does (schema version 4; 3, without definitions, where no topic has one).
void write_bag_database(const std::filesystem::path& path, const std::vector<BagTopic>& topics,
                        const std::vector<BagMessage>& messages);

/// 2023-11-14 22:13:20 UTC [ns].
inline constexpr std::int64_t kRosBegin_ns = 1'700'000'000'000'000'000;

/// An Imu with a yaw of `yaw` in ENU, rates p q r and specific force, logged 3 ms after its stamp.
[[nodiscard]] std::string imu_message(std::int64_t ns, double yaw, const std::vector<double>& gyro,
                                      const std::vector<double>& accel, std::string_view frame = "base_link");

/// Three seconds of a car: Imu and Odometry at 50 Hz, NavSatFix at 5 Hz, AckermannDriveStamped and wheels (JointState)
/// at 25 Hz, a Float64, a topic in JSON. In chunks of all three compressions.
[[nodiscard]] std::string small_mcap();
/// Some messages outside of chunks and in one compressed by lz4, 1 ms apart.
[[nodiscard]] std::string tiny_mcap();
/// About `megabytes` of Imu, Odometry and NavSatFix in chunks.
[[nodiscard]] std::string synthetic_mcap(double megabytes, std::string_view compression);

/// The definitions of sensor_msgs/msg/Imu and of nav_msgs/msg/Odometry, and what they need, as rosbag2 stores them.
[[nodiscard]] std::string imu_definition();
[[nodiscard]] std::string odometry_definition();

}  // namespace veridyn::testing
