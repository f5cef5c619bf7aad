#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <concepts>

namespace veridyn::estimation {

namespace internal {

/// The transpose as a value. (Eigen's own assignment of a transpose warns falsely in g++ 12 with assertions on.)
template <int R, int C>
[[nodiscard]] Eigen::Matrix<double, C, R> transposed(const Eigen::Matrix<double, R, C>& m) {
  Eigen::Matrix<double, C, R> t;
  for (int j = 0; j < C; ++j) {
    for (int i = 0; i < R; ++i) t(j, i) = m(i, j);
  }
  return t;
}

}  // namespace internal

/// What the filter has to know of a system.
///
/// The state may live on a manifold (an attitude, say): `State<Scalar>` is its value, and its error is a vector of
/// `kStates` numbers that `retract` adds and `local` takes out again; covariances are those of the error.
///
///     static constexpr int kStates;   // dimension N of the error
///     static constexpr int kDynamic;  // the first of them; the remaining ones are constants or random walks
///     template <typename Scalar> struct State;
///     struct Input;
///     State<S> propagate(const State<S>& x, const Input& u, double dt) const;            // over dt [s]
///     static State<S> retract(const State<double>& x, const Matrix<S, N, 1>& error);     // x (+) error
///     static Matrix<S, N, 1> local(const State<double>& from, const State<S>& to);       // to (-) from, first order
///     void add_process_noise(const State<double>& x, const Input& u, double dt, Matrix<double, N, N>& P) const;
///
/// The functions templated on the scalar are called with double and with ceres::Jet<double, N>.
template <class Model>
concept SystemModel = requires {
  { Model::kStates } -> std::convertible_to<int>;
  { Model::kDynamic } -> std::convertible_to<int>;
  typename Model::Input;
  typename Model::template State<double>;
}
&&(Model::kDynamic <= Model::kStates);

/// The rows of the transition matrix d(error after) / d(error before) of the first `kDynamic` components, by automatic
/// differentiation; the remaining rows are those of the identity. `after` receives the propagated state.
template <SystemModel Model>
[[nodiscard]] Eigen::Matrix<double, Model::kDynamic, Model::kStates> automatic_transition(
    const Model& model, const typename Model::template State<double>& x, const typename Model::Input& u, double dt,
    typename Model::template State<double>& after) {
  constexpr int N = Model::kStates;
  using Jet = ceres::Jet<double, N>;
  after = model.template propagate<double>(x, u, dt);
  Eigen::Matrix<Jet, N, 1> error;
  for (int i = 0; i < N; ++i) error(i) = Jet(0.0, i);
  const auto moved = model.template propagate<Jet>(Model::template retract<Jet>(x, error), u, dt);
  const Eigen::Matrix<Jet, N, 1> change = Model::template local<Jet>(after, moved);
  Eigen::Matrix<double, Model::kDynamic, N> F;
  for (int i = 0; i < Model::kDynamic; ++i) F.row(i) = change(i).v.transpose();
  return F;
}

/// As `automatic_transition`; a model may offer the same rows in closed form, for speed, as
/// `transition_rows(x, u, dt, after)`, and then proves them against automatic differentiation in its tests.
template <SystemModel Model>
[[nodiscard]] Eigen::Matrix<double, Model::kDynamic, Model::kStates> transition(
    const Model& model, const typename Model::template State<double>& x, const typename Model::Input& u, double dt,
    typename Model::template State<double>& after) {
  if constexpr (requires { model.transition_rows(x, u, dt, after); }) {
    return model.transition_rows(x, u, dt, after);
  } else {
    return automatic_transition(model, x, u, dt, after);
  }
}

}  // namespace veridyn::estimation
