#include "veridyn/estimation/output_error/output_error_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation::internal {
namespace {

using Eigen::Index;

/// Standard deviation of the noise, as a share of the signal's, below which a fit counts as perfect.
constexpr double kNoiseFloor = 1e-8;

/// Simulations with derivatives are kept, to be weighed by another R, where all of them together need no more.
constexpr double kMostKeptBytes = 512.0 * 1024.0 * 1024.0;

bool is_at_bound(double value, const ModelParameter& unknown) { return value <= unknown.low || value >= unknown.high; }

void check_parameters(std::span<const ModelParameter> parameters, const char* what) {
  for (const ModelParameter& p : parameters) {
    const auto fail = [&](const char* which, double value, const std::string& rule) {
      throw InputError(fmt::format("output_error.{}: {}", what, p.name),
                       fmt::format("{} is {}; must be {}", which, value, rule));
    };
    if (!std::isfinite(p.start)) fail("start", p.start, "finite");
    if (!(p.low <= p.high)) fail("low", p.low, fmt::format("<= high = {}", p.high));
    if (!(p.start >= p.low && p.start <= p.high)) fail("start", p.start, fmt::format("in [{}, {}]", p.low, p.high));
    if (!(p.prior_sigma > 0.0)) fail("prior_sigma", p.prior_sigma, "> 0");
  }
}

void check_search_start(std::span<const ModelParameter> parameters, const Eigen::VectorXd& from) {
  if (from.size() == 0) return;
  if (from.size() != static_cast<Index>(parameters.size()))
    throw InputError("output_error.search_start",
                     fmt::format("has {} values for {} parameters", from.size(), parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double value = from(i);
    if (!(value >= parameters[i].low && value <= parameters[i].high))
      throw InputError("output_error.search_start", fmt::format("{} is {}; must be in [{}, {}]", parameters[i].name,
                                                                value, parameters[i].low, parameters[i].high));
  }
}

}  // namespace

OutputErrorProblem::OutputErrorProblem(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                       const OutputErrorOptions& options)
    : model_(model), measured_(measured), options_(options) {
  outputs_ = static_cast<Index>(model.outputs().size());
  if (measured.size() != model.segments() || measured.empty()) {
    throw InputError("output_error.measured", fmt::format("has {} segments; the model has {} and needs at least one",
                                                          measured.size(), model.segments()));
  }
  const auto parameters = model.parameters();
  check_parameters(parameters, "parameters");
  check_search_start(parameters, options.search_start);
  all_shared_.resize(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    all_shared_(i) = parameters[i].start;
    if (parameters[i].fixed) continue;
    free_shared_.push_back(static_cast<Index>(i));
    if (options.search_start.size() > 0) all_shared_(i) = options.search_start(i);
  }
  shared_.resize(free_shared_.size());
  for (std::size_t i = 0; i < free_shared_.size(); ++i) shared_(i) = all_shared_(free_shared_[i]);

  const auto outputs = model.outputs();
  for (Index j = 0; j < outputs_; ++j) {
    const ModelOutput& output = outputs[j];
    const auto& wanted = options.output_biases;
    if (std::find(wanted.begin(), wanted.end(), output.name) == wanted.end()) continue;
    biased_.push_back(j);
    bias_parameters_.push_back({.name = "bias of " + output.name, .unit = output.unit});
  }
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(outputs_), squares = sum, count = sum;
  for (std::size_t s = 0; s < measured.size(); ++s) {
    const RowMatrix& z = measured[s];
    if (z.rows() != model.samples(s) || z.cols() != outputs_) {
      throw InputError(
          fmt::format("output_error.measured: {}", model.segment_name(s)),
          fmt::format("is {} x {}; must be {} samples x {} outputs", z.rows(), z.cols(), model.samples(s), outputs_));
    }
    Segment segment;
    const auto initial = model.initial_conditions(s);
    check_parameters(initial, "initial_conditions");
    segment.initial.resize(initial.size());
    for (std::size_t i = 0; i < initial.size(); ++i) {
      segment.initial(i) = initial[i].start;
      if (options.free_initial_conditions && !initial[i].fixed) segment.free_initial.push_back(static_cast<Index>(i));
    }
    segment.local = Eigen::VectorXd::Zero(segment.free_initial.size() + biased_.size());
    for (std::size_t i = 0; i < segment.free_initial.size(); ++i) {
      segment.local(i) = segment.initial(segment.free_initial[i]);
      segment.active.push_back(all_shared_.size() + segment.free_initial[i]);
    }
    segment.active.insert(segment.active.end(), free_shared_.begin(), free_shared_.end());
    segments_.push_back(std::move(segment));
    for (Index k = 0; k < z.rows(); ++k) {
      for (Index j = 0; j < outputs_; ++j) {
        if (std::isinf(z(k, j))) {
          throw InputError(
              fmt::format("output_error.measured: {}", model.segment_name(s)),
              fmt::format("output {} of sample {} is infinite; a missing value is NaN", outputs[j].name, k));
        }
        if (std::isnan(z(k, j))) continue;
        ++values_;
        sum(j) += z(k, j);
        squares(j) += z(k, j) * z(k, j);
        count(j) += 1.0;
      }
    }
  }
  noise_floor_ = Eigen::VectorXd::Constant(outputs_, 1e-150);
  for (Index j = 0; j < outputs_; ++j) {
    if (count(j) < 1.0) continue;
    const double rms = std::sqrt(squares(j) / count(j));
    if (rms > 0.0) noise_floor_(j) = std::max(1e-150, kNoiseFloor * rms);
  }
  keeps_ = fits_in_memory();
  set_noise(Eigen::MatrixXd::Identity(outputs_, outputs_));
}

Index OutputErrorProblem::all_unknowns() const {
  Index count = shared_.size();
  for (const Segment& s : segments_) count += s.local.size();
  return count;
}

std::vector<const ModelParameter*> OutputErrorProblem::shared_unknowns() const {
  std::vector<const ModelParameter*> unknowns;
  for (const Index i : free_shared_) unknowns.push_back(&model_.parameters()[i]);
  return unknowns;
}

std::vector<const ModelParameter*> OutputErrorProblem::local_unknowns(std::size_t s) const {
  std::vector<const ModelParameter*> unknowns;
  for (const Index i : segments_[s].free_initial) unknowns.push_back(&model_.initial_conditions(s)[i]);
  for (const ModelParameter& bias : bias_parameters_) unknowns.push_back(&bias);
  return unknowns;
}

std::vector<std::string> OutputErrorProblem::local_names(std::size_t s) const {
  std::vector<std::string> names;
  for (const ModelParameter* p : local_unknowns(s)) names.push_back(p->name);
  return names;
}

std::vector<std::string> OutputErrorProblem::local_units(std::size_t s) const {
  std::vector<std::string> units;
  for (const ModelParameter* p : local_unknowns(s)) units.push_back(p->unit);
  return units;
}

Eigen::VectorXd OutputErrorProblem::full_shared() const {
  Eigen::VectorXd all = all_shared_;
  for (std::size_t i = 0; i < free_shared_.size(); ++i) all(free_shared_[i]) = shared_(i);
  return all;
}

Eigen::VectorXd OutputErrorProblem::theta_of(const Segment& segment) const {
  Eigen::VectorXd theta(all_shared_.size() + segment.initial.size());
  theta << full_shared(), segment.initial;
  for (std::size_t i = 0; i < segment.free_initial.size(); ++i)
    theta(all_shared_.size() + segment.free_initial[i]) = segment.local(i);
  return theta;
}

bool OutputErrorProblem::fits_in_memory() const {
  double bytes = 0.0;
  for (std::size_t s = 0; s < segments_.size(); ++s)
    bytes += static_cast<double>(measured_[s].size()) * static_cast<double>(segments_[s].active.size() + 1) * 8.0;
  return 2.0 * bytes <= kMostKeptBytes;
}

bool OutputErrorProblem::recall(Segment& segment, const Eigen::VectorXd& theta) {
  const auto found = std::ranges::find_if(
      segment.simulated, [&](const Simulated& kept) { return kept.theta.size() > 0 && kept.theta == theta; });
  if (found == segment.simulated.end()) return false;
  std::rotate(segment.simulated.begin(), found, found + 1);
  return true;
}

bool OutputErrorProblem::simulate(std::size_t s, ModelResponse& values) {
  ++segments_[s].simulations.values;
  return model_.respond(s, theta_of(segments_[s]), {}, values) && values.output.allFinite();
}

bool OutputErrorProblem::simulate_with_derivatives(std::size_t s) {
  Segment& segment = segments_[s];
  const Eigen::VectorXd theta = theta_of(segment);
  if (recall(segment, theta)) return true;
  std::swap(segment.simulated.front(), segment.simulated.back());
  Simulated& now = segment.simulated.front();
  now.theta.resize(0);
  ++segment.simulations.with_derivatives;
  if (!model_.respond(s, theta, segment.active, now.response) || !now.response.output.allFinite() ||
      !now.response.sensitivity.allFinite())
    return false;
  now.theta = theta;
  return true;
}

void OutputErrorProblem::forget(Segment& segment) { segment.simulated = {}; }

void OutputErrorProblem::linearise(std::size_t s, bool derivatives, const ModelResponse& response, RowMatrix& residual,
                                   RowMatrix& predicted, RowMatrix& rows) const {
  const Segment& segment = segments_[s];
  const RowMatrix& z = measured_[s];
  const auto initial = static_cast<Index>(segment.free_initial.size());
  const auto biases = static_cast<Index>(biased_.size());
  predicted = response.output;
  for (Index b = 0; b < biases; ++b) predicted.col(biased_[b]).array() += segment.local(initial + b);
  residual = z - predicted;
  const Index n = derivatives ? segment.local.size() + shared_.size() : 0;
  rows = RowMatrix::Zero(z.rows() * outputs_, n + 1);
  for (Index k = 0; k < z.rows(); ++k) {
    for (Index j = 0; j < outputs_; ++j) {
      auto row = rows.row(k * outputs_ + j);
      row(n) = residual(k, j);
      if (!derivatives) continue;
      row.head(initial) = -response.sensitivity.row(k * outputs_ + j).head(initial);
      row.segment(initial + biases, shared_.size()) = -response.sensitivity.row(k * outputs_ + j).tail(shared_.size());
      for (Index b = 0; b < biases; ++b)
        if (biased_[b] == j) row(initial + b) = -1.0;
    }
  }
  whiten(residual, rows);
}

void OutputErrorProblem::whiten(const RowMatrix& residual, RowMatrix& rows) const {
  const bool diagonal = options_.noise != OutputNoise::kFull;
  std::vector<Index> seen;
  RowMatrix block;
  for (Index k = 0; k < residual.rows(); ++k) {
    seen.clear();
    for (Index j = 0; j < outputs_; ++j) {
      if (std::isfinite(residual(k, j)))
        seen.push_back(j);
      else
        rows.row(k * outputs_ + j).setZero();
    }
    if (diagonal) {
      for (const Index j : seen) rows.row(k * outputs_ + j) *= whitener_(j, j);
      continue;
    }
    const auto count = static_cast<Index>(seen.size());
    if (count == 0) continue;
    auto all = rows.middleRows(k * outputs_, outputs_);
    if (count == outputs_) {
      all = (whitener_.triangularView<Eigen::Lower>() * all).eval();
      continue;
    }
    // Missing values: the marginal covariance of those that are there.
    block.resize(count, rows.cols());
    Eigen::MatrixXd part(count, count);
    for (Index a = 0; a < count; ++a) {
      block.row(a) = all.row(seen[a]);
      for (Index b = 0; b < count; ++b) part(a, b) = noise_(seen[a], seen[b]);
    }
    block = numerics::Cholesky(part).solve_lower(block);
    for (Index a = 0; a < count; ++a) all.row(seen[a]) = block.row(a);
  }
}

void OutputErrorProblem::evaluate(bool derivatives) {
  for_each_segment(model_, options_.threads, [&](std::size_t s) {
    Segment& segment = segments_[s];
    SegmentTriangle& t = segment.triangle;
    ModelResponse values;
    const bool kept = !derivatives && recall(segment, theta_of(segment));
    t.valid = derivatives ? simulate_with_derivatives(s) : kept || simulate(s, values);
    if (!t.valid) return;
    RowMatrix rows;
    linearise(s, derivatives, derivatives || kept ? segment.simulated.front().response : values, segment.residual,
              segment.predicted, rows);
    t.squares = rows.rightCols(1).squaredNorm();
    if (!derivatives) return;
    if (!keeps_) forget(segment);
    AugmentedQr qr(rows.cols());
    qr.append(rows);
    t.matrix = qr.triangle();
  });
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    if (segments_[s].triangle.valid) continue;
    ++diverged_evaluations_;
    diverged_segment_ = model_.segment_name(s);
    break;
  }
}

SimulationCount OutputErrorProblem::simulations() const {
  SimulationCount count;
  for (const Segment& segment : segments_) count += segment.simulations;
  return count;
}

bool OutputErrorProblem::valid() const {
  return std::all_of(segments_.begin(), segments_.end(), [](const Segment& s) { return s.triangle.valid; });
}

bool OutputErrorProblem::reaches_bounds() const {
  const std::vector<const ModelParameter*> unknowns = shared_unknowns();
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (is_at_bound(shared_(i), *unknowns[i])) return true;
  return false;
}

std::vector<int> OutputErrorProblem::pressed_on_bounds() const {
  std::vector<int> pressed;
  if (options_.hold_undetermined) return pressed;
  const std::vector<const ModelParameter*> unknowns = shared_unknowns();
  for (Index i = 0; i < shared_.size(); ++i) {
    const ModelParameter& p = *unknowns[i];
    if (!is_at_bound(shared_(i), p)) continue;
    double slope = std::pow(prior_root(p), 2) * (shared_(i) - p.start);
    for (const Segment& s : segments_) {
      const RowMatrix& triangle = s.triangle.matrix;
      slope += triangle.col(s.local.size() + i).dot(triangle.col(triangle.cols() - 1));
    }
    if (shared_(i) <= p.low ? slope > 0.0 : slope < 0.0) pressed.push_back(static_cast<int>(i));
  }
  return pressed;
}

double OutputErrorProblem::largest_change_in_sigma(const Eigen::VectorXd& before) const {
  // Samples that say less leave larger ones.
  return shared_.size() > 0 ? (shared_root() * (shared_ - before)).norm() / std::sqrt(discount_) : 0.0;
}

RowMatrix OutputErrorProblem::shared_root() const {
  const Index n = shared_.size();
  Index total = 0;
  for (const Segment& s : segments_) total += s.local.size() + n;
  RowMatrix stacked = RowMatrix::Zero(total, n);
  Index at = 0;
  for (const Segment& s : segments_) {
    const Index locals = s.local.size(), size = locals + n;
    Eigen::MatrixXd shared = s.triangle.matrix.block(0, locals, size, n);
    Index rank = 0;
    if (locals > 0) {
      numerics::Eliminated eliminated =
          numerics::eliminate(s.triangle.matrix.topLeftCorner(size, locals), shared, 1e-10);
      shared = std::move(eliminated.rest);
      rank = eliminated.rank;
    }
    stacked.middleRows(at, size - rank) = shared.bottomRows(size - rank);
    at += size - rank;
  }
  return stacked.topRows(at);
}

std::vector<RowMatrix> OutputErrorProblem::whitened_residuals() const {
  std::vector<RowMatrix> result;
  for (const Segment& s : segments_) {
    RowMatrix rows(s.residual.size(), 1);
    for (Index i = 0; i < s.residual.size(); ++i) rows(i, 0) = s.residual.data()[i];
    whiten(s.residual, rows);
    RowMatrix white(s.residual.rows(), outputs_);
    for (Index i = 0; i < white.size(); ++i) white.data()[i] = std::isfinite(s.residual.data()[i]) ? rows(i, 0) : kNaN;
    result.push_back(std::move(white));
  }
  return result;
}

Eigen::MatrixXd OutputErrorProblem::spectral_filling(const ResidualSpectrum& spectrum) {
  const Index n = shared_.size();
  std::vector<Eigen::MatrixXd> parts(segments_.size(), Eigen::MatrixXd::Zero(n, n));
  for_each_segment(model_, options_.threads, [&](std::size_t s) {
    RowMatrix residual, predicted, rows;
    if (!simulate_with_derivatives(s)) return;
    linearise(s, true, segments_[s].simulated.front().response, residual, predicted, rows);
    if (!keeps_) forget(segments_[s]);
    const Index locals = segments_[s].local.size();
    RowMatrix sensitivity = rows.middleCols(locals, n);
    if (locals > 0) {
      const Eigen::MatrixXd& triangle = segments_[s].triangle.matrix;
      sensitivity -= rows.leftCols(locals) *
                     numerics::shortest_least_squares(triangle.leftCols(locals),
                                                      Eigen::MatrixXd(triangle.middleCols(locals, n)), 1e-10);
    }
    parts[s] = autocorrelated_information(spectrum, sensitivity, outputs_);
  });
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& part : parts) total += part;
  return total;
}

std::vector<OutputFit> OutputErrorProblem::output_fits() const {
  std::vector<OutputFit> fits;
  for (Index j = 0; j < outputs_; ++j) {
    const ModelOutput& output = model_.outputs()[j];
    std::vector<double> measured, predicted;
    double lagged = 0.0, power = 0.0;
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      const RowMatrix& r = segments_[s].residual;
      for (Index k = 0; k < r.rows(); ++k) {
        measured.push_back(measured_[s](k, j));
        predicted.push_back(segments_[s].predicted(k, j));
        if (std::isfinite(r(k, j))) power += r(k, j) * r(k, j);
        if (k > 0 && std::isfinite(r(k, j) * r(k - 1, j))) lagged += r(k, j) * r(k - 1, j);
      }
    }
    fits.push_back({output.name, output.unit, numerics::fit_measures(measured, predicted), std::sqrt(noise_(j, j)),
                    power > 0.0 ? lagged / power : 0.0});
  }
  return fits;
}

}  // namespace veridyn::estimation::internal
