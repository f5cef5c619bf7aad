#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "veridyn/muscle/dynamics/spatial.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// Where a link stands: x_G = rotation x_L + position.
template <typename Scalar>
struct Pose {
  Matrix3<Scalar> rotation = Matrix3<Scalar>::Identity();
  Vector3<Scalar> position = Vector3<Scalar>::Zero();

  /// Ground position of a point fixed in the link.
  [[nodiscard]] Vector3<Scalar> operator*(const Eigen::Vector3d& point) const {
    return rotation * point.template cast<Scalar>() + position;
  }
};

/// One moving axis of a joint, compiled. A rotation turns the frame `before` (which has its z along the axis) about z,
/// so that it mixes two columns of a matrix only.
struct JointAxis {
  int coordinate = 0;
  bool rotational = true;
  bool linear = true;  ///< amount = slope q + intercept; else `function`
  double slope = 1.0;
  double intercept = 0.0;
  numerics::PiecewisePolynomial function;
  /// Of a translation over an ellipsoid: which component of n = (sin b, -sin a cos b, cos a cos b), the third axis of a
  /// body-fixed x-y-z sequence of angles a = `coordinate`, b = `second`; amount = slope n(ellipsoid). -1: none.
  int ellipsoid = -1;
  int second = -1;
  /// Of several coordinates: amount = function_of_several of them, `coordinate` is the first one, and derivatives begin
  /// there in Kinematics::of_several. -1: of one.
  int derivatives = -1;
  std::vector<int> several{};
  numerics::MultivariatePolynomial function_of_several{};
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();       ///< of a translation, in the frame after the axis before it
  Eigen::Matrix3d before = Eigen::Matrix3d::Identity();  ///< of a rotation, in the frame after the rotation before it
};

/// Bodies that are welded together and move as one; link 0 is the ground with all that is welded to it.
struct Link {
  int parent = -1;                                   ///< always a smaller number than the link's own; -1 for the ground
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the joint at zero translation, in the parent link [m]
  std::vector<JointAxis> axes;   ///< translations, then rotations; of a reversed joint the other way
  std::vector<int> coordinates;  ///< of its joint
  /// Coordinates between the ground and this link, the ground's side first, its own joint's included.
  std::vector<int> ancestors;
  bool simple = false;                                    ///< one axis with a linear function: the usual pin or slider
  double mass = 0.0;                                      ///< of all its bodies [kg]
  Eigen::Vector3d mass_center = Eigen::Vector3d::Zero();  ///< in the link frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();      ///< about the mass centre, link axes [kg m^2]
};

/// A model's bodies and joints, compiled for computation: a tree of links in topological order.
///
/// Immutable and without reference to the model; used by many threads at once. Coordinates keep the numbers they have
/// in the model, and each belongs to one joint.
class Mechanism {
 public:
  /// @throws InputError naming the elements when joints make a circle, two joints move one body, a body is on no
  /// joint, or a joint uses the coordinate of another.
  explicit Mechanism(const Model& model);

  /// Where a body of the model is.
  struct BodyPlace {
    int link = 0;
    Placement in_link;
  };

  [[nodiscard]] int links() const { return static_cast<int>(links_.size()); }
  [[nodiscard]] int coordinates() const { return static_cast<int>(coordinate_link_.size()); }
  [[nodiscard]] const Link& link(int index) const { return links_[index]; }
  /// The link that carries a body of the model, and the body's frame in it.
  [[nodiscard]] const BodyPlace& body(int index) const { return bodies_[index]; }
  /// The link whose joint a coordinate belongs to: it and the links beyond it move.
  [[nodiscard]] int link_of_coordinate(int coordinate) const { return coordinate_link_[coordinate]; }
  /// Coordinates that move this link, the ground's side first.
  [[nodiscard]] std::span<const int> ancestors(int link_index) const { return link(link_index).ancestors; }
  [[nodiscard]] bool moves(int coordinate, int link_index) const;
  /// Coordinates that move what this coordinate moves, ground's side first; this one is the last. Every shorter
  /// beginning of it is the same list of the coordinate it ends with.
  [[nodiscard]] std::span<const int> chain(int coordinate) const {
    return {links_[coordinate_link_[coordinate]].ancestors.data(), chain_length_[coordinate]};
  }
  /// Where the row of this coordinate begins when rows as long as their chains are stored one after another; the total
  /// for `coordinates()`.
  [[nodiscard]] std::size_t row(int coordinate) const { return row_[coordinate]; }
  [[nodiscard]] const Eigen::Vector3d& gravity() const { return gravity_; }
  /// All coordinates, ground's side first.
  [[nodiscard]] std::span<const int> topological_coordinates() const { return topological_; }

 private:
  std::vector<Link> links_;
  std::vector<BodyPlace> bodies_;
  std::vector<int> coordinate_link_;
  std::vector<int> topological_;
  std::vector<std::size_t> chain_length_;
  std::vector<std::size_t> row_;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
};

/// Positions and velocities of a mechanism's links: a workspace, made once and filled by the functions below.
template <typename Scalar>
struct Kinematics {
  explicit Kinematics(const Mechanism& mechanism);

  /// By link, in ground. [0] is the identity.
  std::vector<Pose<Scalar>> pose;
  /// By coordinate: motion of its link (and of all beyond) per unit of the coordinate's speed. A point P (ground
  /// position) of such a link moves with columns[k].angular x P + columns[k].linear.
  std::vector<SpatialVector<Scalar>> columns;

  /// By link, after `update_velocities`.
  std::vector<SpatialVector<Scalar>> velocity;
  /// By link: the part of its acceleration relative to the parent's that is there without coordinate accelerations,
  /// sum_k d(columns[k])/dt qdot_k. Spatial, so without the centripetal term of a point; see
  /// `point_acceleration`.
  std::vector<SpatialVector<Scalar>> velocity_bias;

  /// One moving axis of a joint that is not simple: its unit motion, and its function's derivatives.
  struct AxisMotion {
    SpatialVector<Scalar> unit;
    Scalar slope{};
    Scalar curvature{};
    Scalar slope_2{}, curvature_2{}, mixed{};  ///< by the second coordinate of an ellipsoid, twice, and by both
  };
  std::vector<AxisMotion> axis_motion;  ///< of all such joints, link after link
  std::vector<Scalar> of_several;       ///< of axes with several coordinates: gradients, each with its Hessian after it
};

/// Fills `pose` and `columns` for coordinates q (one per coordinate of the mechanism, rad or m). Does not allocate.
template <typename Scalar>
void update_positions(const Mechanism& mechanism, const Scalar* q, Kinematics<Scalar>& kinematics);

/// Fills `velocity` and `velocity_bias` for the speeds qdot, after `update_positions`. Does not allocate.
template <typename Scalar>
void update_velocities(const Mechanism& mechanism, const Scalar* qdot, Kinematics<Scalar>& kinematics);

/// Ground position and orientation of a body of the model.
template <typename Scalar>
[[nodiscard]] Pose<Scalar> body_pose(const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, int body) {
  const Mechanism::BodyPlace& place = mechanism.body(body);
  const Pose<Scalar>& link = kinematics.pose[place.link];
  return {link.rotation * place.in_link.rotation.cast<Scalar>(), link * place.in_link.translation};
}

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
Kinematics<Scalar>::Kinematics(const Mechanism& mechanism)
    : pose(static_cast<std::size_t>(mechanism.links())),
      columns(static_cast<std::size_t>(mechanism.coordinates())),
      velocity(pose.size()),
      velocity_bias(pose.size()) {
  std::size_t n = 0, derivatives = 0;
  for (int i = 1; i < mechanism.links(); ++i) {
    if (!mechanism.link(i).simple) n += mechanism.link(i).axes.size();
    for (const JointAxis& axis : mechanism.link(i).axes) derivatives += axis.several.size() * (axis.several.size() + 1);
  }
  axis_motion.resize(n);
  of_several.resize(derivatives);
}

namespace internal {

/// Products with constants: half the work for Jets.
template <typename Scalar>
Vector3<Scalar> rotate(const Matrix3<Scalar>& R, const Eigen::Vector3d& v) {
  return R.col(0) * v.x() + R.col(1) * v.y() + R.col(2) * v.z();
}
template <typename Scalar>
Matrix3<Scalar> rotate(const Matrix3<Scalar>& R, const Eigen::Matrix3d& A) {
  Matrix3<Scalar> product;
  for (int i = 0; i < 3; ++i) product.col(i) = R.col(0) * A(0, i) + R.col(1) * A(1, i) + R.col(2) * A(2, i);
  return product;
}

/// Amount of a translation over an ellipsoid: returns its value, fills derivatives.
template <typename Scalar, typename Motion>
Scalar over_ellipsoid(const JointAxis& axis, const Scalar* q, Motion& motion) {
  using std::cos;
  using std::sin;
  const Scalar &a = q[axis.coordinate], &b = q[axis.second];
  const Scalar sa = sin(a), ca = cos(a), cb = Scalar(axis.slope) * cos(b);
  Scalar sb = Scalar(axis.slope) * sin(b);
  if (axis.ellipsoid == 0) {
    motion.slope = motion.curvature = motion.mixed = Scalar(0.0);
    motion.slope_2 = cb;
    motion.curvature_2 = -sb;
    return sb;
  }
  // -sin a cos b; with a + 90 deg in place of a, whose sine is cos a, the third component is -1 times it.
  const bool third = axis.ellipsoid == 2;
  const Scalar s = third ? -ca : sa, c = third ? sa : ca;
  motion.slope = -c * cb;
  motion.slope_2 = s * sb;
  motion.curvature = s * cb;
  motion.mixed = c * sb;
  motion.curvature_2 = s * cb;
  return -s * cb;
}

/// Amount of an axis with several coordinates: returns its value, fills derivatives.
template <typename Scalar>
Scalar by_several(const JointAxis& axis, const Scalar* q, Kinematics<Scalar>& k) {
  Scalar x[numerics::MultivariatePolynomial::kMostArguments];
  const std::size_t n = axis.several.size();
  for (std::size_t i = 0; i < n; ++i) x[i] = q[axis.several[i]];
  Scalar* const gradient = k.of_several.data() + axis.derivatives;
  return axis.function_of_several.evaluate(x, gradient, gradient + n);
}

/// Adds what an axis with several coordinates moves by at the speeds qdot: to its rate, and to the part of its
/// acceleration that is there without those of coordinates.
template <typename Scalar>
void add_rates_of_several(const JointAxis& axis, const Scalar* qdot, const Kinematics<Scalar>& k, Scalar& rate,
                          Scalar& bend) {
  const std::size_t n = axis.several.size();
  const Scalar* const gradient = k.of_several.data() + axis.derivatives;
  const Scalar* row = gradient + n;
  for (std::size_t i = 0; i < n; ++i, row += n) {
    rate += gradient[i] * qdot[axis.several[i]];
    for (std::size_t j = 0; j < n; ++j) bend += row[j] * qdot[axis.several[i]] * qdot[axis.several[j]];
  }
}

/// frame Rz(angle)
template <typename Scalar>
void turn_about_z(const Matrix3<Scalar>& frame, const Scalar& angle, Matrix3<Scalar>& turned) {
  using std::cos;
  using std::sin;
  const Scalar s = sin(angle), c = cos(angle);
  for (int i = 0; i < 3; ++i) {
    turned(i, 0) = c * frame(i, 0) + s * frame(i, 1);
    turned(i, 1) = c * frame(i, 1) - s * frame(i, 0);
    turned(i, 2) = frame(i, 2);
  }
}

}  // namespace internal

template <typename Scalar>
void update_positions(const Mechanism& mechanism, const Scalar* q, Kinematics<Scalar>& k) {
  auto* motion = k.axis_motion.data();
  for (int i = 1; i < mechanism.links(); ++i) {
    const Link& link = mechanism.link(i);
    const Pose<Scalar>& parent = k.pose[link.parent];
    Pose<Scalar>& pose = k.pose[i];
    const bool grounded = link.parent == 0;  // nothing to turn
    if (grounded) {
      pose.position = link.origin.cast<Scalar>();
    } else {
      pose.position = parent.position + internal::rotate(parent.rotation, link.origin);
    }
    if (link.simple) {
      const JointAxis& axis = link.axes[0];
      SpatialVector<Scalar>& column = k.columns[axis.coordinate];
      const Scalar amount = axis.slope * q[axis.coordinate] + axis.intercept;
      if (axis.rotational) {
        if (grounded) {
          internal::turn_about_z(Matrix3<Scalar>(axis.before.cast<Scalar>()), amount, pose.rotation);
        } else {
          internal::turn_about_z(internal::rotate(parent.rotation, axis.before), amount, pose.rotation);
        }
        column.angular = axis.slope * pose.rotation.col(2);
        column.linear = pose.position.cross(column.angular);
      } else {
        pose.rotation = parent.rotation;
        column.linear = internal::rotate(parent.rotation, axis.axis);
        pose.position += amount * column.linear;
        column.linear *= Scalar(axis.slope);
      }
      continue;
    }
    auto* const first = motion;
    pose.rotation = parent.rotation;
    for (const JointAxis& axis : link.axes) {
      numerics::FunctionValue<Scalar> f;
      const Scalar& x = q[axis.coordinate];
      if (axis.ellipsoid >= 0) {
        f.value = internal::over_ellipsoid(axis, q, *motion);
      } else if (axis.derivatives >= 0) {
        f.value = internal::by_several(axis, q, k);
        motion->slope = motion->curvature = Scalar(0.0);
      } else {
        if (axis.linear) {
          f = {axis.slope * x + axis.intercept, Scalar(axis.slope), Scalar(0.0)};
        } else {
          f = axis.function.evaluate(x);
        }
        motion->slope = f.slope;
        motion->curvature = f.curvature;
      }
      if (axis.rotational) {
        // The axis passes through the position so far, whatever comes after it.
        internal::turn_about_z(internal::rotate(pose.rotation, axis.before), f.value, pose.rotation);
        motion->unit.angular = pose.rotation.col(2);
        motion->unit.linear = pose.position.cross(motion->unit.angular);
      } else {
        motion->unit.linear = internal::rotate(pose.rotation, axis.axis);
        pose.position += f.value * motion->unit.linear;
      }
      ++motion;
    }
    for (const int c : link.coordinates) k.columns[c] = {};
    const auto* m = first;
    for (const JointAxis& axis : link.axes) {
      k.columns[axis.coordinate].add_scaled(m->slope, m->unit);
      if (axis.ellipsoid >= 0) k.columns[axis.second].add_scaled(m->slope_2, m->unit);
      for (std::size_t j = 0; j < axis.several.size(); ++j)
        k.columns[axis.several[j]].add_scaled(k.of_several[static_cast<std::size_t>(axis.derivatives) + j], m->unit);
      ++m;
    }
  }
}

template <typename Scalar>
void update_velocities(const Mechanism& mechanism, const Scalar* qdot, Kinematics<Scalar>& k) {
  const auto* motion = k.axis_motion.data();
  for (int i = 1; i < mechanism.links(); ++i) {
    const Link& link = mechanism.link(i);
    const SpatialVector<Scalar>& parent = k.velocity[link.parent];
    SpatialVector<Scalar>& V = k.velocity[i];
    SpatialVector<Scalar>& bias = k.velocity_bias[i];
    if (link.simple) {
      const int c = link.axes[0].coordinate;
      const SpatialVector<Scalar>& column = k.columns[c];
      const SpatialVector<Scalar> relative{column.angular * qdot[c], column.linear * qdot[c]};
      if (link.parent == 0) {
        V = relative;
        continue;
      }
      bias = cross_motion(parent, relative);
      V.angular = parent.angular + relative.angular;
      V.linear = parent.linear + relative.linear;
      continue;
    }
    // Each axis is carried by the motion of those before it: d(unit)/dt = V_before x unit.
    V = parent;
    bias = {};
    for (const JointAxis& axis : link.axes) {
      const Scalar& speed = qdot[axis.coordinate];
      Scalar rate = motion->slope * speed, bend = motion->curvature * speed * speed;
      if (axis.ellipsoid >= 0) {
        const Scalar& other = qdot[axis.second];
        rate += motion->slope_2 * other;
        bend += (motion->curvature_2 * other + motion->mixed * speed * Scalar(2.0)) * other;
      } else if (axis.derivatives >= 0) {
        internal::add_rates_of_several(axis, qdot, k, rate, bend);
      }
      bias.add_scaled(rate, cross_motion(V, motion->unit));
      bias.add_scaled(bend, motion->unit);
      V.add_scaled(rate, motion->unit);
      ++motion;
    }
  }
}

/// Compiled once, in dynamics.cpp.
extern template void update_positions(const Mechanism&, const double*, Kinematics<double>&);
/// Compiled once, in dynamics.cpp.
extern template void update_velocities(const Mechanism&, const double*, Kinematics<double>&);

}  // namespace veridyn::muscle
