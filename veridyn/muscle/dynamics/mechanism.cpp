#include "veridyn/muscle/dynamics/mechanism.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
namespace {

bool moves(const TransformAxis& axis) {
  return !axis.several.empty() || (axis.coordinate >= 0 && !axis.function.is_constant());
}

double constant_of(const TransformAxis& axis) { return axis.function.evaluate(0.0).value; }

/// A rotation that takes z to `axis`; the identity for z itself.
Eigen::Matrix3d z_along(const Eigen::Vector3d& axis) {
  if (axis.z() == 1.0) return Eigen::Matrix3d::Identity();
  Eigen::Index least = 0;
  axis.cwiseAbs().minCoeff(&least);
  Eigen::Matrix3d R;
  R.col(2) = axis;
  R.col(0) = Eigen::Vector3d::Unit(least).cross(axis).normalized();
  R.col(1) = axis.cross(R.col(0));
  return R;
}

Eigen::Vector3d unit_axis(const TransformAxis& axis, const Joint& joint) {
  const double length = axis.axis.norm();
  if (!(length > 0.0))
    throw InputError(fmt::format("joint '{}'", joint.name), "an axis of its motion has no direction");
  return axis.axis / length;
}

JointAxis compile(const TransformAxis& from, bool rotational) {
  JointAxis axis;
  axis.coordinate = from.coordinate;
  axis.rotational = rotational;
  if (!from.several.empty()) {
    axis.coordinate = from.several.front();
    axis.linear = false;
    axis.derivatives = 0;  // their place is known when all joints are
    axis.several = from.several;
    axis.function_of_several = from.function_of_several;
    return axis;
  }
  axis.linear = from.function.is_linear();
  const numerics::FunctionValue<double> f = from.function.evaluate(0.0);
  axis.slope = f.slope;
  axis.intercept = f.value;
  axis.function = from.function;
  return axis;
}

/// A translation over the joint's ellipsoid along its axis i.
JointAxis compile_ellipsoid(const Joint& joint, int i) {
  JointAxis axis;
  axis.rotational = axis.linear = false;
  axis.coordinate = joint.rotation[0].coordinate;
  axis.second = joint.rotation[1].coordinate;
  axis.ellipsoid = i;
  axis.slope = joint.ellipsoid_radii(i);
  return axis;
}

/// The joint's moving translations along axes in the frame `base`, and the sum of its constant ones.
Eigen::Vector3d add_translations(const Joint& joint, const Eigen::Matrix3d& base, double sign, Link& link) {
  Eigen::Vector3d constant = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const TransformAxis& translation = joint.translation[i];
    JointAxis axis;
    if (joint.is_ellipsoid()) {
      axis = compile_ellipsoid(joint, static_cast<int>(i));
    } else if (moves(translation)) {
      axis = compile(translation, false);
    } else {
      if (const double amount = constant_of(translation); amount != 0.0)
        constant += sign * amount * (base * unit_axis(translation, joint));
      continue;
    }
    axis.axis = sign * (base * unit_axis(translation, joint));
    link.axes.push_back(std::move(axis));
  }
  return constant;
}

/// Adds one rotation, by `sign` times its amount; `before` are the constant rotations since the last moving one.
void add_rotation(const TransformAxis& rotation, const Joint& joint, double sign, Eigen::Matrix3d& before, Link& link) {
  const auto about = [&] { return Eigen::Vector3d(sign * unit_axis(rotation, joint)); };
  if (moves(rotation)) {
    const Eigen::Matrix3d Z = z_along(about());
    JointAxis axis = compile(rotation, true);
    axis.before = before * Z;
    link.axes.push_back(std::move(axis));
    before = Z.transpose();
  } else if (const double angle = constant_of(rotation); angle != 0.0) {
    before = before * Eigen::AngleAxisd(angle, about()).toRotationMatrix();
  }
}

/// Fills link.axes and link.origin; returns where the child body's frame stands in the link.
///
/// The link's own frame is the one after the last moving rotation, with z along its axis, so that constant rotations
/// after it (and all of them when none moves) become part of the bodies' places and cost nothing.
///
/// A reversed joint moves the parent's frame against the child's by x = T + R x': R' comes first, about the same axes
/// in the other order and sense, then -T along axes that turn with the child's frame.
Placement compile_joint(const Joint& joint, const Placement& parent_in_link, Link& link) {
  const Placement base = parent_in_link * joint.parent_frame;
  link.origin = base.translation;
  Eigen::Matrix3d before = base.rotation;  // constant rotations since the last moving one
  Eigen::Vector3d after = Eigen::Vector3d::Zero();
  if (joint.reversed) {
    for (std::size_t i = 3; i-- > 0;) add_rotation(joint.rotation[i], joint, -1.0, before, link);
    after = add_translations(joint, before, -1.0, link);
  } else {
    link.origin += add_translations(joint, base.rotation, 1.0, link);
    for (const TransformAxis& rotation : joint.rotation) add_rotation(rotation, joint, 1.0, before, link);
  }
  link.simple = link.axes.size() == 1 && link.axes[0].linear && link.coordinates.size() == 1;
  return Placement{before, after} * joint.child_frame.inverse();
}

/// Where the child body stands in the link of its parent when the joint has no coordinates.
Placement weld(const Joint& joint, const Placement& parent_in_link) {
  Link scratch;
  const Placement child = compile_joint(joint, parent_in_link, scratch);
  return Placement{Eigen::Matrix3d::Identity(), scratch.origin} * child;
}

void add_mass(Link& link, const Body& body, const Placement& place) {
  const double total = link.mass + body.mass;
  const Eigen::Matrix3d inertia = place.rotation * body.inertia * place.rotation.transpose();
  link.inertia += inertia;
  if (!(total > 0.0)) return;
  const Eigen::Vector3d center = place * body.mass_center;
  // Two parts about their common centre: the reduced mass at their distance.
  const Eigen::Vector3d d = center - link.mass_center;
  const double reduced = link.mass * body.mass / total;
  link.inertia += reduced * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  link.mass_center = (link.mass * link.mass_center + body.mass * center) / total;
  link.mass = total;
}

void check(const Model& model, const std::vector<int>& joint_of_body) {
  for (std::size_t b = 1; b < model.bodies.size(); ++b) {
    if (joint_of_body[b] < 0) {
      throw InputError(fmt::format("body '{}'", model.bodies[b].name), "no joint connects it to the ground");
    }
    // Follow the parents; more steps than bodies is a circle.
    int body = static_cast<int>(b);
    for (std::size_t steps = 0; body != 0; ++steps) {
      if (steps > model.bodies.size()) {
        throw InputError(
            fmt::format("body '{}'", model.bodies[b].name),
            fmt::format("its joints make a circle that does not reach the ground (joint '{}'): only trees of "
                        "joints are supported",
                        model.joints[joint_of_body[body]].name));
      }
      const int joint = joint_of_body[body];
      if (joint < 0) break;  // reported for that body itself
      body = model.joints[joint].parent;
    }
  }
}

}  // namespace

Mechanism::Mechanism(const Model& model)
    : coordinate_link_(model.coordinates.size(), -1), chain_length_(model.coordinates.size()), gravity_(model.gravity) {
  const std::size_t bodies = model.bodies.size();
  if (bodies == 0) throw InputError(fmt::format("model '{}'", model.name), "it has no ground body");
  std::vector<int> joint_of_body(bodies, -1);
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const Joint& joint = model.joints[j];
    const std::string place = fmt::format("joint '{}'", joint.name);
    if (joint.child <= 0 || at(joint.child) >= bodies || joint.parent < 0 || at(joint.parent) >= bodies) {
      throw InputError(place, "its bodies are not among the model's, or its child is the ground");
    }
    int& of_child = joint_of_body[joint.child];
    if (of_child >= 0) {
      throw InputError(place,
                       fmt::format("body '{}' is moved by joint '{}' already: only trees of joints are supported",
                                   model.bodies[joint.child].name, model.joints[of_child].name));
    }
    of_child = static_cast<int>(j);
    for (int i = 0; i < 6; ++i) {
      const TransformAxis& axis = i < 3 ? joint.rotation[i] : joint.translation[i - 3];
      const auto check_own = [&](int coordinate) {
        if (std::find(joint.coordinates.begin(), joint.coordinates.end(), coordinate) != joint.coordinates.end())
          return;
        const std::string name = coordinate >= 0 && at(coordinate) < model.coordinates.size()
                                     ? model.coordinates[coordinate].name
                                     : std::to_string(coordinate);
        throw InputError(place, fmt::format("it moves by coordinate '{}', which is not its own", name));
      };
      if (axis.coordinate >= 0) check_own(axis.coordinate);
      for (const int coordinate : axis.several) check_own(coordinate);
      if (at(axis.function_of_several.arguments()) != axis.several.size())
        throw InputError(place, fmt::format("a function of {} arguments is given {} coordinates",
                                            axis.function_of_several.arguments(), axis.several.size()));
    }
  }
  check(model, joint_of_body);

  links_.resize(1);
  bodies_.resize(bodies);
  std::vector<bool> placed(bodies, false);
  placed[0] = true;
  add_mass(links_[0], model.bodies[0], {});
  // Bodies in the order of the file, each after its parent.
  for (std::size_t remaining = bodies - 1; remaining > 0;) {
    for (std::size_t b = 1; b < bodies; ++b) {
      if (placed[b]) continue;
      const Joint& joint = model.joints[joint_of_body[b]];
      if (!placed[joint.parent]) continue;
      placed[b] = true;
      --remaining;
      const BodyPlace& parent = bodies_[joint.parent];
      if (joint.coordinates.empty()) {
        bodies_[b] = {parent.link, weld(joint, parent.in_link)};
      } else {
        Link link;
        link.parent = parent.link;
        link.coordinates = joint.coordinates;
        link.ancestors = links_[parent.link].ancestors;
        const Placement child = compile_joint(joint, parent.in_link, link);
        for (const int c : joint.coordinates) {
          if (c < 0 || at(c) >= coordinate_link_.size() || coordinate_link_[c] >= 0) {
            throw InputError(fmt::format("joint '{}'", joint.name),
                             "a coordinate of it is not among the model's or belongs to another joint");
          }
          coordinate_link_[c] = links();
          link.ancestors.push_back(c);
          chain_length_[c] = link.ancestors.size();
          topological_.push_back(c);
        }
        bodies_[b] = {links(), child};
        links_.push_back(std::move(link));
      }
      add_mass(links_[bodies_[b].link], model.bodies[b], bodies_[b].in_link);
    }
  }
  for (std::size_t c = 0; c < coordinate_link_.size(); ++c) {
    if (coordinate_link_[c] < 0) {
      throw InputError(fmt::format("coordinate '{}'", model.coordinates[c].name), "it belongs to no joint");
    }
  }
  int derivatives = 0;
  for (Link& link : links_) {
    for (JointAxis& axis : link.axes) {
      if (axis.several.empty()) continue;
      axis.derivatives = derivatives;
      derivatives += static_cast<int>(axis.several.size() * (axis.several.size() + 1));
    }
  }
  row_.push_back(0);
  for (const std::size_t length : chain_length_) row_.push_back(row_.back() + length);
}

bool Mechanism::moves(int coordinate, int link_index) const {
  const std::span<const int> a = ancestors(link_index);
  return std::find(a.begin(), a.end(), coordinate) != a.end();
}

}  // namespace veridyn::muscle
