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
    row_[mechanism.link_of_coordinate(coordinates_[k])] = static_cast<int>(k);
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
    const int link = mechanism.link_of_coordinate(coordinates_[k]), before = parent_[link];
    const Spatial& S = kinematics.columns[coordinates_[k]];
    const Spatial& V_before = kinematics.velocity[before];
    const Spatial carried = cross_motion(V_before, S);
    Spatial a_value = cross_motion(dynamics.acceleration(before), S);
    a_value.add_scaled(-1.0, cross_motion(carried, V_before));
    for (const int i : beyond_[k]) force_value_[i] = force_speed_[i] = Spatial{};
    for (const int i : beyond_[k]) {
      const Spatial& V = kinematics.velocity[i];
      Spatial dA = cross_motion(carried, V);
      dA += a_value;
      force_value_[i] += force_change(inertia_[i], V, momentum_[i], carried, dA);
      dA = cross_motion(S, V);
      dA.add_scaled(2.0, carried);
      force_speed_[i] += force_change(inertia_[i], V, momentum_[i], S, dA);
      if (row_[i] >= 0) {
        const Spatial& own = kinematics.columns[coordinates_[row_[i]]];
        by_value_(row_[i], k) = own.dot(force_value_[i]);
        by_speed_(row_[i], k) = own.dot(force_speed_[i]);
      }
      if (i != link) {
        force_value_[parent_[i]] += force_value_[i];
        force_speed_[parent_[i]] += force_speed_[i];
      }
    }
    Spatial turned = cross_force(S, dynamics.joint_force(link));
    turned += force_value_[link];
    for (int i = before; i > 0; i = parent_[i]) {
      if (row_[i] < 0) continue;
      const Spatial& own = kinematics.columns[coordinates_[row_[i]]];
      by_value_(row_[i], k) = own.dot(turned);
      by_speed_(row_[i], k) = own.dot(force_speed_[link]);
    }
  }
}

}  // namespace veridyn::muscle
