#include "veridyn/estimation/output_error/input_error_sizes.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// Measured values of a block of samples at most.
constexpr Index kBlock = 300;

/// Neighbouring samples: what was measured of them, and the shares K of their covariance.
struct Block {
  Eigen::VectorXd residual;
  std::vector<Index> output;              ///< by value
  std::vector<Eigen::MatrixXd> by_error;  ///< by kind
};

Block block_of(const ErrorResponse& s, std::vector<Index> rows, std::size_t kinds) {
  Block block;
  const Index outputs = s.residual.cols();
  block.residual.resize(signed_index(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    block.residual(signed_index(i)) = s.residual.data()[rows[i]];
    block.output.push_back(rows[i] % outputs);
  }
  for (std::size_t j = 0; j < kinds; ++j) {
    std::vector<Index> columns;
    for (std::size_t c = 0; c < s.kind_of.size(); ++c)
      if (s.kind_of[c] == static_cast<int>(j)) columns.push_back(signed_index(c));
    const Eigen::MatrixXd H = s.response(rows, columns);
    block.by_error.emplace_back(H * H.transpose());
  }
  return block;
}

std::vector<Block> blocks_of(const std::vector<ErrorResponse>& segments, std::size_t kinds) {
  std::vector<Block> blocks;
  for (const ErrorResponse& s : segments) {
    std::vector<Index> seen;
    for (Index i = 0; i < s.residual.size(); ++i)
      if (std::isfinite(s.residual.data()[i])) seen.push_back(i);
    const Index count = std::max<Index>(1, (signed_index(seen.size()) + kBlock - 1) / kBlock);
    for (Index b = 0; b < count; ++b) {
      const auto begin = seen.begin() + b * signed_index(seen.size()) / count;
      const auto end = seen.begin() + (b + 1) * signed_index(seen.size()) / count;
      if (begin != end) blocks.push_back(block_of(s, {begin, end}, kinds));
    }
  }
  return blocks;
}

}  // namespace

InputErrorSizes find_input_error_sizes(const std::vector<ErrorResponse>& segments, InputErrorSizes sizes,
                                       const InputErrorSizesOptions& options) {
  const std::size_t kinds = at(sizes.factors.size());
  const std::vector<Block> blocks = blocks_of(segments, kinds);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    // What the residual has of each share, and what R has of it.
    Eigen::VectorXd noise = Eigen::VectorXd::Zero(sizes.noise.size()), of_noise = noise;
    Eigen::VectorXd error = Eigen::VectorXd::Zero(sizes.factors.size()), of_error = error;
    for (const Block& block : blocks) {
      const Index n = block.residual.size();
      Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
      for (Index i = 0; i < n; ++i) R(i, i) = sizes.noise(block.output[i]) * sizes.noise(block.output[i]);
      for (std::size_t j = 0; j < kinds; ++j) R += sizes.factors(j) * sizes.factors(j) * block.by_error[j];
      const numerics::Cholesky factor(R);
      if (!factor.positive_definite()) return sizes;
      const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
      const Eigen::VectorXd q = inverse * block.residual;
      for (Index i = 0; i < n; ++i) {
        noise(block.output[i]) += q(i) * q(i);
        of_noise(block.output[i]) += inverse(i, i);
      }
      for (std::size_t j = 0; j < kinds; ++j) {
        error(j) += q.dot(block.by_error[j] * q);
        of_error(j) += inverse.cwiseProduct(block.by_error[j]).sum();
      }
    }
    for (Index o = 0; o < noise.size() && options.noise; ++o)
      if (noise(o) > 0.0) sizes.noise(o) *= std::pow(noise(o) / of_noise(o), 0.25);
    for (Index j = 0; j < error.size() && options.factors; ++j) {
      const double variance = sizes.factors(j) * sizes.factors(j);
      sizes.factors(j) *= std::pow(
          (error(j) + options.prior_errors / (variance * variance)) / (of_error(j) + options.prior_errors / variance),
          0.25);
    }
  }
  return sizes;
}

}  // namespace veridyn::estimation
