#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <future>
#include <utility>
#include <vector>

#include "veridyn/estimation/kalman/kalman_model.hpp"
#include "veridyn/estimation/kalman/smoother_tape.hpp"

namespace veridyn::estimation {

/// Fixed-interval smoother in the adjoint form of Bryson & Frazier as modified by Bierman (1973), Automatica 9:
/// 503-509: the same estimate as Rauch, Tung & Striebel (1965), without inverting a covariance.
///
/// The adjoint lambda and its covariance Lambda start at zero after the last measurement and go back through
///     an update:      Lambda <- H' H / S + (I - K H)' Lambda (I - K H),  lambda <- -H' nu / S + (I - K H)' lambda
///     a transition:   Lambda <- F' Lambda F,                             lambda <- F' lambda
/// and at every mark  x_s = x (-) P lambda,  P_s = P - P Lambda P.
/// Nothing is inverted, so exactly known and not yet excited states do no harm. For a nonlinear model the Jacobians are
/// those of the filter's estimates, as in the extended RTS smoother.
template <SystemModel Model>
class FixedIntervalSmoother {
 public:
  using Tape = SmootherTape<Model>;
  using State = typename Tape::State;
  using Vector = typename Tape::Vector;
  using Covariance = typename Tape::Covariance;

  /// The adjoint and its covariance at a mark.
  struct Adjoint {
    Vector lambda;
    Covariance Lambda;
  };

  /// Goes backwards through `tape`, which must be the stretch just before the one swept last; `at_marks` then holds
  /// what its marks lack to be smoothed, latest first.
  void sweep(const Tape& tape, std::vector<Adjoint>& at_marks) {
    constexpr int D = Model::kDynamic, R = Model::kStates - Model::kDynamic;
    at_marks.clear();
    auto F = tape.transitions_.rbegin();
    auto update = tape.updates_.rbegin();
    for (auto kind = tape.order_.rbegin(); kind != tape.order_.rend(); ++kind) {
      switch (*kind) {
        case Tape::Kind::kTransition: {
          // Lambda F, then F' (Lambda F), by the entries of F that are not zero; below its first D rows F is the
          // identity. Lambda is symmetric, so its columns serve as rows.
          const Covariance first = internal::transposed(times_transition(Lambda_, *F));
          const Covariance L = times_transition(first, *F);
          Lambda_ = 0.5 * (L + L.transpose());
          Vector l = F->transpose() * lambda_.template head<D>();
          if constexpr (R > 0) l.template tail<R>() += lambda_.template tail<R>();
          lambda_ = l;
          ++F;
          break;
        }
        case Tape::Kind::kUpdate: {
          const Vector& H = update->H;
          const Vector& K = update->K;
          const Vector LK = Lambda_.lazyProduct(K);
          const double weight = 1.0 / update->S + K.dot(LK);
          const Vector half = (0.5 * weight) * H - LK;
          add_symmetric(half, H);
          lambda_ -= H * (update->nu / update->S + K.dot(lambda_));
          ++update;
          break;
        }
        case Tape::Kind::kMark:
          at_marks.push_back({lambda_, Lambda_});
          break;
      }
    }
  }

  /// Calls `emit(number, x_smoothed, P_smoothed)` for the latest mark but `back` of a tape that was swept.
  template <class Emit>
  static void smooth_mark(const Tape& tape, const std::vector<Adjoint>& at_marks, std::size_t back, Emit&& emit) {
    const auto& mark = tape.marks_[tape.marks_.size() - 1 - back];
    const Adjoint& adjoint = at_marks[back];
    const Covariance P = smoothed_covariance(mark.P, adjoint.Lambda);
    const Vector correction = -mark.P.lazyProduct(adjoint.lambda);
    emit(mark.number, Model::template retract<double>(mark.x, correction), P);
  }

 private:
  /// P - P Lambda P: of what is symmetric the lower triangle.
  [[nodiscard]] static Covariance smoothed_covariance(const Covariance& P, const Covariance& Lambda) {
    constexpr int N = Model::kStates;
    const Covariance PL = P.lazyProduct(Lambda);
    Covariance smoothed = P;
    [&]<int... Pair>(std::integer_sequence<int, Pair...>) { (subtract_below<2 * Pair>(PL, P, smoothed), ...); }
    (std::make_integer_sequence<int, (N + 1) / 2>());
    for (int j = 1; j < N; ++j)
      for (int i = 0; i < j; ++i) smoothed(i, j) = smoothed(j, i);
    return smoothed;
  }

  /// Two columns of `result` less those of PL P, from the row of the first one down.
  template <int From>
  static void subtract_below(const Covariance& PL, const Covariance& P, Covariance& result) {
    constexpr int N = Model::kStates, kRows = N - From, kColumns = std::min(2, kRows);
    result.template block<kRows, kColumns>(From, From) -=
        PL.template bottomRows<kRows>().lazyProduct(P.template middleCols<kColumns>(From));
  }

  /// Lambda <- Lambda + half H' + H half', by the entries of H that are not zero: a sensor reads few states.
  void add_symmetric(const Vector& half, const Vector& H) {
    constexpr int N = Model::kStates;
    std::array<int, N> entries;
    std::size_t count = 0;
    for (int k = 0; k < N; ++k)
      if (H(k) != 0.0) entries[count++] = k;
    for (int j = 0; j < N; ++j) {
      if (H(j) != 0.0) {
        Lambda_.col(j) += half * H(j) + H * half(j);
      } else {
        for (std::size_t i = 0; i < count; ++i) Lambda_(entries[i], j) += H(entries[i]) * half(j);
      }
    }
  }

  [[nodiscard]] static Covariance times_transition(const Covariance& M, const typename Tape::TransitionRows& F) {
    constexpr int D = Model::kDynamic, N = Model::kStates;
    Covariance product;
    for (int j = 0; j < N; ++j) {
      if (j < D) {
        product.col(j).setZero();
      } else {
        product.col(j) = M.col(j);
      }
      for (int k = 0; k < D; ++k) {
        if (F(k, j) != 0.0) product.col(j) += F(k, j) * M.col(k);
      }
    }
    return product;
  }

  Vector lambda_ = Vector::Zero();
  Covariance Lambda_ = Covariance::Zero();
};

/// Smooths a long run in bounded memory: goes forward once keeping a copy of the run every `block` steps, then repeats
/// the blocks from the last to the first with a tape. Twice the filter's time, but memory only for three blocks and
/// steps / block copies.
///
/// `Run` is copyable; `bool advance(SmootherTape<Model>* tape)` processes the next step and returns false, having done
/// nothing, at the end. Repeating a copy must repeat the results. `on_forward(run)` is called after each step of the
/// forward pass and may return false to stop there (the steps done so far are still smoothed). Returns the run at the
/// end of the forward pass.
///
/// `emit(number, x_smoothed, P_smoothed)` is called once for each mark. With one thread that is from the latest to the
/// first; with more (0: as many as the machine has) one block is repeated while another is swept, and those who are
/// done with that emit a third: in no order, and on two threads at a time. Not a bit is different.
template <SystemModel Model, class Run, class OnForward, class Emit>
Run smooth_in_blocks(Run run, std::size_t block, int threads, OnForward&& on_forward, Emit&& emit) {
  using Smoother = FixedIntervalSmoother<Model>;
  std::vector<std::pair<Run, std::size_t>> starts;
  bool going = true;
  while (going) {
    std::pair<Run, std::size_t> start(run, 0);
    while (going && start.second < block) {
      if (!run.advance(nullptr)) {
        going = false;
        break;
      }
      ++start.second;
      going = on_forward(std::as_const(run));
    }
    if (start.second > 0) starts.push_back(std::move(start));
  }

  struct Block {
    SmootherTape<Model> tape;
    std::vector<typename Smoother::Adjoint> at_marks;
    std::atomic<std::size_t> emitted = 0;
  };
  std::array<Block, 3> blocks;
  Smoother smoother;
  const auto repeat = [&starts](Block& b) {
    b.tape.clear();
    auto& [again, steps] = starts.back();
    for (std::size_t i = 0; i < steps; ++i) static_cast<void>(again.advance(&b.tape));
    starts.pop_back();
  };
  const auto sweep = [&smoother](Block& b) {
    smoother.sweep(b.tape, b.at_marks);
    b.emitted = 0;
  };
  const auto emit_some = [&emit](Block& b) {
    constexpr std::size_t kAtOnce = 16;
    const std::size_t count = b.at_marks.size();
    for (std::size_t from = b.emitted.fetch_add(kAtOnce); from < count; from = b.emitted.fetch_add(kAtOnce))
      for (std::size_t i = from; i < std::min(from + kAtOnce, count); ++i)
        Smoother::smooth_mark(b.tape, b.at_marks, i, emit);
  };
  // In round k the k-th block from the end is repeated, the one before it in this order swept, and that before emitted.
  const std::size_t count = starts.size();
  for (std::size_t k = 0; count > 0 && k < count + 2; ++k) {
    Block& repeated = blocks[k % 3];
    Block* const swept = k >= 1 && k <= count ? &blocks[(k - 1) % 3] : nullptr;
    Block* const emitted = k >= 2 ? &blocks[(k - 2) % 3] : nullptr;
    const auto beside = [&, k] {
      if (k < count) repeat(repeated);
      if (emitted != nullptr) emit_some(*emitted);
    };
    std::future<void> helper;
    if (threads != 1 && k > 0) helper = std::async(std::launch::async, beside);
    if (swept != nullptr) sweep(*swept);
    if (emitted != nullptr) emit_some(*emitted);
    if (helper.valid()) {
      helper.get();
    } else {
      beside();
    }
  }
  return run;
}

}  // namespace veridyn::estimation
