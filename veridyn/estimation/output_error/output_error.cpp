#include "veridyn/estimation/output_error/output_error.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/option_check.hpp"
#include "veridyn/estimation/output_error/output_error_problem.hpp"
#include "veridyn/estimation/output_error/residual_spectrum.hpp"
#include "veridyn/estimation/output_error/solver_views.hpp"
#include "veridyn/estimation/output_error/undetermined_directions.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using internal::EvaluateSegments;
using internal::OutputErrorProblem;
using internal::PriorCost;
using internal::SegmentCost;
using internal::Watch;

/// Share of a parameter's unit vector in what is not identifiable above which it has no error bar.
constexpr double kShareWithoutErrorBar = 1e-4;

/// Whether a search ended at the limit of what an unknown may be.
bool ends_at_bound(double value, const ModelParameter& unknown) {
  constexpr double kRounding = 1e-6;
  const auto at = [&](double bound) {
    const double range = unknown.high - unknown.low;
    return std::isfinite(bound) &&
           std::abs(value - bound) <= kRounding * (std::isfinite(range) ? range : std::abs(bound - unknown.start));
  };
  return at(unknown.low) || at(unknown.high);
}

/// View of one call's model, measurements, options and progress, with what the search has found so far.
class Estimation {
 public:
  Estimation(const ParametricModel& model, const std::vector<RowMatrix>& measured, const OutputErrorOptions& options,
             Progress& progress)
      : options_(options), progress_(progress), problem_(model, measured, options) {}

  OutputErrorEstimate run() {
    search();
    finish();
    result_.simulations = problem_.simulations();
    return std::move(result_);
  }

 private:
  void end(OutputErrorTermination termination, std::string message) {
    result_.termination = termination;
    result_.message = std::move(message);
  }

  void search() {
    result_.values = problem_.values();
    if (problem_.values() <= problem_.all_unknowns()) {
      return end(OutputErrorTermination::kTooFewSamples,
                 fmt::format("{} measured values for {} unknowns", problem_.values(), problem_.all_unknowns()));
    }
    problem_.evaluate(false);
    if (!problem_.valid()) {
      result_.diverged_segment = problem_.diverged_segment();
      return end(OutputErrorTermination::kDivergedAtStart,
                 fmt::format("the simulation of {} diverges at the starting values", problem_.diverged_segment()));
    }
    problem_.start_noise();
    if (options_.hold_undetermined) problem_.evaluate(true);
    for (int relaxation = 0; relaxation < options_.max_relaxations; ++relaxation) {
      ++result_.relaxations;
      const Eigen::VectorXd before = problem_.shared();
      if (!solve()) {
        if (result_.has_estimate()) {
          problem_.evaluate(true);
          problem_.update_noise();
        }
        return;
      }
      problem_.evaluate(true);
      const double noise_change = problem_.update_noise();
      const double moved = problem_.largest_change_in_sigma(before);
      if (!progress_.update(static_cast<double>(relaxation + 1) / options_.max_relaxations)) {
        return end(OutputErrorTermination::kInterrupted, "");
      }
      if (relaxation > 0 && moved < options_.tolerance && noise_change < 10.0 * options_.tolerance) {
        return end(OutputErrorTermination::kConverged, "");
      }
    }
    end(OutputErrorTermination::kRelaxations, "");
  }

  /// One relaxation: parameters at fixed R. Where one meets a bound the rest of the way is gone without it.
  bool solve() {
    if (problem_.all_unknowns() == 0) return true;
    std::vector<int> held;
    if (problem_.reaches_bounds()) {
      problem_.evaluate(true);
      if (problem_.valid()) held = problem_.pressed_on_bounds();
    }
    for (;;) {
      const Solved solved = solve(held);
      if (solved != Solved::kMeetsBound) return solved == Solved::kDone;
      const std::vector<int> pressed = problem_.pressed_on_bounds();
      std::vector<int> all;
      std::ranges::set_union(held, pressed, std::back_inserter(all));
      held = std::move(all);
    }
  }

  enum class Solved { kDone, kMeetsBound, kEnded };
  /// Without some of the shared unknowns, by their place.
  Solved solve(const std::vector<int>& held) {
    EvaluateSegments evaluate(problem_);
    ceres::Problem::Options problem_options;
    problem_options.evaluation_callback = &evaluate;
    ceres::Problem ceres_problem(problem_options);
    double* shared = problem_.shared_block();
    const auto bound = [&](double* block, const std::vector<const ModelParameter*>& unknowns) {
      Eigen::VectorXd start(unknowns.size()), root(start.size());
      for (std::size_t i = 0; i < unknowns.size(); ++i) {
        const ModelParameter& p = *unknowns[i];
        const auto at = static_cast<int>(i);
        if (std::isfinite(p.low)) ceres_problem.SetParameterLowerBound(block, at, p.low);
        if (std::isfinite(p.high)) ceres_problem.SetParameterUpperBound(block, at, p.high);
        start(at) = p.start;
        root(at) = problem_.prior_root(p);
      }
      if (root.size() > 0 && root.maxCoeff() > 0.0)
        ceres_problem.AddResidualBlock(new PriorCost(start, root), nullptr, block);
    };
    auto* ordering = new ceres::ParameterBlockOrdering;
    for (std::size_t s = 0; s < problem_.segments(); ++s) {
      std::vector<double*> blocks;
      if (problem_.local_count(s) > 0) blocks.push_back(problem_.local_block(s));
      if (problem_.shared_count() > 0) blocks.push_back(shared);
      if (blocks.empty()) continue;
      ceres_problem.AddResidualBlock(new SegmentCost(problem_, s), nullptr, blocks);
      if (problem_.local_count(s) > 0) {
        ordering->AddElementToGroup(problem_.local_block(s), 0);
        bound(problem_.local_block(s), problem_.local_unknowns(s));
      }
    }
    if (problem_.shared_count() > 0) {
      ordering->AddElementToGroup(shared, 1);
      bound(shared, problem_.shared_unknowns());
      if (options_.hold_undetermined)
        internal::hold_undetermined(ceres_problem, shared, problem_.shared_unknowns(), information_root());
    }
    if (!held.empty() && std::ssize(held) == problem_.shared_count())
      ceres_problem.SetParameterBlockConstant(shared);
    else if (!held.empty())
      ceres_problem.SetManifold(shared, new ceres::SubsetManifold(static_cast<int>(problem_.shared_count()), held));
    ceres::Solver::Options o;
    o.linear_solver_ordering.reset(ordering);
    // QR keeps the digits of ill-conditioned problems; elimination of the segments' unknowns is for very many of them.
    const bool many = problem_.all_unknowns() > 400 && problem_.shared_count() > 0;
    o.linear_solver_type = many ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
    o.max_num_iterations = options_.max_steps;
    // Steps in a valley that gain less than what moves parameters by `tolerance` sigma are not worth their simulations.
    const double coarser = std::max(1.0, options_.tolerance / OutputErrorOptions().tolerance);
    o.function_tolerance = 1e-10 * coarser * coarser;
    o.gradient_tolerance = 1e-12;
    o.parameter_tolerance = 1e-12;
    // Close to the solution full Gauss-Newton steps are right; damping would only slow them.
    if (result_.relaxations > 1) o.initial_trust_region_radius = 1e12;
    o.num_threads = 1;
    o.logging_type = ceres::SILENT;
    Watch watch(progress_, problem_, held);
    o.update_state_every_iteration = true;
    o.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(o, &ceres_problem, &summary);
    result_.steps += summary.num_successful_steps + summary.num_unsuccessful_steps;
    result_.diverged_steps = problem_.diverged_evaluations();
    result_.diverged_segment = problem_.diverged_segment();
    result_.accepted_steps += watch.accepted_steps();
    if (watch.interrupted()) {
      end(OutputErrorTermination::kInterrupted, "");
      return Solved::kEnded;
    }
    if (summary.termination_type == ceres::FAILURE) {
      end(OutputErrorTermination::kSolverFailed, fmt::format("the optimiser could not go on: {}", summary.message));
      return Solved::kEnded;
    }
    return watch.meets_bound() ? Solved::kMeetsBound : Solved::kDone;
  }

  void finish() {
    const ParametricModel& model = problem_.model();
    const auto parameters = model.parameters();
    const auto n = static_cast<Index>(parameters.size());
    result_.theta = problem_.full_shared();
    result_.covariance = result_.covariance_by_model = result_.covariance_white = Eigen::MatrixXd::Zero(n, n);
    result_.learned_share = Eigen::VectorXd::Ones(n);
    result_.noise_covariance = problem_.noise();
    result_.parameters.resize(parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      Parameter& p = result_.parameters[i];
      p.name = parameters[i].name;
      p.unit = parameters[i].unit;
      p.value = result_.theta(i);
      p.sigma = p.sigma_white = parameters[i].fixed ? 0.0 : kInfinity;
      p.low95 = p.value - p.sigma;
      p.high95 = p.value + p.sigma;
      p.status = parameters[i].fixed ? ParameterStatus::kFixed : ParameterStatus::kRejected;
    }
    if (!result_.has_estimate()) {
      if (result_.message.empty()) result_.message = "interrupted";
      return;
    }
    problem_.evaluate(true);
    result_.negative_log_likelihood = problem_.negative_log_likelihood();
    result_.samples_as_one = problem_.samples_per_independent_one();
    error_bars();
    for (std::size_t s = 0; s < problem_.segments(); ++s) {
      result_.predicted.push_back(problem_.predicted(s));
      for (std::size_t i = 0; i < problem_.local_names(s).size(); ++i) {
        result_.segment_parameters.push_back(
            {s, problem_.local_names(s)[i], problem_.local_units(s)[i], problem_.local_block(s)[i]});
      }
    }
    result_.outputs = problem_.output_fits();
    if (!result_.message.empty()) return;
    const char* how = result_.termination == OutputErrorTermination::kConverged     ? "converged"
                      : result_.termination == OutputErrorTermination::kInterrupted ? "interrupted"
                                                                                    : "stopped";
    result_.message = fmt::format("{} after {} relaxations and {} steps over {} segments, {} values", how,
                                  result_.relaxations, result_.steps, problem_.segments(), result_.values);
    if (result_.diverged_steps > 0) {
      result_.message += fmt::format("; {} steps were refused because a simulation diverged, last that of {}",
                                     result_.diverged_steps, result_.diverged_segment);
    }
    if (!result_.unidentifiable.empty()) {
      result_.message += "; not identifiable:";
      for (const Direction& d : result_.unidentifiable) result_.message += " " + d.text + ";";
      result_.message.pop_back();
      if (!result_.held.empty()) result_.message += "; along these the parameters stay where the search began";
    }
  }

  /// Root of the information: the segments' triangles with their own unknowns eliminated, and the priors.
  RowMatrix information_root() const {
    const auto unknowns = problem_.shared_unknowns();
    RowMatrix root = problem_.shared_root();
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const double of_prior = problem_.prior_root(*unknowns[i]);
      if (of_prior == 0.0) continue;
      root.conservativeResize(root.rows() + 1, Eigen::NoChange);
      root.row(root.rows() - 1) = Eigen::RowVectorXd::Unit(unknowns.size(), static_cast<Index>(i)) * of_prior;
    }
    return root;
  }

  /// Inverse of the information over what the data and priors determine; the rest is `unidentifiable`.
  struct InverseInformation {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd length;  ///< of the information root's columns
    Eigen::VectorXd share;   ///< of each parameter's unit vector in directions that are not identifiable
  };

  /// Empty where the outputs depend on no free parameter.
  std::optional<InverseInformation> invert_information() {
    const Index n = problem_.shared_count();
    const std::vector<Index>& free = problem_.free_shared();
    const RowMatrix root = information_root();
    InverseInformation out;
    out.length = root.colwise().norm().transpose();
    for (double& l : out.length) l = l > 0.0 ? l : 1.0;
    // Where the search holds directions, they are those of the same units here.
    const Eigen::VectorXd unit = options_.hold_undetermined ? internal::bound_sigmas(problem_.shared_unknowns())
                                                            : Eigen::VectorXd(out.length.cwiseInverse());
    const numerics::SingularValues svd =
        numerics::singular_values(root * unit.asDiagonal(), numerics::SingularVectors::kThinUAndFullV);
    const Eigen::VectorXd& s = svd.values;
    const double largest = s.size() > 0 ? s(0) : 0.0;
    if (!(largest > 0.0)) return std::nullopt;
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n);
    out.share = Eigen::VectorXd::Zero(n);
    result_.condition_number = s.size() == n && s(n - 1) > 0.0 ? largest / s(n - 1) : kInfinity;
    std::vector<std::string> names;
    for (const ModelParameter* p : problem_.shared_unknowns()) names.push_back(p->name);
    for (Index j = 0; j < n; ++j) {
      const bool held = options_.hold_undetermined && !(j < s.size() && s(j) > 1.0);
      if (!held && j < s.size() && s(j) > options_.identifiable * largest) {
        inverse(j) = 1.0 / s(j);
        continue;
      }
      out.share += svd.V.col(j).cwiseAbs2();
      Eigen::VectorXd combination = svd.V.col(j).cwiseProduct(unit);
      combination /= combination.norm();
      Eigen::VectorXd all = Eigen::VectorXd::Zero(result_.theta.size());
      for (Index i = 0; i < n; ++i) all(free[i]) = combination(i);
      result_.unidentifiable.push_back({all, kInfinity, describe_combination(combination, names)});
      if (held) result_.held.push_back(result_.unidentifiable.back());
    }
    const Eigen::MatrixXd back = unit.asDiagonal() * svd.V * inverse.asDiagonal();
    out.matrix = back * back.transpose();
    return out;
  }

  /// The inverse information corrected for residuals that are autocorrelated; sets degrees of freedom and lag window.
  Eigen::MatrixXd corrected_for_autocorrelation(const Eigen::MatrixXd& white) {
    const ResidualSpectrum spectrum = residual_spectrum(problem_.whitened_residuals(), options_.max_lag);
    Eigen::MatrixXd filling = problem_.spectral_filling(spectrum) / spectrum.kept;
    const RowMatrix root = problem_.shared_root();
    std::vector<double> ratios;
    for (Index i = 0; i < filling.rows(); ++i)
      if (const double information = root.col(i).squaredNorm(); information > 0.0)
        ratios.push_back(filling(i, i) / information);
    if (!ratios.empty()) result_.autocorrelation = std::max(1.0, numerics::median(ratios));
    // The prior's own error is one of them.
    const double weight = problem_.samples_per_independent_one();
    const auto unknowns = problem_.shared_unknowns();
    for (Index i = 0; i < filling.rows(); ++i) filling(i, i) += weight * std::pow(problem_.prior_root(*unknowns[i]), 2);
    result_.degrees_of_freedom = std::min(result_.degrees_of_freedom, spectrum.degrees_of_freedom);
    result_.lag_window = spectrum.window;
    return white * filling * white;
  }

  /// What the model lacks is as large along the parameters, where no residual shows it, as in any direction beside.
  Eigen::MatrixXd covariance_by_model(const Eigen::MatrixXd& white) const {
    const RowMatrix spread = problem_.shared_root() * white;
    return problem_.model_error() * spread.transpose() * spread;
  }

  void error_bars() {
    const Index n = problem_.shared_count();
    const std::vector<Index>& free = problem_.free_shared();
    if (n == 0) return;
    const std::optional<InverseInformation> information = invert_information();
    if (!information)
      return end(OutputErrorTermination::kNothingToEstimate, "the outputs do not depend on any free parameter");
    const Eigen::MatrixXd& white = information->matrix;
    const Eigen::VectorXd& share = information->share;
    const double values = static_cast<double>(result_.values);
    const double freedom = std::max(1.0, values - static_cast<double>(problem_.all_unknowns()));
    // Residuals are smaller than the noise by the freedom that the fit took.
    const double inflation = values / freedom;
    const double white_inflation = problem_.estimates_noise() ? inflation : 1.0;
    result_.degrees_of_freedom = freedom;
    const bool autocorrelated = options_.covariance == CovarianceKind::kAutocorrelated;
    const Eigen::MatrixXd chosen = autocorrelated ? corrected_for_autocorrelation(white) : white;
    const Eigen::MatrixXd by_model = covariance_by_model(white);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Index a = free[i], b = free[j];
        const bool known = share(i) <= kShareWithoutErrorBar && share(j) <= kShareWithoutErrorBar;
        const double otherwise = i == j ? kInfinity : 0.0;
        result_.covariance(a, b) = known ? (autocorrelated ? inflation : white_inflation) * chosen(i, j) : otherwise;
        result_.covariance_white(a, b) = known ? white_inflation * white(i, j) : otherwise;
        if (known) result_.covariance_by_model(a, b) = by_model(i, j);
      }
    }
    const auto unknowns = problem_.shared_unknowns();
    for (Index i = 0; i < n; ++i) {
      const Index a = free[i];
      Parameter& p = result_.parameters[a];
      p.sigma = std::sqrt(std::max(0.0, result_.covariance(a, a) + result_.covariance_by_model(a, a)));
      p.sigma_white = std::sqrt(std::max(0.0, result_.covariance_white(a, a)));
      set_interval(p, result_.degrees_of_freedom);
      p.unexcited_share = std::min(1.0, share(i));
      const double l = information->length(i);
      p.variance_inflation = std::max(1.0, white(i, i) * l * l);
      const double prior = unknowns[i]->prior_sigma;
      if (std::isfinite(prior))
        result_.learned_share(a) = std::clamp(1.0 - p.sigma_white * p.sigma_white / (prior * prior), 0.0, 1.0);
      if (!std::isfinite(p.sigma)) {
        p.status = ParameterStatus::kNotExcited;
        result_.learned_share(a) = 0.0;
        continue;
      }
      p.status = p.p_value < options_.significance ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
      if (result_.learned_share(a) < 0.1) p.status = ParameterStatus::kNotExcited;
      if (ends_at_bound(p.value, *unknowns[i])) p.status = ParameterStatus::kAtBound;
    }
  }

  const OutputErrorOptions& options_;
  Progress& progress_;
  OutputErrorProblem problem_;
  OutputErrorEstimate result_;
};

}  // namespace

std::string_view to_string(OutputErrorTermination termination) {
  switch (termination) {
    case OutputErrorTermination::kConverged:
      return "converged";
    case OutputErrorTermination::kRelaxations:
      return "relaxations used up";
    case OutputErrorTermination::kInterrupted:
      return "interrupted";
    case OutputErrorTermination::kDivergedAtStart:
      return "diverged at the start";
    case OutputErrorTermination::kTooFewSamples:
      return "too few samples";
    case OutputErrorTermination::kNothingToEstimate:
      return "nothing to estimate";
    case OutputErrorTermination::kSolverFailed:
      return "solver failed";
  }
  return "";
}

const Parameter* OutputErrorEstimate::find(std::string_view name) const { return find_parameter(parameters, name); }

void OutputErrorOptions::validate(const ParametricModel& model) const {
  const OptionCheck require("output_error");
  require(significance > 0.0 && significance < 1.0, "significance", significance, "in (0, 1)");
  require(max_relaxations >= 1, "max_relaxations", max_relaxations, ">= 1");
  require(max_steps >= 0, "max_steps", max_steps, ">= 0");
  require(tolerance > 0.0, "tolerance", tolerance, "> 0");
  require(identifiable > 0.0 && identifiable < 1.0, "identifiable", identifiable, "in (0, 1)");
  require(max_lag >= 0, "max_lag", static_cast<double>(max_lag), ">= 0");
  require(threads >= 0, "threads", threads, ">= 0 (0: those of the progress)");
  for (const ModelParameter& parameter : model.parameters()) {
    if (hold_undetermined && !parameter.fixed && !(std::isfinite(parameter.high - parameter.low)))
      throw InputError(
          "output_error.hold_undetermined",
          fmt::format("needs bounds of '{}', which has none: they say what the data have to beat", parameter.name));
  }
  const auto p = static_cast<Index>(model.outputs().size());
  if (noise_start.size() > 0 && (noise_start.size() != p || !(noise_start.array() > 0.0).all())) {
    throw InputError("output_error.noise_start",
                     fmt::format("has {} values for {} outputs; must have one each, all > 0", noise_start.size(), p));
  }
  for (const Eigen::VectorXd* v : {&input_noise.variance, &input_noise.autocovariance, &input_noise.memory}) {
    if (v->size() != input_noise.variance.size() || (v->size() != 0 && v->size() != p))
      throw InputError("output_error.input_noise", fmt::format("has {} values for {} outputs", v->size(), p));
  }
  if (noise == OutputNoise::kGiven && noise_start.size() == 0)
    throw InputError("output_error.noise_start", "is empty; the given noise needs one standard deviation an output");
  std::vector<std::string> names;
  for (const ModelOutput& output : model.outputs()) names.push_back(output.name);
  for (const std::string& name : output_biases) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw InputError("output_error.output_biases",
                       fmt::format("'{}' is not an output of the model{}", name, suggestion(name, names)));
    }
  }
}

OutputErrorEstimate output_error(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                 const OutputErrorOptions& options) {
  Progress silent;
  return output_error(model, measured, options, silent);
}

OutputErrorEstimate output_error(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                 const OutputErrorOptions& options, Progress& progress) {
  options.validate(model);
  OutputErrorOptions o = options;
  if (o.threads == 0) o.threads = progress.threads();
  return Estimation(model, measured, o, progress).run();
}

}  // namespace veridyn::estimation
