#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "veridyn/aircraft/sensors/channel_rules.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft::internal {
namespace {

using Quaternion = std::array<const Channel*, 4>;

/// The column of that name, of whichever file.
const Channel* column(const Recording& log, const std::string& name) {
  for (const Channel& channel : log.channels())
    if (channel.name == name || channel.name.ends_with("." + name)) return &channel;
  return nullptr;
}

bool is_of_unit_length(const Quaternion& q) {
  constexpr double kRounding = 0.01;
  std::vector<double> lengths;
  for (const Channel* part : q)
    if (part == nullptr || part->size() != q[0]->size() || !part->unit.same_dimension(Unit{})) return false;
  for (std::size_t i = 0; i < q[0]->size(); ++i)
    lengths.push_back(
        std::hypot(std::hypot(q[0]->value[i], q[1]->value[i]), std::hypot(q[2]->value[i], q[3]->value[i])));
  return std::abs(numerics::median(lengths) - 1.0) < kRounding;
}

}  // namespace

void map_table_quaternion(MapBuilder& builder) {
  for (const char* angle : {"roll", "pitch", "yaw"})
    if (builder.mapped(angle) || builder.given(angle)) return;
  constexpr std::array<std::array<const char*, 4>, 3> kNames{
      {{"q0", "q1", "q2", "q3"}, {"q[0]", "q[1]", "q[2]", "q[3]"}, {"qw", "qx", "qy", "qz"}}};
  for (const auto& names : kNames) {
    Quaternion q{};
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = column(builder.log(), names[i]);
    if (q[0] == nullptr || !is_of_unit_length(q)) continue;
    put_attitude(builder, q, q[0]->name + " to " + q[3]->name, "a quaternion from the body to north, east, down");
    return;
  }
}

}  // namespace veridyn::aircraft::internal
