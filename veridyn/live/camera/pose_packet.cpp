#include "veridyn/live/camera/pose_packet.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <span>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/packets/crc32.hpp"

namespace veridyn::live {
namespace {

constexpr std::string_view kPoseStart = "VCP1";
constexpr std::size_t kPoseSequenceAt = 4, kPoseStampAt = 8, kPoseNumbersAt = 16, kPoseCovarianceAt = 40,
                      kPoseCheckAt = 88;

}  // namespace

PosePacket encode(const CameraPose& pose) {
  PosePacket bytes{};
  const std::span<char> out(bytes);
  std::copy(kPoseStart.begin(), kPoseStart.end(), bytes.begin());
  put_at(out, kPoseSequenceAt, pose.sequence);
  put_at(out, kPoseStampAt, pose.stamp);
  for (std::size_t i = 0; i < 3; ++i) put_at(out, kPoseNumbersAt + 8 * i, pose.pose(i));
  std::size_t at = kPoseCovarianceAt;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = row; column < 3; ++column, at += 8) put_at(out, at, pose.covariance(row, column));
  }
  put_at(out, kPoseCheckAt, io::crc32({bytes.data(), kPoseCheckAt}));
  return bytes;
}

std::optional<CameraPose> decode_pose(std::string_view bytes) {
  if (bytes.size() != kPosePacketBytes || !bytes.starts_with(kPoseStart)) return std::nullopt;
  if (number_at<std::uint32_t>(bytes, kPoseCheckAt) != io::crc32(bytes.substr(0, kPoseCheckAt))) return std::nullopt;
  CameraPose p;
  p.sequence = number_at<std::uint32_t>(bytes, kPoseSequenceAt);
  p.stamp = number_at<std::int64_t>(bytes, kPoseStampAt);
  for (std::size_t i = 0; i < 3; ++i) p.pose(i) = number_at<double>(bytes, kPoseNumbersAt + 8 * i);
  std::size_t at = kPoseCovarianceAt;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = row; column < 3; ++column, at += 8)
      p.covariance(row, column) = p.covariance(column, row) = number_at<double>(bytes, at);
  }
  if (!p.pose.allFinite() || !p.covariance.allFinite()) return std::nullopt;
  if (p.covariance.llt().info() != Eigen::Success) return std::nullopt;
  return p;
}

}  // namespace veridyn::live
