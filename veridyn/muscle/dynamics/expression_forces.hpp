#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "veridyn/muscle/dynamics/body_forces.hpp"
#include "veridyn/muscle/model/expression_force.hpp"
#include "veridyn/muscle/model/scalar.hpp"

/// Forces that formulas give, with OpenSim's names of variables. One thread at a time: formulas keep their variables.
namespace veridyn::muscle {

/// A formula's value; dual numbers get its slopes by central differences, to some 1e-9 of them.
template <typename Scalar, std::size_t N>
[[nodiscard]] Scalar evaluate(const Expression& expression, const std::array<Scalar, N>& x) {
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i) values[i] = value_of(x[i]);
  if constexpr (DualNumber<Scalar>) {
    Scalar y(expression(values));
    for (std::size_t i = 0; i < N; ++i) {
      const double middle = values[i], step = 1e-6 * (std::abs(middle) + 0.1);
      values[i] = middle + step;
      const double above = expression(values);
      values[i] = middle - step;
      const double slope = (above - expression(values)) / (2.0 * step);
      values[i] = middle;
      y.v += slope * x[i].v;
    }
    return y;
  } else {
    return expression(values);
  }
}

/// Adds the forces on coordinates to tau.
template <typename Scalar>
void add_coordinate_expressions(const ExpressionForces& forces, const Scalar* q, const Scalar* qdot, Scalar* tau) {
  for (const ExpressionCoordinateForce& f : forces.coordinates)
    tau[f.coordinate] += evaluate(f.force, std::array{q[f.coordinate], qdot[f.coordinate]});
}

/// A pull between two points.
template <typename Scalar, typename Receiver>
void add_force(const ExpressionPointForce& pull, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
               Receiver* to) {
  const auto tension = [&](const Scalar& distance, const Scalar& rate) {
    return evaluate(pull.force, std::array{distance, rate});
  };
  add_pull(pull, mechanism, kinematics, tension, to);
}

/// A bushing whose springs are formulas of all its deflections.
template <typename Scalar, typename Receiver>
void add_force(const ExpressionBushing& given, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
               Receiver* to) {
  add_bushing(
      given.bushing, mechanism, kinematics,
      [&](const Vector3<Scalar>& t, const Vector3<Scalar>& d, Vector3<Scalar>& torque, Vector3<Scalar>& push) {
        const std::array deflection{t.x(), t.y(), t.z(), d.x(), d.y(), d.z()};
        for (int i = 0; i < 3; ++i) {
          torque(i) -= evaluate(given.resistance[i], deflection);
          push(i) -= evaluate(given.resistance[i + 3], deflection);
        }
      },
      to);
}

/// Adds those between bodies.
template <typename Scalar, typename Receiver>
void add_body_expressions(const ExpressionForces& forces, const Mechanism& mechanism,
                          const Kinematics<Scalar>& kinematics, Receiver* to) {
  for (const ExpressionPointForce& pull : forces.points) add_force(pull, mechanism, kinematics, to);
  for (const ExpressionBushing& bushing : forces.bushings) add_force(bushing, mechanism, kinematics, to);
}

}  // namespace veridyn::muscle
