#include "veridyn/estimation/recursive/score_blocks.hpp"

#include <algorithm>

namespace veridyn::estimation::internal {

void ScoreBlocks::reset(Eigen::Index parameters, Eigen::Index block) {
  size_ = parameters;
  length_ = block;
  pairs_ = static_cast<int>(parameters * (parameters + 1) / 2);
  restart();
}

void ScoreBlocks::restart() {
  filled_ = 0;
  wide_filled_ = 0;
  open_weight_ = wide_open_weight_ = weight_ = wide_weight_ = weight_squared_ = 0.0;
  open_ = wide_open_ = SmallVector::Zero(size_);
  sum_ = wide_sum_ = SmallMatrix::Zero(size_, size_);
  open_information_.fill(0.0);
  information_.fill(0.0);
  squares_.fill(0.0);
  squares_scale_ = 1.0;
}

void ScoreBlocks::start(const SmallMatrix& S, const SmallMatrix& M, double rows) {
  const double block = std::min(rows, static_cast<double>(length_));
  sum_ = S;
  weight_ = rows;
  weight_squared_ = rows * block;
  int k = 0;
  for (Eigen::Index j = 0; j < size_; ++j)
    for (Eigen::Index i = 0; i <= j; ++i) information_[k++] = M(i, j);
  add_squares(information_, block / rows);
}

void ScoreBlocks::forget(double lambda) {
  if (lambda == 1.0) return;
  const double square = lambda * lambda;
  open_ *= lambda;
  wide_open_ *= lambda;
  open_weight_ *= square;
  wide_open_weight_ *= square;
  sum_ *= square;
  wide_sum_ *= square;
  weight_ *= square;
  wide_weight_ *= square;
  weight_squared_ *= square * square;
  for (int k = 0; k < pairs_; ++k) {
    open_information_[k] *= square;
    information_[k] *= square;
  }
  squares_scale_ *= square * square;
  // What was forgotten beyond rounding is put down before the scale is no number any more.
  if (squares_scale_ < 1e-100) rescale();
}

void ScoreBlocks::rescale() {
  for (double& value : squares_) value *= squares_scale_;
  squares_scale_ = 1.0;
}

void ScoreBlocks::add_squares(const Pairs& information, double factor) {
  for (int i = 0; i < pairs_; ++i) {
    const double scaled = information[i] * factor / squares_scale_;
    for (int j = 0; j <= i; ++j) squares_[i * kPairs + j] += scaled * information[j];
  }
}

void ScoreBlocks::add(const double* x, const SmallVector& score, double lambda) {
  forget(lambda);
  open_ += score;
  open_weight_ += 1.0;
  int k = 0;
  for (Eigen::Index j = 0; j < size_; ++j)
    for (Eigen::Index i = 0; i <= j; ++i) open_information_[k++] += x[i] * x[j];
  if (++filled_ >= length_) close();
}

void ScoreBlocks::close() {
  for (Eigen::Index j = 0; j < size_; ++j)
    for (Eigen::Index i = 0; i < size_; ++i) sum_(i, j) += open_(i) * open_(j);
  weight_ += open_weight_;
  weight_squared_ += open_weight_ * open_weight_;
  wide_open_ += open_;
  wide_open_weight_ += open_weight_;
  if (++wide_filled_ == kWide) {
    for (Eigen::Index j = 0; j < size_; ++j)
      for (Eigen::Index i = 0; i < size_; ++i) wide_sum_(i, j) += wide_open_(i) * wide_open_(j);
    wide_weight_ += wide_open_weight_;
    wide_open_.setZero();
    wide_open_weight_ = 0.0;
    wide_filled_ = 0;
  }
  for (int i = 0; i < pairs_; ++i) information_[i] += open_information_[i];
  add_squares(open_information_, 1.0);
  open_.setZero();
  open_information_.fill(0.0);
  open_weight_ = 0.0;
  filled_ = 0;
}

double ScoreBlocks::blocks() const { return weight_squared_ > 0.0 ? weight_ * weight_ / weight_squared_ : 0.0; }

double ScoreBlocks::blocks_behind(const double* p) const {
  Pairs product;
  double sum = 0.0, squares = 0.0;
  int k = 0;
  for (Eigen::Index j = 0; j < size_; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i, ++k) {
      product[k] = (i == j ? 1.0 : 2.0) * p[i] * p[j];
      sum += product[k] * information_[k];
    }
  }
  for (int i = 0; i < pairs_; ++i) {
    double row = 0.5 * product[i] * squares_[i * kPairs + i];
    for (int j = 0; j < i; ++j) row += product[j] * squares_[i * kPairs + j];
    squares += 2.0 * product[i] * row;
  }
  squares *= squares_scale_;
  return sum > 0.0 && squares > 0.0 ? sum * sum / squares : 0.0;
}

}  // namespace veridyn::estimation::internal
