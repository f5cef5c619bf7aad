#include "tests/support/ros_writer.hpp"

#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/support/synthetic_logs.hpp"

namespace veridyn::testing {
namespace {

std::string separated(const std::vector<std::pair<const char*, const char*>>& types) {
  std::string text;
  for (const auto& [name, fields] : types) {
    if (!text.empty()) text += std::string(80, '=') + "\nMSG: " + name + "\n";
    text += fields;
  }
  return text;
}

constexpr const char* kHeaderType = "# time and frame\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kTimeType = "int32 sec\nuint32 nanosec\n";
constexpr const char* kVector = "float64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* kQuaternion = "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";

std::string packed_by(std::string_view compression, const std::string& records) {
  if (compression.empty()) return records;
  std::string out;
  std::size_t size = 0;
  if (compression == "lz4") {
    out.resize(LZ4F_compressFrameBound(records.size(), nullptr));
    size = LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr);
    if (LZ4F_isError(size) != 0U) throw std::runtime_error("lz4");
  } else {
    out.resize(ZSTD_compressBound(records.size()));
    size = ZSTD_compress(out.data(), out.size(), records.data(), records.size(), 1);
    if (ZSTD_isError(size) != 0U) throw std::runtime_error("zstd");
  }
  out.resize(size);
  return out;
}

std::string odometry_message(std::int64_t ns, double x, double y, double yaw, double speed, double rate) {
  MessageWriter m;
  m.header(ns, "odom").text("base_link");
  m.reals({x, y, 0.0, 0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}).reals(std::vector<double>(36, 0.25));
  m.reals({speed, 0.0, 0.0, 0.0, 0.0, rate}).reals(std::vector<double>(36, 0.0));
  return m.bytes();
}

std::string fix_message(std::int64_t ns, int status, double latitude, double longitude, double altitude) {
  MessageWriter m;
  m.header(ns, "gps").numbers(static_cast<std::int8_t>(status), std::uint16_t{1});
  m.reals({latitude, longitude, altitude}).reals(std::vector<double>(9, 1.0)).number(std::uint8_t{2});
  return m.bytes();
}

}  // namespace

MessageWriter::MessageWriter(Kind kind) : kind_(kind) {
  if (kind != Kind::kRos1)
    bytes_ = pack(std::uint8_t{0}, static_cast<std::uint8_t>(kind == Kind::kBigEndian ? 0 : 1), std::uint16_t{0});
}

void MessageWriter::put(const char* bytes, std::size_t size) {
  if (kind_ != Kind::kRos1)
    while ((bytes_.size() - 4) % size != 0) bytes_ += '\0';
  std::string part(bytes, size);
  if (kind_ == Kind::kBigEndian) std::ranges::reverse(part);
  bytes_ += part;
}

MessageWriter& MessageWriter::text(std::string_view text) {
  const bool zero = kind_ != Kind::kRos1;
  number(static_cast<std::uint32_t>(text.size() + (zero ? 1 : 0)));
  bytes_ += text;
  if (zero) bytes_ += '\0';
  return *this;
}

MessageWriter& MessageWriter::sequence(const std::vector<double>& values) {
  number(static_cast<std::uint32_t>(values.size()));
  return reals(values);
}

MessageWriter& MessageWriter::texts(const std::vector<std::string>& values) {
  number(static_cast<std::uint32_t>(values.size()));
  for (const std::string& value : values) text(value);
  return *this;
}

MessageWriter& MessageWriter::header(std::int64_t ns, std::string_view frame) {
  if (kind_ == Kind::kRos1) number(std::uint32_t{7});
  numbers(static_cast<std::int32_t>(ns / 1'000'000'000), static_cast<std::uint32_t>(ns % 1'000'000'000));
  return text(frame);
}

McapWriter::McapWriter(std::string_view profile) {
  bytes_ = "\x89MCAP0\r\n";
  record(1, text(profile) + text("veridyn tests"));
}

std::string McapWriter::text(std::string_view text) {
  return pack(static_cast<std::uint32_t>(text.size())) + std::string(text);
}

void McapWriter::record(unsigned char op, std::string_view body) {
  bytes_ += static_cast<char>(op);
  bytes_ += pack(static_cast<std::uint64_t>(body.size()));
  bytes_ += body;
}

void McapWriter::schema(std::uint16_t id, std::string_view name, std::string_view encoding, std::string_view data) {
  const std::size_t before = bytes_.size();
  record(3, pack(id) + text(name) + text(encoding) + text(data));
  schemas_ += bytes_.substr(before);
}

void McapWriter::channel(std::uint16_t id, std::uint16_t schema, std::string_view topic, std::string_view encoding) {
  const std::size_t before = bytes_.size();
  record(4, pack(id, schema) + text(topic) + text(encoding) + pack(std::uint32_t{0}));
  channels_ += bytes_.substr(before);
}

void McapWriter::message(std::uint16_t channel, std::int64_t log_ns, std::string_view payload) {
  if (messages_ == 0) first_ = log_ns;
  last_ = log_ns;
  record(5, pack(channel, static_cast<std::uint32_t>(messages_++), log_ns, log_ns) + std::string(payload));
}

void McapWriter::begin_chunk() { outside_ = std::exchange(bytes_, {}); }

void McapWriter::end_chunk(std::string_view compression, std::uint32_t crc) {
  const std::string records = std::exchange(bytes_, std::move(outside_));
  const std::string packed = packed_by(compression, records);
  record(6, pack(first_, last_, static_cast<std::uint64_t>(records.size()), crc != 0 ? crc : crc32_of(records)) +
                text(compression) + pack(static_cast<std::uint64_t>(packed.size())) + packed);
}

void McapWriter::finish() {
  record(15, pack(std::uint32_t{0}));
  const std::uint64_t begin = bytes_.size();
  bytes_ += schemas_ + channels_;
  record(11, pack(messages_, std::uint16_t{0}, std::uint32_t{0}, std::uint32_t{0}, std::uint32_t{0}, std::uint32_t{0},
                  first_, last_, std::uint32_t{0}));
  const std::string footer = '\2' + pack(std::uint64_t{20}, begin, std::uint64_t{0});
  bytes_ += footer;
  bytes_ += pack(crc32_of(std::string_view(bytes_).substr(begin)));
  bytes_ += "\x89MCAP0\r\n";
}

std::uint32_t crc32_of(std::string_view bytes) {
  std::uint32_t crc = ~0U;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xedb88320U : crc >> 1U;
  }
  return ~crc;
}

void write_bag_database(const std::filesystem::path& path, const std::vector<BagTopic>& topics,
                        const std::vector<BagMessage>& messages) {
  std::filesystem::remove(path);
  sqlite3* db = nullptr;
  if (sqlite3_open(path.c_str(), &db) != SQLITE_OK) throw std::runtime_error("sqlite");
  const bool defined = std::ranges::any_of(topics, [](const BagTopic& t) { return !t.definition.empty(); });
  const auto run = [&](const std::string& query, const std::vector<std::string>& texts = {}, std::int64_t a = 0,
                       std::int64_t b = 0) {
    sqlite3_stmt* s = nullptr;
    if (sqlite3_prepare_v2(db, query.c_str(), -1, &s, nullptr) != SQLITE_OK) throw std::runtime_error(query);
    sqlite3_bind_int64(s, 1, a);
    sqlite3_bind_int64(s, 2, b);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const int at = 3 + static_cast<int>(i);
      if (query.find("messages") != std::string::npos)
        sqlite3_bind_blob(s, at, texts[i].data(), static_cast<int>(texts[i].size()), SQLITE_STATIC);
      else
        sqlite3_bind_text(s, at, texts[i].data(), static_cast<int>(texts[i].size()), SQLITE_STATIC);
    }
    if (sqlite3_step(s) == SQLITE_ERROR) throw std::runtime_error(query);
    sqlite3_finalize(s);
  };
  run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT "
      "NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB "
      "NOT NULL)");
  if (defined)
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL, "
        "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  run("BEGIN");
  for (const BagTopic& t : topics) {
    run("INSERT INTO topics VALUES(?1, ?3, ?4, 'cdr', '')", {t.name, t.type}, t.id);
    if (!t.definition.empty())
      run("INSERT INTO message_definitions VALUES(?1, ?3, 'ros2msg', ?4, '')", {t.type, t.definition}, t.id);
  }
  for (const BagMessage& m : messages)
    run("INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", {m.payload}, m.topic, m.log_ns);
  run("COMMIT");
  sqlite3_close(db);
}

std::string imu_message(std::int64_t ns, double yaw, const std::vector<double>& gyro, const std::vector<double>& accel,
                        std::string_view frame) {
  MessageWriter m;
  m.header(ns, frame).reals({0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}).reals(std::vector<double>(9, 0.01));
  m.reals(gyro).reals(std::vector<double>(9, 0.0)).reals(accel).reals(std::vector<double>(9, 0.0));
  return m.bytes();
}

std::string imu_definition() {
  return separated({{"",
                     "# an IMU\nuint8 UNUSED=3\nstd_msgs/Header header\n\ngeometry_msgs/Quaternion orientation\n"
                     "float64[9] orientation_covariance # row major about x, y, z axes\n"
                     "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
                     "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
                    {"geometry_msgs/Quaternion", kQuaternion},
                    {"geometry_msgs/Vector3", kVector},
                    {"std_msgs/Header", kHeaderType},
                    {"builtin_interfaces/Time", kTimeType}});
}

std::string odometry_definition() {
  return separated({{"",
                     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
                     "geometry_msgs/TwistWithCovariance twist\n"},
                    {"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"},
                    {"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
                    {"geometry_msgs/Point", kVector},
                    {"geometry_msgs/Quaternion", kQuaternion},
                    {"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n"},
                    {"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
                    {"geometry_msgs/Vector3", kVector},
                    {"std_msgs/Header", kHeaderType},
                    {"builtin_interfaces/Time", kTimeType}});
}

std::string small_mcap() {
  McapWriter log;
  log.schema(1, "sensor_msgs/msg/Imu", "ros2msg", imu_definition());
  log.schema(2, "nav_msgs/msg/Odometry", "ros2msg", odometry_definition());
  log.schema(3, "sensor_msgs/msg/NavSatFix", "", "");
  log.schema(4, "ackermann_msgs/msg/AckermannDriveStamped", "ros2msg",
             separated({{"", "std_msgs/Header header\nAckermannDrive drive\n"},
                        {"ackermann_msgs/AckermannDrive",
                         "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\nfloat32 "
                         "acceleration\nfloat32 jerk\n"},
                        {"std_msgs/Header", kHeaderType}}));
  log.schema(5, "sensor_msgs/msg/JointState", "ros2msg",
             separated({{"",
                         "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] "
                         "effort\n"},
                        {"std_msgs/Header", kHeaderType}}));
  log.schema(6, "std_msgs/msg/Float64", "ros2msg", "float64 data\n");
  log.channel(1, 1, "/imu/data");
  log.channel(2, 2, "/odom");
  log.channel(3, 3, "/fix");
  log.channel(4, 4, "/drive");
  log.channel(5, 5, "/joint_states");
  log.channel(6, 6, "/throttle");
  log.channel(7, 0, "/note", "json");
  const char* const compressions[] = {"", "lz4", "zstd"};
  for (int chunk = 0; chunk < 3; ++chunk) {
    log.begin_chunk();
    for (int i = 50 * chunk; i < 50 * (chunk + 1); ++i) {
      const std::int64_t ns = kRosBegin_ns + 20'000'000LL * i;
      const double t = 0.02 * i, rate = 0.3 * std::sin(2.0 * t), yaw = 0.15 * (1.0 - std::cos(2.0 * t));
      log.message(1, ns + 3'000'000,
                  imu_message(ns, yaw, {0.001 * i, -0.002 * i, rate}, {0.1 * t, 10.0 * rate, 9.81 + 0.001 * (i % 3)}));
      log.message(2, ns + 5'000'000, odometry_message(ns, 10.0 * t, 0.5 * t, yaw, 10.0 + t, rate));
      if (i % 10 == 0)
        log.message(3, ns + 60'000'000,
                    fix_message(ns, i == 0 ? -1 : 0, 47.3 + 1e-6 * i, 8.5 + 1e-4 * t, 450.0 + 0.1 * i));
      if (i % 2 == 0) {
        MessageWriter drive;
        drive.header(ns, "base_link").numbers(static_cast<float>(0.1 * rate), 0.0F, 10.0F, 0.0F, 0.0F);
        log.message(4, ns + 1'000'000, drive.bytes());
        MessageWriter joints;
        joints.header(ns, "").texts({"rear_left_wheel", "rear_right_wheel"}).sequence({});
        joints.sequence({30.0 + t, 31.0 + t}).sequence({});
        log.message(5, ns + 2'000'000, joints.bytes());
      }
      if (i % 5 == 0) log.message(6, ns + 4'000'000, MessageWriter().number(0.01 * i).bytes());
      if (i % 50 == 0) log.message(7, ns + 4'000'000, "{}");
    }
    log.end_chunk(compressions[chunk]);
  }
  log.finish();
  return std::move(log.bytes());
}

std::string tiny_mcap() {
  McapWriter log;
  log.schema(1, "a/msg/State", "ros2msg", "std_msgs/Header header\nfloat64 x\nint16[2] y\nfloat32[] z\n");
  log.channel(1, 1, "/s");
  for (int i = 0; i < 12; ++i) {
    if (i == 6) log.begin_chunk();
    MessageWriter m;
    m.header(kRosBegin_ns + i * 1'000'000LL, "f")
        .number(0.5 * i)
        .numbers(std::int16_t{1}, static_cast<std::int16_t>(i));
    m.numbers(std::uint32_t{2}, 1.5F, 2.5F);
    log.message(1, kRosBegin_ns + i * 1'000'000LL, m.bytes());
  }
  log.end_chunk("lz4");
  log.finish();
  return std::move(log.bytes());
}

std::string synthetic_mcap(double megabytes, std::string_view compression) {
  McapWriter log;
  log.schema(1, "sensor_msgs/msg/Imu", "ros2msg", imu_definition());
  log.schema(2, "nav_msgs/msg/Odometry", "ros2msg", odometry_definition());
  log.schema(3, "sensor_msgs/msg/NavSatFix", "", "");
  log.channel(1, 1, "/imu/data");
  log.channel(2, 2, "/odom");
  log.channel(3, 3, "/fix");
  const auto limit = static_cast<std::size_t>(megabytes * 1e6);
  std::size_t size = 0;
  for (int i = 0; size < limit;) {
    log.begin_chunk();
    while (log.bytes().size() < 1'000'000) {
      const std::int64_t ns = kRosBegin_ns + 5'000'000LL * i;
      const double x = 1e-3 * ((i * 37) % 20011);
      log.message(1, ns, imu_message(ns, x, {x, 2.0 * x, 3.0 * x}, {x, -x, 9.81 + x}));
      if (i % 2 == 0) log.message(2, ns, odometry_message(ns, x, x, x, x, x));
      if (i % 40 == 0) log.message(3, ns, fix_message(ns, 0, 47.0 + x, 8.0 + x, x));
      ++i;
    }
    size += log.bytes().size();
    log.end_chunk(compression);
  }
  log.finish();
  return std::move(log.bytes());
}

}  // namespace veridyn::testing
