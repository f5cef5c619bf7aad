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

/// A pull between two points. None while they coincide.
template <typename Scalar, typename Receiver>
void add_force(const ExpressionPointForce& pull, const Mechanism& mechanism, const Kinematics<Scalar>& kinematics,
               Receiver* to) {
  using std::sqrt;
  const auto a = moving_frame(mechanism, kinematics, pull.body_1, {.translation = pull.point_1});
  const auto b = moving_frame(mechanism, kinematics, pull.body_2, {.translation = pull.point_2});
  const Vector3<Scalar> between = b.position - a.position;
  const Scalar square = between.squaredNorm();
  if (!(value_of(square) > 0.0)) return;
  const Scalar distance = sqrt(square);
  const Vector3<Scalar> along = between / distance;
  const Scalar rate = along.dot(b.velocity->at(b.position) - a.velocity->at(a.position));
  const Vector3<Scalar> force = along * evaluate(pull.force, std::array{distance, rate});
  const Vector3<Scalar> none = Vector3<Scalar>::Zero();
  add_force_at<Scalar>(mechanism, kinematics, a.link, a.position, force, none, to);
  add_force_at<Scalar>(mechanism, kinematics, b.link, b.position, -force, none, to);
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
