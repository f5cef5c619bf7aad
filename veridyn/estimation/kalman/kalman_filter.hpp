#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "veridyn/estimation/kalman/innovation.hpp"
#include "veridyn/estimation/kalman/kalman_model.hpp"
#include "veridyn/estimation/kalman/smoother_tape.hpp"

namespace veridyn::estimation {

/// One scalar innovation as it was offered.
struct Innovation {
  double nu = 0.0;
  double S = 1.0;  ///< its predicted variance
  bool accepted = false;
  [[nodiscard]] double nis() const { return nu * nu / S; }
};

/// Extended Kalman filter with sequential scalar updates: any subset of sensors, at any rate and time.
///
/// Between measurements the state is propagated by the model and its covariance by the Jacobian from automatic
/// differentiation, P <- F P F' + Q; rows of random-walk states are skipped. A measurement z = h(x) + v with variance r
/// enters as its innovation nu and the row H = dh/d(error):
///     S = H P H' + r,  K = P H' / S,  P <- (I - K H) P (I - K H)' + K r K'   (Joseph form)
/// evaluated as P + w K' + K w' with w = S K / 2 - P H': the same for any K, symmetric to the last bit, 2 N^2
/// operations. Innovations pass a gate first (see InnovationMonitor). Several measurements at one time are entered one
/// after the other, which
/// equals the joint update when their noises are independent.
///
/// Never allocates or throws. Jazwinski (1970), chapter 8; Bierman (1977) for the sequential form. The reset of an
/// attitude error after an update is taken as the identity, an error of second order in the correction.
template <SystemModel Model>
class ExtendedKalmanFilter {
 public:
  static constexpr int kStates = Model::kStates;
  static constexpr int kDynamic = Model::kDynamic;
  using State = typename Model::template State<double>;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  ExtendedKalmanFilter() = default;
  ExtendedKalmanFilter(const State& x, const Covariance& P) : x_(x), P_(P) {}

  [[nodiscard]] const State& state() const noexcept { return x_; }
  [[nodiscard]] const Covariance& covariance() const noexcept { return P_; }

  /// Over `dt` > 0 [s] with constant input `u`.
  void propagate(const Model& model, const typename Model::Input& u, double dt,
                 SmootherTape<Model>* tape = nullptr) noexcept {
    State after;
    const auto F = transition(model, x_, u, dt, after);
    x_ = after;
    // P F' by the entries of F that are not zero, which are few; P is symmetric, so its columns serve as rows.
    constexpr int D = kDynamic, N = kStates;
    Eigen::Matrix<double, N, D> PF = Eigen::Matrix<double, N, D>::Zero();
    for (int k = 0; k < N; ++k) {
      for (int i = 0; i < D; ++i) {
        if (F(i, k) != 0.0) PF.col(i) += F(i, k) * P_.col(k);
      }
    }
    Eigen::Matrix<double, D, D> FPF = Eigen::Matrix<double, D, D>::Zero();
    const Eigen::Matrix<double, D, N> FP = internal::transposed(PF);
    for (int k = 0; k < N; ++k) {
      for (int i = 0; i < D; ++i) {
        if (F(i, k) != 0.0) FPF.col(i) += F(i, k) * FP.col(k);
      }
    }
    P_.template topLeftCorner<D, D>() = 0.5 * (FPF + FPF.transpose());
    if constexpr (N > D) {
      P_.template bottomLeftCorner<N - D, D>() = PF.template bottomRows<N - D>();
      P_.template topRightCorner<D, N - D>() = FP.template rightCols<N - D>();
    }
    model.add_process_noise(x_, u, dt, P_);
    if (tape) tape->add_transition(F);
  }

  /// Enters the measurement of innovation `nu` = z - h(x), row `H` and variance `r` > 0, taken at time `t`, if the gate
  /// of `monitor` lets it in. Returns whether it did; `seen` receives the innovation in either case.
  bool update(double t, double nu, const Vector& H, double r, InnovationMonitor& monitor,
              SmootherTape<Model>* tape = nullptr, Innovation* seen = nullptr) noexcept {
    // By the entries of H that are not zero: a sensor reads few states.
    Vector PH = Vector::Zero();
    for (int k = 0; k < kStates; ++k)
      if (H(k) != 0.0) PH += H(k) * P_.col(k);
    double S = H.dot(PH) + r;
    const auto verdict = monitor.judge(t, nu, S);
    if (seen) *seen = {nu, S, verdict.accept};
    if (!verdict.accept) return false;
    S += verdict.extra_variance;
    r += verdict.extra_variance;
    const Vector K = PH / S;
    const Vector half = (0.5 * S) * K - PH;
    P_ += half.lazyProduct(K.transpose()) + K.lazyProduct(half.transpose());
    x_ = Model::template retract<double>(x_, K * nu);
    if (tape) tape->add_update(H, K, S, nu);
    return true;
  }

  /// Puts the present state on the tape: the smoother will deliver its smoothed form, under the number `mark`.
  void mark(std::size_t number, SmootherTape<Model>* tape) const noexcept {
    if (tape) tape->add_mark(number, x_, P_);
  }

 private:
  State x_{};
  Covariance P_ = Covariance::Zero();
};

}  // namespace veridyn::estimation
