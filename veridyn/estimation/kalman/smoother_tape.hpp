#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "veridyn/estimation/kalman/kalman_model.hpp"

namespace veridyn::estimation {

/// The linearised history of a stretch of filtering: transitions, accepted updates and marked states, in order.
/// `clear` keeps the memory, so that a tape used again does not allocate.
template <SystemModel Model>
class SmootherTape {
 public:
  static constexpr int kStates = Model::kStates;
  static constexpr int kDynamic = Model::kDynamic;
  using State = typename Model::template State<double>;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  using TransitionRows = Eigen::Matrix<double, kDynamic, kStates>;

  /// An accepted measurement: row H, gain K, variance S of the innovation nu.
  struct Update {
    Vector H, K;
    double S, nu;
  };
  /// A state whose smoothed form is wanted.
  struct Mark {
    std::size_t number;
    State x;
    Covariance P;
  };
  enum class Kind : unsigned char { kTransition, kUpdate, kMark };

  void add_transition(const TransitionRows& F) {
    order_.push_back(Kind::kTransition);
    transitions_.push_back(F);
  }
  void add_update(const Vector& H, const Vector& K, double S, double nu) {
    order_.push_back(Kind::kUpdate);
    updates_.push_back({H, K, S, nu});
  }
  void add_mark(std::size_t number, const State& x, const Covariance& P) {
    order_.push_back(Kind::kMark);
    marks_.push_back({number, x, P});
  }
  void clear() {
    order_.clear();
    transitions_.clear();
    updates_.clear();
    marks_.clear();
  }

 private:
  template <SystemModel>
  friend class FixedIntervalSmoother;
  std::vector<Kind> order_;
  std::vector<TransitionRows> transitions_;
  std::vector<Update> updates_;
  std::vector<Mark> marks_;
};

}  // namespace veridyn::estimation
