#include "veridyn/live/platform/order_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/known_packets.hpp"

namespace veridyn::live {
namespace {

constexpr std::size_t kStrokeBytes = 20, kStrokes = 6;
/// What a number with sign and point takes: positions are below 1e7 in any unit.
constexpr std::size_t kLongestNumber = 20;

void put_value(const io::PacketLayout& layout, std::vector<double>& values, std::string_view field, double value) {
  values[layout.find(field)] = value;
}

}  // namespace

std::string_view name_of(OrderFormatKind kind) {
  constexpr EnumArray<OrderFormatKind, std::string_view, kOrderFormats> kNamesOfFormats = {
      {"veridyn", "motion_68", "amc_aasd15a", "flypt"}};
  return kNamesOfFormats[kind];
}

OrderFormat::OrderFormat(const OrderFormatOptions& options, const cueing::Platform& platform) : kind_(options.kind) {
  switch (kind_) {
    case OrderFormatKind::kVeridyn:
      break;
    case OrderFormatKind::kMotion68:
      layout_ = io::known_packet("motion_68");
      values_.resize(layout_.fields.size());
      longest_ = layout_.size;
      break;
    case OrderFormatKind::kAmcAasd15a:
      if (!platform.legs)
        throw InputError("amc_aasd15a", "sends the strokes of legs; [platform] has none (`feet`, `heads`)");
      legs_.emplace(*platform.legs, platform.limits);
      longest_ = kStrokeBytes;
      break;
    case OrderFormatKind::kFlypt:
      read_text(options.text);
      break;
  }
}

void OrderFormat::read_text(std::string_view text) {
  Part part;
  longest_ = 0;
  bool says_axis = false;
  const auto fail = [&](std::string_view what) { throw InputError("flypt", fmt::format("'{}' {}", text, what)); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool twice = i + 1 < text.size() && text[i + 1] == c;
    if ((c == '{' || c == '}') && twice) ++i;
    if ((c != '{' && c != '}') || twice) {
      part.before += c;
      continue;
    }
    const std::size_t end = c == '{' ? text.find('}', i) : std::string_view::npos;
    if (end == std::string_view::npos) fail("has a brace without its other one");
    Part field = read_field(text.substr(i + 1, end - i - 1));
    field.before = std::exchange(part.before, {});
    longest_ += field.before.size() + kLongestNumber;
    parts_.push_back(std::move(field));
    says_axis = true;
    i = end;
  }
  if (!says_axis) fail("names no axis: takes {pitch:deg:.3f} and the like");
  longest_ += part.before.size();
  parts_.push_back(std::move(part));
  if (longest_ > bytes_.size())
    fail(fmt::format("takes up to {} bytes; at most {} can be sent", longest_, bytes_.size()));
}

OrderFormat::Part OrderFormat::read_field(std::string_view field) {
  const std::size_t first = field.find(':');
  const std::string_view name = field.substr(0, first);
  std::string_view rest = first == std::string_view::npos ? std::string_view() : field.substr(first + 1);
  const std::size_t second = rest.find(':');
  const std::string_view unit = rest.substr(0, second);
  const std::string_view form = second == std::string_view::npos ? std::string_view() : rest.substr(second + 1);
  const auto fail = [&](std::string_view what) { throw InputError("flypt", fmt::format("{{{}}} {}", field, what)); };
  Part part;
  for (std::size_t i = 0; i < cueing::kPlatformAxes; ++i) {
    if (name_of(static_cast<cueing::PlatformAxis>(i)) == name) part.axis = static_cast<cueing::PlatformAxis>(i);
  }
  if (!part.axis) {
    fail("is no axis: surge, sway, heave, roll, pitch, yaw");
    return part;
  }
  struct Unit {
    std::string_view name;
    double factor;
    bool turns;
  };
  constexpr std::array<Unit, 5> kUnits = {
      {{"rad", 1.0, true}, {"deg", 180.0 / kPi, true}, {"m", 1.0, false}, {"cm", 100.0, false}, {"mm", 1e3, false}}};
  if (!unit.empty()) {
    const auto* known = std::find_if(kUnits.begin(), kUnits.end(),
                                     [&](const Unit& u) { return u.name == unit && u.turns == turns(*part.axis); });
    if (known == kUnits.end()) fail(turns(*part.axis) ? "takes rad or deg" : "takes m, cm or mm");
    part.factor = known->factor;
  }
  if (second != std::string_view::npos) {
    if (form.size() != 3 || form[0] != '.' || form[1] < '0' || form[1] > '9' || form[2] != 'f')
      fail("takes decimals as .0f to .9f");
    part.decimals = form[1] - '0';
  }
  return part;
}

std::string_view OrderFormat::encode(const PlatformOrder& order) {
  switch (kind_) {
    case OrderFormatKind::kMotion68:
      return motion_68(order);
    case OrderFormatKind::kAmcAasd15a:
      return strokes(order);
    case OrderFormatKind::kFlypt:
      return text(order);
    case OrderFormatKind::kVeridyn:
      break;
  }
  const OrderBytes bytes = live::encode(order);
  std::copy(bytes.begin(), bytes.end(), bytes_.begin());
  return {bytes_.data(), bytes.size()};
}

std::string_view OrderFormat::motion_68(const PlatformOrder& order) {
  // A layout's world is forward, left, up, with nose down and left side up positive.
  const Eigen::Vector3d &shift = order.motion.shift, &angle = order.motion.angle;
  put_value(layout_, values_, "time", seconds(order.time));
  put_value(layout_, values_, "yaw", -angle.z());
  put_value(layout_, values_, "pitch", -angle.y());
  put_value(layout_, values_, "roll", angle.x());
  put_value(layout_, values_, "pos_x", shift.x());
  put_value(layout_, values_, "pos_y", -shift.y());
  put_value(layout_, values_, "pos_z", shift.z());
  io::encode(layout_, values_, std::span(bytes_).first(layout_.size));
  return {bytes_.data(), layout_.size};
}

std::string_view OrderFormat::strokes(const PlatformOrder& order) {
  bytes_.fill(0);
  bytes_[0] = bytes_[1] = '\xff';
  const cueing::Legs::Lengths lengths = legs_->lengths(order.motion);
  const cueing::AxisLimits& leg = legs_->geometry().leg;
  for (std::size_t i = 0; i < kStrokes; ++i) {
    double share = 0.5;
    if (i < static_cast<std::size_t>(legs_->count()))
      share = (lengths.position(i) - leg.lowest) / (leg.highest - leg.lowest);
    const auto value = static_cast<unsigned>(std::lround(65535.0 * std::clamp(share, 0.0, 1.0)));
    bytes_[2 + 2 * i] = static_cast<char>(value >> 8U);
    bytes_[3 + 2 * i] = static_cast<char>(value & 0xffU);
  }
  bytes_[kStrokeBytes - 2] = '\x0a';
  bytes_[kStrokeBytes - 1] = '\x0d';
  return {bytes_.data(), kStrokeBytes};
}

std::string_view OrderFormat::text(const PlatformOrder& order) {
  char* at = bytes_.data();
  for (const Part& part : parts_) {
    at = std::copy(part.before.begin(), part.before.end(), at);
    if (!part.axis) continue;
    const double value = part.factor * axis(order.motion, *part.axis).position;
    const double half = 0.5 * std::pow(10.0, -part.decimals);
    // No minus before what is rounded to zero.
    const auto [end, error] = std::to_chars(at, at + kLongestNumber, std::abs(value) < half ? 0.0 : value,
                                            std::chars_format::fixed, part.decimals);
    if (error == std::errc()) at = end;
  }
  return {bytes_.data(), static_cast<std::size_t>(at - bytes_.data())};
}

}  // namespace veridyn::live
