#include <fmt/format.h>

#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/osim/osim_context.hpp"

/// Frames of an .osim file: what the bodies and the frames fixed to them are that other objects refer to.
namespace veridyn::muscle::osim {
namespace {

/// The folder of a component path: "bodyset" of "/bodyset/femur".
std::string folder_of(std::string_view path) {
  const std::string name = last_part(path);
  return path.size() > name.size() ? last_part(path.substr(0, path.size() - name.size())) : "";
}

/// A body and a point in it [m].
struct PlacedPoint {
  int body = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
};

/// The station or marker that a socket of a frame names; of several of that name the one whose owner the path names, or
/// beside the frame.
PlacedPoint station(const Context& context, const Element& frame, const char* name, std::size_t depth) {
  const std::string property = fmt::format("socket_{}", name), path = socket(frame, name), wanted = last_part(path),
                    folder = folder_of(path);
  if (wanted.empty()) frame.fail(property, "names no station");
  const Element* found = nullptr;
  for (const Element& candidate : context.stations) {
    if (candidate.name() != wanted) continue;
    const bool named = folder == ".." ? candidate.node().parent() == frame.node().parent()
                                      : folder == candidate.node().parent().parent().attribute("name").value();
    if (found == nullptr || named) found = &candidate;
    if (named) break;
  }
  if (found == nullptr) frame.fail(property, fmt::format("there is no station '{}'", path));
  std::string parent = socket(*found, "parent_frame");
  if (parent.empty()) found->fail("socket_parent_frame", "names no body or frame");
  if (parent == "..") parent = found->node().parent().parent().attribute("name").value();
  const FrameReference at = context.frame(*found, "socket_parent_frame", parent, depth + 1);
  return {at.body, at.placement * found->vector_or("location", Eigen::Vector3d::Zero())};
}

struct SignedAxis {
  int axis = 0;
  double sign = 1.0;
};

SignedAxis read_axis(const Element& frame, const char* property, const char* otherwise) {
  const std::string text = frame.text_or(property, otherwise);
  std::string_view axis = text;
  const double sign = axis.starts_with('-') ? -1.0 : 1.0;
  if (axis.starts_with('-') || axis.starts_with('+')) axis.remove_prefix(1);
  for (int i = 0; i < 3; ++i)
    if (axis.size() == 1 && (axis[0] == "xyz"[i] || axis[0] == "XYZ"[i])) return {i, sign};
  frame.fail(property, fmt::format("'{}' is none of +x, -x, +y, -y, +z, -z", text));
}

/// A frame by four points of a body: one axis along a to b, another across the triangle a b c, the third such that the
/// frame is right-handed.
FrameReference station_frame(const Context& context, const Element& frame, std::size_t depth) {
  const auto at = [&](const char* name) { return station(context, frame, name, depth); };
  const PlacedPoint a = at("point_a"), b = at("point_b"), c = at("point_c"), origin = at("origin_point");
  if (b.body != a.body || c.body != a.body || origin.body != a.body)
    frame.fail("socket_point_a", "the frame's stations are of several bodies");
  const Eigen::Vector3d along = b.point - a.point, normal = along.cross(c.point - a.point);
  if (!(normal.norm() > 1e-9 * along.squaredNorm())) frame.fail("socket_point_c", "its points are on one line");
  const SignedAxis first = read_axis(frame, "ab_axis", "+x"), second = read_axis(frame, "ab_x_ac_axis", "+y");
  if (first.axis == second.axis) frame.fail("ab_x_ac_axis", "is along the same axis as ab_axis");
  const int third = 3 - first.axis - second.axis;
  Eigen::Matrix3d rotation;
  rotation.col(first.axis) = first.sign * along.normalized();
  rotation.col(second.axis) = second.sign * normal.normalized();
  rotation.col(third) = rotation.col((third + 1) % 3).cross(rotation.col((third + 2) % 3));
  return {a.body, {rotation, origin.point}};
}

}  // namespace

Placement read_placement(const Element& element, const char* translation, const char* orientation) {
  return {body_fixed_xyz(element.vector_or(orientation, Eigen::Vector3d::Zero())),
          element.vector_or(translation, Eigen::Vector3d::Zero())};
}

std::string Context::parent_by_name(const Element& offset_frame) const {
  std::string owner = offset_frame.node().parent().parent().attribute("name").value();
  if (model.body(owner) >= 0) return owner;
  constexpr std::string_view kSuffix = "_offset";
  std::string stem = offset_frame.name();
  if (!stem.ends_with(kSuffix)) return {};
  stem.resize(stem.size() - kSuffix.size());
  return model.body(stem) >= 0 ? stem : std::string();
}

FrameReference Context::frame(const Element& user, const char* property, std::string_view reference,
                              std::size_t depth) const {
  // A frame may stand in another one; a chain longer than the number of frames is a circle.
  Placement placement;
  std::string wanted(reference);
  pugi::xml_node owner = user.node();
  for (std::size_t hops = depth; hops <= frames.size(); ++hops) {
    const std::string name = last_part(wanted);
    const std::string folder = folder_of(wanted);
    const Element* found = nullptr;
    for (const Element& candidate : frames) {
      if (candidate.name() != name) continue;
      // <frames> or <components> within the object that owns the frame.
      const pugi::xml_node holder = candidate.node().parent().parent();
      const std::string_view holder_name = holder.attribute("name").value();
      const bool local = holder == owner || candidate.node().parent().parent() == owner.parent().parent();
      const bool named = !folder.empty() && folder != ".." && folder == holder_name;
      if (named || (local && (folder.empty() || folder == ".."))) {
        found = &candidate;
        break;
      }
      if (found == nullptr && model.body(name) < 0) found = &candidate;
    }
    const bool is_body = model.body(name) >= 0;
    if (is_body && (found == nullptr || folder == "bodyset")) return {model.body(name), placement};
    if (found == nullptr) {
      user.fail(property, fmt::format("there is no body or frame '{}'{}", reference,
                                      suggestion(name, names_of(model.bodies), 8)));
    }
    if (found->type() == "StationDefinedFrame") {
      const FrameReference at = station_frame(*this, *found, hops);
      return {at.body, at.placement * placement};
    }
    placement = read_placement(*found, "translation", "orientation") * placement;
    wanted = socket(*found, "parent");
    owner = found->node().parent().parent();
    if (wanted.empty()) wanted = parent_by_name(*found);
    if (wanted.empty()) user.fail(property, fmt::format("frame '{}' has no parent", name));
    if (wanted == "..") wanted = owner.attribute("name").value();
  }
  user.fail(property, fmt::format("the frames from '{}' on go round in a circle", reference));
}

FrameReference Context::frame_or_ground(const Element& point) {
  std::string reference = socket(point, "parent_frame");
  if (reference.empty()) reference = point.text_or("body", "");
  if (reference.empty()) {
    warn(point, "says no frame that it is fixed to; the ground is taken");
    reference = "ground";
  }
  return frame(point, "socket_parent_frame", reference);
}

}  // namespace veridyn::muscle::osim
