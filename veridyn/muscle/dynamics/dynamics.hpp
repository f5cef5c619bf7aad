#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "veridyn/muscle/dynamics/mechanism.hpp"

/// Dynamics of a tree of links, M(q) qddot + h(q, qdot) = tau, h with gravity, by Featherstone's recursive algorithms
/// (Rigid Body Dynamics Algorithms, 2008, chapters 5 to 8) with everything in ground axes.
///
/// One `Dynamics` is the workspace of one thread. `set_state` computes what all of them share; then any of the others
/// in any order. Nothing allocates or throws. Coordinates that are coupled, locked or prescribed are treated as free
/// here: see `coordinate_reduction.hpp`.
namespace veridyn::muscle {

/// Whether a mass matrix could be factorised.
struct Factorization {
  /// A coordinate along which nothing has inertia (a massless body at the end of a chain, two coordinates that move the
  /// same way); -1: none.
  int singular_coordinate = -1;
  [[nodiscard]] bool usable() const { return singular_coordinate < 0; }
};

/// View of a mechanism, which must outlive it: a workspace for the dynamics of one state at a time.
template <typename Scalar>
class Dynamics {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit Dynamics(const Mechanism& mechanism);

  /// Poses, velocities and inertias in ground for coordinates q and speeds qdot (as many as coordinates).
  void set_state(const Scalar* q, const Scalar* qdot);

  [[nodiscard]] const Mechanism& mechanism() const { return *mechanism_; }
  [[nodiscard]] const Kinematics<Scalar>& kinematics() const { return kinematics_; }

  /// tau = M qddot + h - (applied forces), by recursive Newton-Euler; 2 passes over the links. `applied`, by link, are
  /// forces with their moments about the ground's origin; nullptr: none. `qddot` nullptr: zero.
  void inverse_dynamics(const Scalar* qddot, const SpatialVector<Scalar>* applied, Scalar* tau);

  /// Rows of the mass matrix by the composite rigid body algorithm, in the layout of Mechanism::row.
  void update_mass_rows();
  /// M(a, b) for a coordinate b on the chain of a, after `update_mass_rows`.
  [[nodiscard]] const Scalar* mass_row(int coordinate) const { return rows_.data() + mechanism_->row(coordinate); }
  /// What M(c, c) was summed from, without cancellation, after `update_mass_rows`: pivots below `kSingularPivot` of it
  /// are rounding.
  [[nodiscard]] Scalar mass_scale(int coordinate) const {
    return pivot_scale(kinematics_.columns[coordinate], composite_[mechanism_->link_of_coordinate(coordinate)]);
  }
  /// After `inverse_dynamics`: acceleration of a link (of the ground: minus gravity), and the force that its joint
  /// passes on, that of the links beyond it included.
  [[nodiscard]] const SpatialVector<Scalar>& acceleration(int link) const { return acceleration_[link]; }
  [[nodiscard]] const SpatialVector<Scalar>& joint_force(int link) const { return force_[link]; }
  /// After `set_state`: a link's inertia in ground.
  [[nodiscard]] RigidInertia<Scalar> link_inertia(int link) const {
    return RigidInertia<Scalar>::of(mechanism_->link(link).mass, center_[link], inertia_[link]);
  }

  /// The whole symmetric matrix. Calls `update_mass_rows`.
  void mass_matrix(Matrix& M);

  /// Solves M x = b in place by M = L' D L along the tree, without fill-in, after `update_mass_rows`, whose rows it
  /// overwrites. Coordinates with `fixed` (by coordinate; nullptr: none) are left out of the equations; their x is 0.
  Factorization solve_mass(const char* fixed, Scalar* x);

  /// qddot for the coordinate forces tau, by articulated bodies.
  Factorization forward_dynamics_articulated(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* qddot);
  /// The same by factorising the mass matrix.
  Factorization forward_dynamics_factorized(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* qddot);
  /// The faster of the two at every size that was measured (bench/muscle/multibody_bench.cpp).
  Factorization forward_dynamics(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* qddot) {
    return forward_dynamics_factorized(tau, applied, qddot);
  }

  /// [J]
  [[nodiscard]] Scalar kinetic_energy() const;
  /// -m g . c of all links but the ground; zero with all mass centres at the ground's origin [J]
  [[nodiscard]] Scalar potential_energy() const;
  /// Linear momentum [N s], and angular momentum about the ground's origin [N m s].
  [[nodiscard]] SpatialVector<Scalar> momentum() const;

  /// Smallest pivot of a factorisation that counts as inertia, relative to the numbers it was made of.
  static constexpr double kSingularPivot = 1e-12;

 private:
  [[nodiscard]] static Scalar pivot_scale(const SpatialVector<Scalar>& S, const RigidInertia<Scalar>& I) {
    return I.inertia.trace() * S.angular.squaredNorm() + I.mass * S.linear.squaredNorm();
  }
  void update_composite();

  using Vector6 = Eigen::Matrix<Scalar, 6, 1>;
  using Matrix6 = Eigen::Matrix<Scalar, 6, 6>;
  [[nodiscard]] static Vector6 stacked(const SpatialVector<Scalar>& v) {
    Vector6 x;
    x << v.angular, v.linear;
    return x;
  }

  const Mechanism* mechanism_;
  Kinematics<Scalar> kinematics_;
  // By link: mass centre and inertia about it in ground, forces, composite inertias.
  std::vector<Vector3<Scalar>> center_;
  std::vector<Symmetric3<Scalar>> inertia_;
  std::vector<SpatialVector<Scalar>> acceleration_;
  std::vector<SpatialVector<Scalar>> force_;
  std::vector<RigidInertia<Scalar>> composite_;
  std::vector<Scalar> rows_;
  std::vector<Scalar> work_;
  // Articulated bodies: by link, and by coordinate.
  std::vector<Matrix6> articulated_;
  std::vector<Vector6> articulated_force_;
  std::vector<Vector6> articulated_column_;
  std::vector<Scalar> pivot_;
};

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
Dynamics<Scalar>::Dynamics(const Mechanism& mechanism)
    : mechanism_(&mechanism),
      kinematics_(mechanism),
      center_(kinematics_.pose.size(), Vector3<Scalar>::Zero()),
      inertia_(kinematics_.pose.size()),
      acceleration_(kinematics_.pose.size()),
      force_(kinematics_.pose.size()),
      composite_(kinematics_.pose.size()),
      rows_(mechanism.row(mechanism.coordinates())),
      work_(kinematics_.columns.size()),
      articulated_(kinematics_.pose.size()),
      articulated_force_(kinematics_.pose.size()),
      articulated_column_(kinematics_.columns.size()),
      pivot_(kinematics_.columns.size()) {}

template <typename Scalar>
void Dynamics<Scalar>::set_state(const Scalar* q, const Scalar* qdot) {
  update_positions(*mechanism_, q, kinematics_);
  update_velocities(*mechanism_, qdot, kinematics_);
  for (std::size_t i = 1; i < center_.size(); ++i) {
    const Link& link = mechanism_->link(static_cast<int>(i));
    const Pose<Scalar>& pose = kinematics_.pose[i];
    const Matrix3<Scalar>& R = pose.rotation;
    center_[i] = pose.position + internal::rotate(R, link.mass_center);
    // R I R', its upper half
    const Matrix3<Scalar> RI = internal::rotate(R, link.inertia);
    const auto entry = [&](int a, int b) { return RI(a, 0) * R(b, 0) + RI(a, 1) * R(b, 1) + RI(a, 2) * R(b, 2); };
    inertia_[i] = {entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)};
  }
}

template <typename Scalar>
void Dynamics<Scalar>::inverse_dynamics(const Scalar* qddot, const SpatialVector<Scalar>* applied, Scalar* tau) {
  // Gravity as an upward acceleration of the ground.
  acceleration_[0].linear = -mechanism_->gravity().cast<Scalar>();
  const std::size_t links = center_.size();
  for (std::size_t i = 1; i < links; ++i) {
    const Link& link = mechanism_->link(static_cast<int>(i));
    SpatialVector<Scalar>& A = acceleration_[i];
    A = acceleration_[link.parent];
    A += kinematics_.velocity_bias[i];
    if (qddot != nullptr) {
      for (const int c : link.coordinates) A.add_scaled(qddot[c], kinematics_.columns[c]);
    }
    // Newton and Euler at the mass centre, then the moment about the ground's origin.
    const Vector3<Scalar>& w = kinematics_.velocity[i].angular;
    const Vector3<Scalar>& c = center_[i];
    const Vector3<Scalar> v = kinematics_.velocity[i].at(c);
    SpatialVector<Scalar>& F = force_[i];
    F.linear = link.mass * (A.at(c) + w.cross(v));
    const Vector3<Scalar> Iw = inertia_[i] * w;
    F.angular = inertia_[i] * A.angular + w.cross(Iw) + c.cross(F.linear);
    if (applied != nullptr) {
      F.angular -= applied[i].angular;
      F.linear -= applied[i].linear;
    }
  }
  for (std::size_t i = links - 1; i >= 1; --i) {
    const Link& link = mechanism_->link(static_cast<int>(i));
    for (const int c : link.coordinates) tau[c] = kinematics_.columns[c].dot(force_[i]);
    if (link.parent > 0) force_[link.parent] += force_[i];
  }
}

template <typename Scalar>
void Dynamics<Scalar>::update_composite() {
  const std::size_t links = center_.size();
  for (std::size_t i = 1; i < links; ++i) {
    composite_[i] = RigidInertia<Scalar>::of(mechanism_->link(static_cast<int>(i)).mass, center_[i], inertia_[i]);
  }
  for (std::size_t i = links - 1; i >= 1; --i) {
    const int parent = mechanism_->link(static_cast<int>(i)).parent;
    if (parent > 0) composite_[parent] += composite_[i];
  }
}

template <typename Scalar>
void Dynamics<Scalar>::update_mass_rows() {
  update_composite();
  for (std::size_t i = 1; i < center_.size(); ++i) {
    for (const int c : mechanism_->link(static_cast<int>(i)).coordinates) {
      const SpatialVector<Scalar> F = composite_[i] * kinematics_.columns[c];
      Scalar* row = rows_.data() + mechanism_->row(c);
      for (const int d : mechanism_->chain(c)) *row++ = kinematics_.columns[d].dot(F);
    }
  }
}

template <typename Scalar>
void Dynamics<Scalar>::mass_matrix(Matrix& M) {
  update_mass_rows();
  M.setZero(mechanism_->coordinates(), mechanism_->coordinates());
  for (int c = 0; c < mechanism_->coordinates(); ++c) {
    const Scalar* row = mass_row(c);
    for (const int d : mechanism_->chain(c)) {
      M(c, d) = *row;
      M(d, c) = *row++;
    }
  }
}

template <typename Scalar>
Factorization Dynamics<Scalar>::forward_dynamics_factorized(const Scalar* tau, const SpatialVector<Scalar>* applied,
                                                            Scalar* qddot) {
  inverse_dynamics(nullptr, applied, work_.data());
  update_mass_rows();
  for (std::size_t c = 0; c < work_.size(); ++c) qddot[c] = tau[c] - work_[c];
  return solve_mass(nullptr, qddot);
}

template <typename Scalar>
Factorization Dynamics<Scalar>::solve_mass(const char* fixed, Scalar* x) {
  const std::span<const int> order = mechanism_->topological_coordinates();
  const auto skip = [fixed](int c) { return fixed != nullptr && fixed[c] != 0; };
  // From the tips to the ground: row k leaves the rows of its ancestors, whose chains are beginnings of its own.
  for (std::size_t o = order.size(); o-- > 0;) {
    const int k = order[o];
    if (skip(k)) continue;
    const std::span<const int> chain = mechanism_->chain(k);
    const std::size_t depth = chain.size() - 1;
    Scalar* const row = rows_.data() + mechanism_->row(k);
    if (!(row[depth] > kSingularPivot * mass_scale(k))) return {k};
    const Scalar inverse = Scalar(1.0) / row[depth];
    row[depth] = inverse;
    for (std::size_t d = depth; d-- > 0;) {
      const int i = chain[d];
      if (skip(i)) continue;
      const Scalar factor = row[d] * inverse;
      Scalar* const ancestor = rows_.data() + mechanism_->row(i);
      for (std::size_t j = 0; j <= d; ++j) ancestor[j] -= factor * row[j];
      x[i] -= factor * x[k];
      row[d] = factor;
    }
  }
  for (const int k : order) {
    if (skip(k)) {
      x[k] = Scalar(0.0);
      continue;
    }
    const std::span<const int> chain = mechanism_->chain(k);
    const std::size_t depth = chain.size() - 1;
    const Scalar* const row = rows_.data() + mechanism_->row(k);
    Scalar sum = x[k] * row[depth];
    for (std::size_t d = 0; d < depth; ++d) {
      if (!skip(chain[d])) sum -= row[d] * x[chain[d]];
    }
    x[k] = sum;
  }
  return {};
}

template <typename Scalar>
Factorization Dynamics<Scalar>::forward_dynamics_articulated(const Scalar* tau, const SpatialVector<Scalar>* applied,
                                                             Scalar* qddot) {
  const std::size_t links = center_.size();
  for (std::size_t i = 1; i < links; ++i) {
    const RigidInertia<Scalar> I =
        RigidInertia<Scalar>::of(mechanism_->link(static_cast<int>(i)).mass, center_[i], inertia_[i]);
    composite_[i] = I;
    Matrix6& IA = articulated_[i];
    const Vector3<Scalar>& h = I.moment;
    Matrix3<Scalar> hx;
    const Scalar zero(0.0);
    hx << zero, -h.z(), h.y(), h.z(), zero, -h.x(), -h.y(), h.x(), zero;
    IA.template topLeftCorner<3, 3>() = I.inertia.matrix();
    IA.template topRightCorner<3, 3>() = hx;
    IA.template bottomLeftCorner<3, 3>() = -hx;
    IA.template bottomRightCorner<3, 3>() = Matrix3<Scalar>::Identity() * Scalar(I.mass);
    const SpatialVector<Scalar>& V = kinematics_.velocity[i];
    SpatialVector<Scalar> p = cross_force(V, I * V);
    if (applied != nullptr) {
      p.angular -= applied[i].angular;
      p.linear -= applied[i].linear;
    }
    articulated_force_[i] = stacked(p);
  }
  for (std::size_t i = links - 1; i >= 1; --i) {
    const Link& link = mechanism_->link(static_cast<int>(i));
    Matrix6& IA = articulated_[i];
    Vector6& p = articulated_force_[i];
    p.noalias() += IA * stacked(kinematics_.velocity_bias[i]);
    // A joint of several coordinates is a chain of joints with massless links between: one at a time.
    for (std::size_t n = link.coordinates.size(); n-- > 0;) {
      const int c = link.coordinates[n];
      const Vector6 S = stacked(kinematics_.columns[c]);
      Vector6& U = articulated_column_[c];
      U.noalias() = IA * S;
      const Scalar D = S.dot(U);
      if (!(D > kSingularPivot * pivot_scale(kinematics_.columns[c], composite_[i]))) return {c};
      pivot_[c] = Scalar(1.0) / D;
      const Scalar u = tau[c] - S.dot(p);
      work_[c] = u;
      const Vector6 scaled = U * pivot_[c];
      if (link.parent > 0 || n > 0) {
        for (int column = 0; column < 6; ++column) IA.col(column) -= scaled * U(column);
        p += scaled * u;
      }
    }
    if (link.parent > 0) {
      articulated_[link.parent] += IA;
      articulated_force_[link.parent] += p;
      composite_[link.parent] += composite_[i];
    }
  }
  acceleration_[0].linear = -mechanism_->gravity().cast<Scalar>();
  for (std::size_t i = 1; i < links; ++i) {
    const Link& link = mechanism_->link(static_cast<int>(i));
    SpatialVector<Scalar>& A = acceleration_[i];
    A = acceleration_[link.parent];
    for (const int c : link.coordinates) {
      const Vector6& U = articulated_column_[c];
      const Scalar UA = U.template head<3>().dot(A.angular) + U.template tail<3>().dot(A.linear);
      qddot[c] = (work_[c] - UA) * pivot_[c];
      A.add_scaled(qddot[c], kinematics_.columns[c]);
    }
    A += kinematics_.velocity_bias[i];
  }
  return {};
}

template <typename Scalar>
Scalar Dynamics<Scalar>::kinetic_energy() const {
  Scalar twice(0.0);
  for (std::size_t i = 1; i < center_.size(); ++i) {
    const SpatialVector<Scalar>& V = kinematics_.velocity[i];
    twice += mechanism_->link(static_cast<int>(i)).mass * V.at(center_[i]).squaredNorm() +
             V.angular.dot(inertia_[i] * V.angular);
  }
  return Scalar(0.5) * twice;
}

template <typename Scalar>
Scalar Dynamics<Scalar>::potential_energy() const {
  Scalar energy(0.0);
  for (std::size_t i = 1; i < center_.size(); ++i) {
    energy -= mechanism_->link(static_cast<int>(i)).mass * mechanism_->gravity().cast<Scalar>().dot(center_[i]);
  }
  return energy;
}

template <typename Scalar>
SpatialVector<Scalar> Dynamics<Scalar>::momentum() const {
  SpatialVector<Scalar> total;
  for (std::size_t i = 1; i < center_.size(); ++i) {
    total += RigidInertia<Scalar>::of(mechanism_->link(static_cast<int>(i)).mass, center_[i], inertia_[i]) *
             kinematics_.velocity[i];
  }
  return total;
}

extern template class Dynamics<double>;  // in dynamics.cpp

}  // namespace veridyn::muscle
