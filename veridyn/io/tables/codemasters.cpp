#include "veridyn/io/tables/codemasters.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::io {
namespace {

constexpr std::size_t kFloats = 66;
using Packet = std::array<double, kFloats>;

/// Places of the floats.
enum : std::size_t {
  kTime = 0,
  kPosition = 4,
  kSpeed = 7,
  kVelocity = 8,
  kRight = 11,
  kForward = 14,
  kSuspension = 17,
  kSuspensionRate = 21,
  kWheelSpeed = 25,
  kThrottle = 29,
  kSteer = 30,
  kBrake = 31,
  kClutch = 32,
  kGear = 33,
  kLateralG = 34,
  kForwardG = 35,
};

Eigen::Vector3d vector_at(const Packet& p, std::size_t place) { return {p[place], p[place + 1], p[place + 2]}; }

/// Game's axes to x, y, z with z up.
Eigen::Vector3d z_up(const Eigen::Vector3d& game) { return {game.x(), -game.z(), game.y()}; }

bool fits(const Packet& p) {
  for (const double v : p) {
    if (!std::isfinite(v)) return false;
  }
  const Eigen::Vector3d right = vector_at(p, kRight), forward = vector_at(p, kForward);
  constexpr double kClose = 1e-3;
  return std::abs(right.norm() - 1.0) < kClose && std::abs(forward.norm() - 1.0) < kClose &&
         std::abs(right.dot(forward)) < kClose &&
         std::abs(vector_at(p, kVelocity).norm() - p[kSpeed]) < kClose * (1.0 + std::abs(p[kSpeed]));
}

/// Most of the first packets: in menus all is zero.
bool mostly_fits(std::size_t count, const std::function<Packet(std::size_t)>& packet) {
  if (count == 0) return false;
  constexpr std::size_t kLooks = 50;
  std::size_t good = 0, looked = 0;
  for (std::size_t k = 0; k < kLooks; ++k) {
    const std::size_t i = k * count / kLooks;
    good += fits(packet(i)) ? 1U : 0U;
    ++looked;
  }
  return 2 * good > looked;
}

Packet packet_of(const NpyArray& array, std::size_t column) {
  Packet p;
  for (std::size_t i = 0; i < kFloats; ++i) p[i] = array.columns[column].number(i);
  return p;
}

Packet packet_of(std::string_view bytes, std::size_t index) {
  std::array<float, kFloats> floats;
  std::memcpy(floats.data(), bytes.data() + index * sizeof floats, sizeof floats);
  Packet p;
  for (std::size_t i = 0; i < kFloats; ++i) p[i] = static_cast<double>(floats[i]);
  return p;
}

/// Columns forward, left, up in the world's axes.
Eigen::Matrix3d axes_of(const Packet& p) {
  Eigen::Matrix3d R;
  R.col(0) = z_up(vector_at(p, kForward)).normalized();
  const Eigen::Vector3d left = -z_up(vector_at(p, kRight));
  R.col(2) = R.col(0).cross(left).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

/// Slope of a vector over time about sample k, by least squares over the samples within `half` [s].
Eigen::Vector3d slope(const std::vector<Packet>& packets, std::size_t k, double half,
                      const std::function<Eigen::Vector3d(const Packet&)>& value) {
  double n = 0.0, t1 = 0.0, t2 = 0.0;
  Eigen::Vector3d y0 = Eigen::Vector3d::Zero(), y1 = y0;
  const double at = packets[k][kTime];
  const auto take = [&](std::size_t i) {
    const double t = packets[i][kTime] - at;
    const Eigen::Vector3d y = value(packets[i]);
    n += 1.0;
    t1 += t;
    t2 += t * t;
    y0 += y;
    y1 += t * y;
  };
  take(k);
  for (std::size_t i = k; i-- > 0 && packets[i][kTime] >= at - half;) take(i);
  for (std::size_t i = k + 1; i < packets.size() && packets[i][kTime] <= at + half; ++i) take(i);
  const double spread = t2 - t1 * t1 / n;
  if (!(spread > 0.0)) return Eigen::Vector3d::Zero();
  return (y1 - t1 / n * y0) / spread;
}

Log log_of(const std::vector<Packet>& all, const std::string& source) {
  std::vector<Packet> packets;
  std::size_t repeated = 0;
  for (const Packet& p : all) {
    if (!fits(p)) continue;
    if (packets.empty() || p[kTime] > packets.back()[kTime]) {
      packets.push_back(p);
    } else {
      ++repeated;
    }
  }
  constexpr std::size_t kFewest = 10;
  if (packets.size() < kFewest)
    throw InputError(source, fmt::format("holds {} usable packets of a drive; a recording has {} at least",
                                         packets.size(), kFewest));
  Log log;
  log.source = source;
  log.format = "Codemasters telemetry";
  log.frame = Frame::kFlu;
  if (all.size() > packets.size())
    log.damage.notes.push_back(
        fmt::format("{} packets were left out: {} with a stamp that repeats or goes back, the others "
                    "without a drive",
                    all.size() - packets.size(), repeated));
  log.damage.notes.emplace_back("accel_z and the angular rates are derived from velocity and attitude over 0.1 s");
  LogTopic topic;
  std::vector<double> stamps;
  for (const Packet& p : packets) stamps.push_back(p[kTime]);
  topic.time = make_time_base(std::move(stamps));
  const auto add = [&](const char* name, const char* unit, const std::function<double(std::size_t)>& value) {
    std::vector<double> values(packets.size());
    for (std::size_t k = 0; k < packets.size(); ++k) values[k] = value(k);
    LogField field;
    field.name = name;
    field.unit = unit;
    field.values = Column(std::move(values));
    topic.fields.push_back(std::move(field));
  };
  const auto plain = [&](const char* name, const char* unit, std::size_t place) {
    add(name, unit, [&packets, place](std::size_t k) { return packets[k][place]; });
  };
  constexpr double kHalf = 0.05;  // [s]
  std::vector<Eigen::Matrix3d> axes;
  for (const Packet& p : packets) axes.push_back(axes_of(p));
  add("accel_x", "m/s^2", [&](std::size_t k) { return kGravity * packets[k][kForwardG]; });
  add("accel_y", "m/s^2", [&](std::size_t k) { return kGravity * packets[k][kLateralG]; });
  add("accel_z", "m/s^2", [&](std::size_t k) {
    return axes[k].col(2).dot(slope(packets, k, kHalf, [](const Packet& p) { return z_up(vector_at(p, kVelocity)); }));
  });
  std::vector<Eigen::Vector3d> rates;
  for (std::size_t k = 0; k < packets.size(); ++k) {
    // R' R^T is the cross product with the angular velocity.
    const Eigen::Vector3d forward =
                              slope(packets, k, kHalf, [](const Packet&p) { return z_up(vector_at(p, kForward)); }),
                          left = -slope(packets, k, kHalf, [](const Packet&p) { return z_up(vector_at(p, kRight)); });
    const Eigen::Matrix3d& R = axes[k];
    rates.emplace_back(R.col(2).dot(left), -R.col(2).dot(forward), R.col(1).dot(forward));
  }
  add("gyro_x", "rad/s", [&](std::size_t k) { return rates[k].x(); });
  add("gyro_y", "rad/s", [&](std::size_t k) { return rates[k].y(); });
  add("gyro_z", "rad/s", [&](std::size_t k) { return rates[k].z(); });
  const auto euler = [&](std::size_t k) { return numerics::euler_from_quaternion(Eigen::Quaterniond(axes[k])); };
  add("roll", "rad", [&](std::size_t k) { return euler(k).phi; });
  add("pitch", "rad", [&](std::size_t k) { return euler(k).theta; });
  add("yaw", "rad", [&](std::size_t k) { return euler(k).psi; });
  plain("speed", "m/s", kSpeed);
  add("pos_x", "m", [&](std::size_t k) { return z_up(vector_at(packets[k], kPosition)).x(); });
  add("pos_y", "m", [&](std::size_t k) { return z_up(vector_at(packets[k], kPosition)).y(); });
  add("pos_z", "m", [&](std::size_t k) { return z_up(vector_at(packets[k], kPosition)).z(); });
  plain("throttle", "1", kThrottle);
  plain("steering", "1", kSteer);
  plain("brake", "1", kBrake);
  plain("clutch", "1", kClutch);
  plain("gear", "1", kGear);
  constexpr std::array kWheels = {"rl", "rr", "fl", "fr"};
  for (std::size_t i = 0; i < kWheels.size(); ++i) {
    plain(fmt::format("wheel_{}", kWheels[i]).c_str(), "m/s", kWheelSpeed + i);
    plain(fmt::format("suspension_{}", kWheels[i]).c_str(), "mm", kSuspension + i);
    plain(fmt::format("suspension_rate_{}", kWheels[i]).c_str(), "mm/s", kSuspensionRate + i);
  }
  log.topics.push_back(std::move(topic));
  internal::finish(log);
  return log;
}

}  // namespace

bool is_codemasters(const NpyArray& array) {
  return array.rows() == kFloats && array.shape.size() == 2 &&
         mostly_fits(array.columns.size(), [&](std::size_t i) { return packet_of(array, i); });
}

bool is_codemasters(std::string_view bytes) {
  constexpr std::size_t kBytes = kFloats * sizeof(float);
  return !bytes.empty() && bytes.size() % kBytes == 0 &&
         mostly_fits(bytes.size() / kBytes, [&](std::size_t i) { return packet_of(bytes, i); });
}

Log codemasters_log(const NpyArray& array, const std::string& source) {
  std::vector<Packet> packets;
  for (std::size_t i = 0; i < array.columns.size(); ++i) packets.push_back(packet_of(array, i));
  return log_of(packets, source);
}

Log codemasters_log(std::string_view bytes, const std::string& source) {
  std::vector<Packet> packets;
  for (std::size_t i = 0; i < bytes.size() / (kFloats * sizeof(float)); ++i) packets.push_back(packet_of(bytes, i));
  return log_of(packets, source);
}

}  // namespace veridyn::io
