#include "veridyn/estimation/output_error/correlated_noise_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// Standard deviation of an unknown without a prior, in units of what one measured value says of it.
constexpr double kUnknownBefore = 1e4;

/// Sensitivities and residuals of all segments, about the mean of the priors.
struct Linearised {
  std::vector<RowMatrix> columns;  ///< by segment: (samples outputs) x (unknowns, in units of their priors; residual)
  Index unknowns = 0;
};

/// All that a segment's unknowns are at an estimate: the shared ones, then its own.
Eigen::VectorXd values_of(const ParametricModel& model, const OutputErrorEstimate& estimate, std::size_t segment) {
  const auto initial = model.initial_conditions(segment);
  Eigen::VectorXd theta(estimate.theta.size() + signed_index(initial.size()));
  theta.head(estimate.theta.size()) = estimate.theta;
  for (std::size_t i = 0; i < initial.size(); ++i) {
    double value = initial[i].start;
    for (const SegmentParameter& p : estimate.segment_parameters)
      if (p.segment == segment && p.name == initial[i].name) value = p.value;
    theta(estimate.theta.size() + signed_index(i)) = value;
  }
  return theta;
}

/// One segment's part of `Linearised`: which of its unknowns stand in which column.
struct SegmentUnknowns {
  std::vector<Index> active;  ///< in the segment's theta
  std::vector<Index> column;
  std::vector<const ModelParameter*> of;
};

std::vector<SegmentUnknowns> free_unknowns(const ParametricModel& model, const OutputErrorEstimate& estimate,
                                           Index& columns) {
  std::vector<SegmentUnknowns> all(model.segments());
  const bool starts = !estimate.segment_parameters.empty();
  columns = 0;
  const auto parameters = model.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].fixed) continue;
    for (SegmentUnknowns& s : all) {
      s.active.push_back(signed_index(i));
      s.column.push_back(columns);
      s.of.push_back(&parameters[i]);
    }
    ++columns;
  }
  for (std::size_t s = 0; s < all.size() && starts; ++s) {
    const auto initial = model.initial_conditions(s);
    for (std::size_t i = 0; i < initial.size(); ++i) {
      if (initial[i].fixed) continue;
      all[s].active.push_back(signed_index(parameters.size() + i));
      all[s].column.push_back(columns++);
      all[s].of.push_back(&initial[i]);
    }
  }
  return all;
}

std::optional<Linearised> linearised(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                     const OutputErrorEstimate& estimate, const Eigen::VectorXd& sigma, int threads) {
  Linearised out;
  const std::vector<SegmentUnknowns> unknowns = free_unknowns(model, estimate, out.unknowns);
  out.columns.resize(measured.size());
  std::vector<char> good(measured.size(), 0);
  for_each_segment(model, threads, [&](std::size_t s) {
    const SegmentUnknowns& of_segment = unknowns[s];
    const Eigen::VectorXd theta = values_of(model, estimate, s);
    ModelResponse response;
    if (!model.respond(s, theta, of_segment.active, response)) return;
    good[s] = 1;
    const Index outputs = sigma.size(), rows = measured[s].size();
    RowMatrix& part = out.columns[s];
    part = RowMatrix::Zero(rows, out.unknowns + 1);
    for (Index r = 0; r < rows; ++r)
      part(r, out.unknowns) =
          (measured[s](r / outputs, r % outputs) - response.output(r / outputs, r % outputs)) / sigma(r % outputs);
    for (std::size_t i = 0; i < of_segment.active.size(); ++i) {
      Eigen::VectorXd column = response.sensitivity.col(i);
      for (Index r = 0; r < rows; ++r) column(r) /= sigma(r % outputs);
      const double norm = column.norm(), prior = of_segment.of[i]->prior_sigma;
      const bool known = std::isfinite(prior);
      if (known) part.col(out.unknowns) += column * (theta(of_segment.active[i]) - of_segment.of[i]->start);
      part.col(of_segment.column[i]) = column * (known ? prior : norm > 0.0 ? kUnknownBefore / norm : 0.0);
    }
  });
  if (std::count(good.begin(), good.end(), 0) > 0) return std::nullopt;
  return out;
}

/// Whitens columns of (samples outputs) values in place, at the rows that were measured; the logarithm of the
/// determinant of the noise's correlation matrix.
double whiten(const RowMatrix& measured, const Eigen::VectorXd& phi, RowMatrix& columns) {
  const Index outputs = phi.size();
  double log_determinant = 0.0;
  for (Index j = 0; j < outputs; ++j) {
    Index last = -1;
    Eigen::RowVectorXd before;
    for (Index k = 0; k < measured.rows(); ++k) {
      auto row = columns.row(k * outputs + j);
      if (!std::isfinite(measured(k, j))) {
        row.setZero();
        continue;
      }
      const Eigen::RowVectorXd unwhitened = row;
      if (last >= 0) {
        const double kept = std::pow(phi(j), static_cast<double>(k - last));
        row = (unwhitened - kept * before) / std::sqrt(1.0 - kept * kept);
        log_determinant += std::log(1.0 - kept * kept);
      }
      before = unwhitened;
      last = k;
    }
  }
  return log_determinant;
}

/// View of a linearised model: twice the negative logarithm of the marginal likelihood, the noise's size at its best.
class MarginalLikelihood {
 public:
  MarginalLikelihood(const std::vector<RowMatrix>& measured, const Linearised& linearised)
      : measured_(measured), linearised_(linearised) {
    for (const RowMatrix& z : measured) values_ += static_cast<double>((z.array() == z.array()).count());
  }

  [[nodiscard]] double at(const Eigen::VectorXd& phi) const {
    const Index n = linearised_.unknowns;
    Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(n + 1, n + 1);
    double log_determinant = 0.0;
    for (std::size_t s = 0; s < measured_.size(); ++s) {
      RowMatrix columns = linearised_.columns[s];
      log_determinant += whiten(measured_[s], phi, columns);
      cross += columns.transpose() * columns;
    }
    // cov = s^2 R + S S' with S in units of the priors; in the eigenvectors of S'R^-1 S.
    const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(cross.topLeftCorner(n, n));
    const Eigen::VectorXd b = eigen.vectors.transpose() * cross.topRightCorner(n, 1);
    const Eigen::VectorXd information = eigen.values.cwiseMax(0.0);
    const auto of_size = [&](double log_variance) {
      const double variance = std::exp(log_variance);
      const double squares = cross(n, n) - (b.array().square() / (information.array() + variance)).sum();
      return values_ * log_variance + log_determinant + (1.0 + information.array() / variance).log().sum() +
             std::max(0.0, squares) / variance;
    };
    constexpr double kSizes = 100.0;
    return least(of_size, -2.0 * std::log(kSizes), 2.0 * std::log(kSizes)).second;
  }

  /// Place and value of the least by golden sections.
  template <typename Function>
  static std::pair<double, double> least(const Function& f, double low, double high) {
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSections = 40;
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low), fa = f(a), fb = f(b);
    for (int i = 0; i < kSections; ++i) {
      if (fa < fb) {
        high = b;
        b = a;
        fb = fa;
        a = high - kGolden * (high - low);
        fa = f(a);
      } else {
        low = a;
        a = b;
        fa = fb;
        b = low + kGolden * (high - low);
        fb = f(b);
      }
    }
    return fa < fb ? std::pair{a, fa} : std::pair{b, fb};
  }

 private:
  const std::vector<RowMatrix>& measured_;
  const Linearised& linearised_;
  double values_ = 0.0;
};

}  // namespace

CorrelatedNoiseModel::CorrelatedNoiseModel(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                           Eigen::VectorXd correlation)
    : ModelView(model) {
  VERIDYN_ASSERT(measured.size() == model.segments());
  VERIDYN_ASSERT((correlation.array() >= 0.0).all() && (correlation.array() < 1.0).all());
  for (const RowMatrix& z : measured) {
    RowMatrix kept = RowMatrix::Zero(z.rows(), z.cols());
    Eigen::MatrixXi before = Eigen::MatrixXi::Zero(z.rows(), z.cols());
    for (Index j = 0; j < z.cols(); ++j) {
      Index last = -1;
      for (Index k = 0; k < z.rows(); ++k) {
        if (!std::isfinite(z(k, j))) continue;
        if (last >= 0) {
          kept(k, j) = std::pow(correlation(j), static_cast<double>(k - last));
          before(k, j) = static_cast<int>(last);
        }
        last = k;
      }
    }
    kept_.push_back(std::move(kept));
    before_.push_back(std::move(before));
  }
}

bool CorrelatedNoiseModel::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Index> active,
                                   ModelResponse& response) const {
  if (!viewed().respond(segment, theta, active, response)) return false;
  response.output = whitened(segment, response.output);
  if (active.empty()) return true;
  const RowMatrix& kept = kept_[segment];
  // From the end, so that what a row needs is still as the model gave it.
  for (Index k = kept.rows() - 1; k >= 0; --k) {
    for (Index j = 0; j < kept.cols(); ++j) {
      const double c = kept(k, j);
      if (c == 0.0) continue;
      const Index from = before_[segment](k, j) * kept.cols() + j, to = k * kept.cols() + j;
      response.sensitivity.row(to) =
          (response.sensitivity.row(to) - c * response.sensitivity.row(from)) / std::sqrt(1.0 - c * c);
    }
  }
  return true;
}

RowMatrix CorrelatedNoiseModel::whitened(std::size_t segment, const RowMatrix& values) const {
  RowMatrix v = values;
  for (Index k = 0; k < v.rows(); ++k) {
    for (Index j = 0; j < v.cols(); ++j) {
      const double c = kept_[segment](k, j);
      if (c != 0.0) v(k, j) = (values(k, j) - c * values(before_[segment](k, j), j)) / std::sqrt(1.0 - c * c);
    }
  }
  return v;
}

std::vector<RowMatrix> CorrelatedNoiseModel::whitened(const std::vector<RowMatrix>& values) const {
  std::vector<RowMatrix> all;
  for (std::size_t s = 0; s < values.size(); ++s) all.push_back(whitened(s, values[s]));
  return all;
}

RowMatrix CorrelatedNoiseModel::restored(std::size_t segment, const RowMatrix& values) const {
  RowMatrix y = values;
  for (Index k = 0; k < y.rows(); ++k) {
    for (Index j = 0; j < y.cols(); ++j) {
      const double c = kept_[segment](k, j);
      if (c != 0.0) y(k, j) = values(k, j) * std::sqrt(1.0 - c * c) + c * y(before_[segment](k, j), j);
    }
  }
  return y;
}

std::optional<NoiseCorrelation> noise_correlation(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                                  const OutputErrorEstimate& estimate, const Eigen::VectorXd& sigma,
                                                  int threads) {
  const std::optional<Linearised> parts = linearised(model, measured, estimate, sigma, threads);
  if (!parts) return std::nullopt;
  const MarginalLikelihood likelihood(measured, *parts);
  constexpr std::array kPlaces{0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98};
  constexpr int kSweeps = 2;
  NoiseCorrelation found{.correlation = Eigen::VectorXd::Zero(sigma.size())};
  const double white = likelihood.at(found.correlation);
  double best = white;
  for (int sweep = 0; sweep < (sigma.size() > 1 ? kSweeps : 1); ++sweep) {
    for (Index j = 0; j < sigma.size(); ++j) {
      Eigen::VectorXd phi = found.correlation;
      const auto of = [&](double value) {
        phi(j) = value;
        return likelihood.at(phi);
      };
      std::size_t place = 0;
      double least = kInfinity;
      for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        const double now = of(kPlaces[i]);
        if (now < least) {
          least = now;
          place = i;
        }
      }
      const auto [value, at_value] = MarginalLikelihood::least(of, kPlaces[place > 0 ? place - 1 : 0],
                                                               kPlaces[std::min(place + 1, kPlaces.size() - 1)]);
      if (at_value >= best) continue;
      best = at_value;
      found.correlation(j) = value;
    }
  }
  found.gain = white - best;
  return found;
}

}  // namespace veridyn::estimation
