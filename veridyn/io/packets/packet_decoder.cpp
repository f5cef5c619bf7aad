#include "veridyn/io/packets/packet_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/bytes.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::io {
namespace {

template <typename T>
double read_as(const char* at) {
  return static_cast<double>(load_number<T>(at));
}

double number_at(const char* at, GatherType type) {
  switch (type) {
    case GatherType::kInt8:
      return read_as<std::int8_t>(at);
    case GatherType::kUint8:
      return read_as<std::uint8_t>(at);
    case GatherType::kInt16:
      return read_as<std::int16_t>(at);
    case GatherType::kUint16:
      return read_as<std::uint16_t>(at);
    case GatherType::kInt32:
      return read_as<std::int32_t>(at);
    case GatherType::kUint32:
      return read_as<std::uint32_t>(at);
    case GatherType::kInt64:
      return read_as<std::int64_t>(at);
    case GatherType::kUint64:
      return read_as<std::uint64_t>(at);
    case GatherType::kFloat:
      return read_as<float>(at);
    case GatherType::kDouble:
      return read_as<double>(at);
    case GatherType::kHalf:
    case GatherType::kText:
      break;
  }
  return kNaN;
}

bool is_no_number(const Eigen::Quaterniond& q) { return !q.coeffs().allFinite(); }

}  // namespace

PacketDecoder::PacketDecoder(PacketLayout layout) : layout_(std::move(layout)) {
  check(layout_);
  constexpr std::array<std::string_view, kQuantities> kNamesOfQuantities = {"time",
                                                                            "speed",
                                                                            "pos_x",
                                                                            "pos_y",
                                                                            "pos_z",
                                                                            "velocity_x",
                                                                            "velocity_y",
                                                                            "velocity_z",
                                                                            "world_velocity_x",
                                                                            "world_velocity_y",
                                                                            "world_velocity_z",
                                                                            "accel_x",
                                                                            "accel_y",
                                                                            "accel_z",
                                                                            "world_accel_x",
                                                                            "world_accel_y",
                                                                            "world_accel_z",
                                                                            "gyro_x",
                                                                            "gyro_y",
                                                                            "gyro_z",
                                                                            "forward_x",
                                                                            "forward_y",
                                                                            "forward_z",
                                                                            "right_x",
                                                                            "right_y",
                                                                            "right_z",
                                                                            "roll",
                                                                            "pitch",
                                                                            "yaw"};
  for (std::size_t i = 0; i < kQuantities; ++i) places_[i] = layout_.find(kNamesOfQuantities[i]);
}

bool PacketDecoder::decode(std::string_view packet, std::span<double> values) const {
  VERIDYN_ASSERT(values.size() == layout_.fields.size());
  if (packet.size() != layout_.size || packet.substr(0, layout_.begins_with.size()) != layout_.begins_with)
    return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const PacketField& f = layout_.fields[i];
    values[i] = f.factor * number_at(packet.data() + f.offset, f.type) + f.bias;
  }
  return true;
}

double PacketDecoder::at(std::span<const double> values, std::size_t quantity) const {
  return places_[quantity] < values.size() ? values[places_[quantity]] : kNaN;
}

Eigen::Vector3d PacketDecoder::vector_at(std::span<const double> values, std::size_t quantity) const {
  return {at(values, quantity), at(values, quantity + 1), at(values, quantity + 2)};
}

PacketMotion PacketDecoder::motion(std::span<const double> values) const {
  PacketMotion m;
  m.time = at(values, kTime);
  m.position = vector_at(values, kPosition);
  m.rate = vector_at(values, kRate);
  const Eigen::Vector3d forward = vector_at(values, kForward), right = vector_at(values, kRight);
  if (forward.allFinite() && right.allFinite()) {
    Eigen::Matrix3d axes;
    axes.col(0) = forward.normalized();
    axes.col(2) = axes.col(0).cross(-right).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    m.attitude = Eigen::Quaterniond(axes);
  } else {
    const Eigen::Vector3d angles = vector_at(values, kAngles);
    m.attitude = numerics::quaternion_from_euler(angles.x(), angles.y(), angles.z());
  }
  m.velocity = vector_at(values, kWorldVelocity);
  m.acceleration = vector_at(values, kAcceleration);
  if (!is_no_number(m.attitude)) {
    if (!m.velocity.allFinite()) m.velocity = m.attitude * vector_at(values, kVelocity);
    const Eigen::Vector3d world = vector_at(values, kWorldAcceleration);
    if (world.allFinite()) m.acceleration = m.attitude.conjugate() * world;
  }
  m.speed = at(values, kSpeed);
  if (std::isnan(m.speed)) m.speed = at(values, kVelocity);
  if (std::isnan(m.speed)) m.speed = (m.attitude.conjugate() * m.velocity).x();
  return m;
}

bool PacketDecoder::is_plausible(std::span<const double> values) const {
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return false;
  bool all_zero = true;
  for (std::size_t i = 0; i < values.size(); ++i) all_zero = all_zero && values[i] == layout_.fields[i].bias;
  if (all_zero) return false;
  // A float read as a count of milliseconds is more than a week, a count read as a float next to nothing.
  constexpr double kLongest = 8e5, kShortest = 1e-6;  // [s]
  constexpr double kFarthest = 1e6, kFastest = 500.0, kHardest = 1e4, kMostTurns = 100.0;
  constexpr double kClose = 1e-3;
  if (const double time = at(values, kTime); time < 0.0 || time > kLongest || (time > 0.0 && time < kShortest))
    return false;
  const auto is_beyond = [&](std::size_t quantity, double limit) {
    const Eigen::Vector3d v = vector_at(values, quantity);
    return v.allFinite() && v.cwiseAbs().maxCoeff() > limit;
  };
  if (is_beyond(kPosition, kFarthest) || is_beyond(kWorldVelocity, kFastest) || is_beyond(kVelocity, kFastest) ||
      is_beyond(kAcceleration, kHardest) || is_beyond(kWorldAcceleration, kHardest) || is_beyond(kRate, kMostTurns) ||
      is_beyond(kAngles, kMostTurns))
    return false;
  const Eigen::Vector3d forward = vector_at(values, kForward), right = vector_at(values, kRight);
  if (forward.allFinite() && right.allFinite() &&
      (std::abs(forward.norm() - 1.0) > kClose || std::abs(right.norm() - 1.0) > kClose ||
       std::abs(forward.dot(right)) > kClose))
    return false;
  const double speed = at(values, kSpeed);
  for (const std::size_t velocity : {kVelocity, kWorldVelocity}) {
    const Eigen::Vector3d v = vector_at(values, velocity);
    if (v.allFinite() && std::isfinite(speed) &&
        std::abs(v.norm() - std::abs(speed)) > kClose * (1.0 + std::abs(speed)))
      return false;
  }
  return true;
}

}  // namespace veridyn::io
