#pragma once

#include <Eigen/Core>
#include <array>

#include "veridyn/estimation/recursive/small_matrix.hpp"

namespace veridyn::estimation::internal {

/// Sums of scores g_k = x_k r_k over blocks of rows under the weights of the squares: S = sum_b G_b G_b',
/// G_b = sum_k w_k g_k. Forgetting by lambda multiplies G by lambda and S by lambda^2. Batch means (overlap-free), so
/// residual correlation shorter than a block is in S in full.
///
/// The information sum_k w_k^2 x_k x_k' of every block is kept too, in the sums of its squares over blocks: they say
/// among how many blocks what determines a parameter is spread, hence how uncertain its part of S is. A manoeuvre of
/// 5 s in a minute of level flight is five blocks of 1 s, not sixty. Nothing allocates after `reset`.
class ScoreBlocks {
 public:
  /// @param block rows of a block, at least 1
  void reset(Eigen::Index parameters, Eigen::Index block);
  /// A batch estimate of `rows` rows with information M = X'X, taken as spread evenly over them: its scores' S.
  void start(const SmallMatrix& S, const SmallMatrix& M, double rows);
  /// Forgets all: what is recorded no longer describes the residual.
  void restart();
  /// Takes a row: its regressors x (n) and its score x r.
  void add(const double* x, const SmallVector& score, double lambda);
  /// A row that has no score.
  void forget(double lambda);

  [[nodiscard]] const SmallMatrix& sum() const { return sum_; }  ///< S, closed blocks
  /// The same over `kWide` neighbouring blocks each, for correlation that is longer than a block.
  [[nodiscard]] const SmallMatrix& wide_sum() const { return wide_sum_; }
  [[nodiscard]] double weight() const { return weight_; }            ///< sum over closed blocks of sum_k w_k^2
  [[nodiscard]] double wide_weight() const { return wide_weight_; }  ///< the same of wide blocks
  /// Blocks in memory: (sum W_b)^2/sum W_b^2, W_b = sum_k w_k^2.
  [[nodiscard]] double blocks() const;
  /// Blocks that determine the combination p of parameters, (sum a_b)^2/sum a_b^2 with a_b = p' M_b p the block's
  /// information on it; 0 where there is none.
  [[nodiscard]] double blocks_behind(const double* p) const;

  static constexpr int kWide = 4;

 private:
  static constexpr int kPairs = kMaxRecursiveParameters * (kMaxRecursiveParameters + 1) / 2;
  using Pairs = std::array<double, kPairs>;

  void close();
  void add_squares(const Pairs& information, double factor);
  void rescale();

  Eigen::Index size_ = 0;
  Eigen::Index length_ = 1;
  Eigen::Index filled_ = 0;
  int wide_filled_ = 0;
  double open_weight_ = 0.0, wide_open_weight_ = 0.0;
  SmallVector open_, wide_open_;  // G of the blocks that are being filled
  SmallMatrix sum_, wide_sum_;
  double weight_ = 0.0, wide_weight_ = 0.0, weight_squared_ = 0.0;
  // Of M_b the elements i <= j, in order; of the sums over closed blocks of M_b M_b' the lower triangle, times
  // `squares_scale_`, which forgets lambda^4 a row without touching them.
  int pairs_ = 0;
  Pairs open_information_{}, information_{};
  std::array<double, kPairs * kPairs> squares_{};
  double squares_scale_ = 1.0;
};

}  // namespace veridyn::estimation::internal
