#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/body_force.hpp"
#include "veridyn/muscle/model/scalar.hpp"

/// Forces between bodies: springs from point to point, bushings, contact of a sphere with a half space. Their laws are
/// OpenSim 4.5's. Each is added to generalised forces or to forces by link, see `add_force_at`. Nothing allocates or
/// throws; kinematics need `update_velocities`.
namespace veridyn::muscle {

/// Adds the generalised forces of `wrench`, which acts on a link, by coordinate.
template <typename Scalar>
void add_wrench(const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, int link,
                const SpatialVector<Scalar>& wrench, Scalar* tau) {
  for (const int c : mechanism.ancestors(link)) tau[c] += kinematics.columns[c].dot(wrench);
}

/// Adds `wrench` itself, by link.
template <typename Scalar>
void add_wrench(const Mechanism& /*mechanism*/, const Kinematics<Scalar>& /*kinematics*/, int link,
                const SpatialVector<Scalar>& wrench, SpatialVector<Scalar>* by_link) {
  by_link[link] += wrench;
}

/// Adds `force`, which acts on a link at a ground position together with a moment, to generalised forces by coordinate
/// (`to` of scalars) or to forces by link (`to` of spatial vectors).
template <typename Scalar, typename Receiver>
void add_force_at(const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, int link,
                  const Vector3<Scalar>& point, const Vector3<Scalar>& force, const Vector3<Scalar>& moment,
                  Receiver* to) {
  add_wrench(mechanism, kinematics, link, SpatialVector<Scalar>{moment + point.cross(force), force}, to);
}

/// A frame fixed to a body, in ground, and how its link moves.
template <typename Scalar>
struct MovingFrame {
  int link = 0;
  Matrix3<Scalar> rotation;
  Vector3<Scalar> position;
  const SpatialVector<Scalar>* velocity = nullptr;
};

/// Where a frame of a body is, and the link that it moves with.
template <typename Scalar>
MovingFrame<Scalar> moving_frame(const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, int body,
                                 const Placement& in_body) {
  const Mechanism::BodyPlace& place = mechanism.body(body);
  const Placement in_link = place.in_link * in_body;
  const Pose<Scalar>& pose = kinematics.pose[place.link];
  return {place.link, pose.rotation * in_link.rotation.cast<Scalar>(), pose * in_link.translation,
          &kinematics.velocity[place.link]};
}

/// A pull between a point of each of two bodies, as the members body_1, point_1, body_2, point_2 of `ends` say:
/// `tension(distance, rate)` [N]. None while the points coincide.
template <typename Ends, typename Scalar, typename Receiver, typename Tension>
void add_pull(const Ends& ends, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
              const Tension& tension, Receiver* to) {
  using std::sqrt;
  const auto a = moving_frame(mechanism, kinematics, ends.body_1, {.translation = ends.point_1});
  const auto b = moving_frame(mechanism, kinematics, ends.body_2, {.translation = ends.point_2});
  const Vector3<Scalar> between = b.position - a.position;
  const Scalar square = between.squaredNorm();
  if (!(value_of(square) > 0.0)) return;
  const Scalar distance = sqrt(square);
  const Vector3<Scalar> along = between / distance;
  const Scalar rate = along.dot(b.velocity->at(b.position) - a.velocity->at(a.position));
  const Vector3<Scalar> pull = along * Scalar(tension(distance, rate));
  const Vector3<Scalar> none = Vector3<Scalar>::Zero();
  add_force_at<Scalar>(mechanism, kinematics, a.link, a.position, pull, none, to);
  add_force_at<Scalar>(mechanism, kinematics, b.link, b.position, -pull, none, to);
}

/// Spring from point to point: tension stiffness (distance - rest_length).
template <typename Scalar, typename Receiver>
void add_force(const PointSpring& spring, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
               Receiver* to) {
  const auto tension = [&](const Scalar& distance, const Scalar& /*rate*/) -> Scalar {
    return (distance - Scalar(spring.rest_length)) * Scalar(spring.stiffness);
  };
  add_pull(spring, mechanism, kinematics, tension, to);
}

/// Bushing: of frame 2 in frame 1, angles t of a body-fixed x-y-z sequence and translation d are held by springs and
/// linear dampers, f = -k(t, d) - C (t', d'). With t' = N w (w the relative angular velocity in frame 2) the moment is
/// N' f_t, so that the energy of springs that each resist one deflection is the sum of the integrals of k. Singular at
/// a second angle of 90 deg.
///
/// `resist(t, d, torque, push)` takes what springs do off the generalised forces of the angles and of the translation.
template <typename Scalar, typename Receiver, typename Resist>
void add_bushing(const Bushing& bushing, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
                 const Resist& resist, Receiver* to) {
  using std::asin;
  using std::atan2;
  using std::cos;
  using std::sin;
  const auto one = moving_frame(mechanism, kinematics, bushing.body_1, bushing.frame_1);
  const auto two = moving_frame(mechanism, kinematics, bushing.body_2, bushing.frame_2);
  const Matrix3<Scalar> R = one.rotation.transpose() * two.rotation;
  const Vector3<Scalar> d = one.rotation.transpose() * (two.position - one.position);
  const Scalar& sine = R(0, 2);
  const Vector3<Scalar> t(atan2(Scalar(-R(1, 2)), R(2, 2)), asin(sine), atan2(Scalar(-R(0, 1)), R(0, 0)));
  const Vector3<Scalar> spin = two.rotation.transpose() * (two.velocity->angular - one.velocity->angular);
  const Vector3<Scalar> slide =
      one.rotation.transpose() * (two.velocity->at(two.position) - one.velocity->at(two.position));
  const Scalar cz = cos(t.z()), sz = sin(t.z()), per_cy = Scalar(1.0) / cos(t.y());
  Matrix3<Scalar> N;
  N << cz * per_cy, -sz * per_cy, Scalar(0.0), sz, cz, Scalar(0.0), -cz * sine * per_cy, sz * sine * per_cy,
      Scalar(1.0);
  const Vector3<Scalar> rates = N * spin;
  Vector3<Scalar> torque = -rates.cwiseProduct(bushing.rotational_damping.cast<Scalar>().eval());
  Vector3<Scalar> push = -slide.cwiseProduct(bushing.translational_damping.cast<Scalar>().eval());
  resist(t, d, torque, push);
  const Vector3<Scalar> force = one.rotation * push;
  const Vector3<Scalar> moment = two.rotation * Vector3<Scalar>(N.transpose() * torque);
  add_force_at<Scalar>(mechanism, kinematics, two.link, two.position, force, moment, to);
  add_force_at<Scalar>(mechanism, kinematics, one.link, two.position, -force, -moment, to);
}

/// With springs that each resist one deflection.
template <typename Scalar, typename Receiver>
void add_force(const Bushing& bushing, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, Receiver* to) {
  add_bushing(
      bushing, mechanism, kinematics,
      [&](const Vector3<Scalar>& t, const Vector3<Scalar>& d, Vector3<Scalar>& torque, Vector3<Scalar>& push) {
        for (int i = 0; i < 3; ++i) {
          torque(i) -= bushing.resistance[i].evaluate(t(i)).value;
          push(i) -= bushing.resistance[i + 3].evaluate(d(i)).value;
        }
      },
      to);
}

/// Hertz's force of a sphere and a half space, 4/3 k sqrt(R k) depth^(3/2) with k = stiffness^(2/3)/2 [N].
template <typename Scalar>
Scalar hertz_force(const SphereContact& contact, const Scalar& depth) {
  using std::sqrt;
  const double k = contact.half_stiffness;
  return depth * sqrt(depth) * Scalar(4.0 / 3.0 * k * std::sqrt(contact.radius * k));
}

/// What a sphere and a half space do to each other.
template <typename Scalar>
struct ContactForce {
  int sphere_link = 0, plane_link = 0;
  Vector3<Scalar> point = Vector3<Scalar>::Zero();  ///< where it acts, in ground [m]
  Vector3<Scalar> force = Vector3<Scalar>::Zero();  ///< on the sphere's body, in ground [N]; its opposite on the other
  bool touches = false;
};

/// Contact of a sphere with a half space. Normal force as Hunt & Crossley (1975) have it, f = f_H (1 + 3/2 c v) with v
/// the speed of approach, never a pull; friction f (min(s/s_t, 1) (u_d + 2 (u_s - u_d)/(1 + (s/s_t)^2)) + u_v s)
/// against the slip s. With `smooth` the form of Serrancoli et al. (2019), whose steps are hyperbolic tangents.
template <typename Scalar>
ContactForce<Scalar> contact_force(const SphereContact& contact, const Mechanism& mechanism,
                                   const Kinematics<Scalar>& kinematics) {
  using std::sqrt;
  using std::tanh;
  const auto sphere = moving_frame(mechanism, kinematics, contact.sphere_body, {.translation = contact.center});
  const auto plane = moving_frame(mechanism, kinematics, contact.plane_body, contact.plane);
  const Vector3<Scalar> normal = -plane.rotation.col(0);  // the half space is where x > 0
  const Scalar depth = Scalar(contact.radius) - normal.dot(sphere.position - plane.position);
  const bool touches = value_of(depth) > 0.0;
  ContactForce<Scalar> found{sphere.link, plane.link};
  found.point = sphere.position - normal * (Scalar(contact.radius) - depth * Scalar(0.5));
  if (!touches && !contact.smooth) return found;
  const Vector3<Scalar> slip = sphere.velocity->at(found.point) - plane.velocity->at(found.point);
  const Scalar approach = -normal.dot(slip);
  const Vector3<Scalar> sideways = slip + normal * approach;
  Scalar force, speed;
  if (contact.smooth) {
    const double small = contact.constant_force;
    const Scalar positive = sqrt(depth * depth + Scalar(small));
    const Scalar step = Scalar(0.5) + tanh(depth * contact.hertz_smoothing) * 0.5;
    force = hertz_force(contact, positive) * step * (Scalar(1.0) + approach * (1.5 * contact.dissipation));
    if (contact.dissipation > 0.0)
      force *= Scalar(0.5) +
               tanh((approach + Scalar(2.0 / (3.0 * contact.dissipation))) * contact.hunt_crossley_smoothing) * 0.5;
    speed = sqrt(sideways.squaredNorm() + Scalar(small));
  } else {
    force = hertz_force(contact, depth) * (Scalar(1.0) + approach * (1.5 * contact.dissipation));
    if (!(value_of(force) > 0.0)) return found;
    speed = sqrt(sideways.squaredNorm() + Scalar(1e-20));
  }
  const Scalar relative = speed / contact.transition_velocity;
  const Scalar grip = relative < Scalar(1.0) ? relative : Scalar(1.0);
  const Scalar friction =
      grip * (Scalar(contact.dynamic_friction) + Scalar(2.0 * (contact.static_friction - contact.dynamic_friction)) /
                                                     (Scalar(1.0) + relative * relative)) +
      speed * contact.viscous_friction;
  found.force = normal * force - sideways * (force * friction / speed);
  found.touches = true;
  return found;
}

/// Adds it to both bodies.
template <typename Scalar, typename Receiver>
void add_force(const SphereContact& contact, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
               Receiver* to) {
  const ContactForce<Scalar> found = contact_force(contact, mechanism, kinematics);
  if (!found.touches) return;
  const Vector3<Scalar> none = Vector3<Scalar>::Zero();
  add_force_at<Scalar>(mechanism, kinematics, found.sphere_link, found.point, found.force, none, to);
  add_force_at<Scalar>(mechanism, kinematics, found.plane_link, found.point, -found.force, none, to);
}

/// Adds all.
template <typename Scalar, typename Receiver>
void add_body_forces(const BodyForces& forces, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
                     Receiver* to) {
  for (const PointSpring& spring : forces.springs) add_force(spring, mechanism, kinematics, to);
  for (const Bushing& bushing : forces.bushings) add_force(bushing, mechanism, kinematics, to);
  for (const SphereContact& contact : forces.contacts) add_force(contact, mechanism, kinematics, to);
}

}  // namespace veridyn::muscle
