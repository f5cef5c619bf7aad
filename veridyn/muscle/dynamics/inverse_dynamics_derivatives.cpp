#include "veridyn/muscle/dynamics/inverse_dynamics_derivatives.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
namespace {

using Spatial = SpatialVector<double>;

/// Change of a body's force I A + V x* I V with its velocity and acceleration.
Spatial force_change(const RigidInertia<double>& I, const Spatial& V, const Spatial& momentum, const Spatial& dV,
                     const Spatial& dA) {
  Spatial force = I * dA;
  force += cross_force(dV, momentum);
  force += cross_force(V, I * dV);
  return force;
}

}  // namespace

bool InverseDynamicsDerivatives::available(const Mechanism& mechanism) {
  for (int i = 1; i < mechanism.links(); ++i) {
    if (!mechanism.link(i).simple) return false;
  }
  return true;
}

InverseDynamicsDerivatives::InverseDynamicsDerivatives(const Mechanism& mechanism, std::span<const int> coordinates)
    : coordinates_(coordinates.begin(), coordinates.end()),
      row_(at(mechanism.links()), -1),
      inertia_(row_.size()),
      momentum_(row_.size()),
      force_value_(row_.size()),
      force_speed_(row_.size()) {
  VERIDYN_ASSERT(available(mechanism));
  const auto n = signed_index(coordinates_.size());
  by_value_.setZero(n, n);
  by_speed_.setZero(n, n);
  for (int i = 0; i < mechanism.links(); ++i) parent_.push_back(mechanism.link(i).parent);
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    row_[at(mechanism.link_of_coordinate(coordinates_[k]))] = static_cast<int>(k);
    std::vector<int> links;
    for (int i = mechanism.links() - 1; i >= 1; --i) {
      if (mechanism.moves(coordinates_[k], i)) links.push_back(i);
    }
    beyond_.push_back(std::move(links));
  }
}

// Flattened: a long chain of products of small vectors, of which calls would be a third.
[[gnu::flatten]] void InverseDynamicsDerivatives::evaluate(const Dynamics<double>& dynamics) {
  const Kinematics<double>& kinematics = dynamics.kinematics();
  const Mechanism& mechanism = dynamics.mechanism();
  for (std::size_t i = 1; i < row_.size(); ++i) {
    inertia_[i] = dynamics.link_inertia(static_cast<int>(i));
    momentum_[i] = inertia_[i] * kinematics.velocity[i];
  }
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const int link = mechanism.link_of_coordinate(coordinates_[k]), before = parent_[at(link)];
    const Spatial& S = kinematics.columns[at(coordinates_[k])];
    const Spatial& V_before = kinematics.velocity[at(before)];
    const Spatial carried = cross_motion(V_before, S);
    Spatial a_value = cross_motion(dynamics.acceleration(before), S);
    a_value.add_scaled(-1.0, cross_motion(carried, V_before));
    for (const int i : beyond_[k]) force_value_[at(i)] = force_speed_[at(i)] = Spatial{};
    for (const int i : beyond_[k]) {
      const Spatial& V = kinematics.velocity[at(i)];
      Spatial dA = cross_motion(carried, V);
      dA += a_value;
      force_value_[at(i)] += force_change(inertia_[at(i)], V, momentum_[at(i)], carried, dA);
      dA = cross_motion(S, V);
      dA.add_scaled(2.0, carried);
      force_speed_[at(i)] += force_change(inertia_[at(i)], V, momentum_[at(i)], S, dA);
      if (row_[at(i)] >= 0) {
        const Spatial& own = kinematics.columns[at(coordinates_[at(row_[at(i)])])];
        by_value_(row_[at(i)], column) = own.dot(force_value_[at(i)]);
        by_speed_(row_[at(i)], column) = own.dot(force_speed_[at(i)]);
      }
      if (i != link) {
        force_value_[at(parent_[at(i)])] += force_value_[at(i)];
        force_speed_[at(parent_[at(i)])] += force_speed_[at(i)];
      }
    }
    Spatial turned = cross_force(S, dynamics.joint_force(link));
    turned += force_value_[at(link)];
    for (int i = before; i > 0; i = parent_[at(i)]) {
      if (row_[at(i)] < 0) continue;
      const Spatial& own = kinematics.columns[at(coordinates_[at(row_[at(i)])])];
      by_value_(row_[at(i)], column) = own.dot(turned);
      by_speed_(row_[at(i)], column) = own.dot(force_speed_[at(link)]);
    }
  }
}

}  // namespace veridyn::muscle
