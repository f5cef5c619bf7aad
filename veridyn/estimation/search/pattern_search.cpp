#include "veridyn/estimation/search/pattern_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/search/nelder_mead.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// Sizes of poll and mesh by coordinate, in units of the bounds' distance.
class AdaptiveMesh {
 public:
  AdaptiveMesh(const BlackBoxProblem& problem, double initial)
      : low_(problem.low), high_(problem.high), initial_(initial), poll_(problem.size()) {
    poll_.setConstant(initial);
  }

  [[nodiscard]] const Eigen::VectorXd& poll() const { return poll_; }
  /// In the problem's units.
  [[nodiscard]] double poll_size(Eigen::Index j) const { return poll_(j) * (high_(j) - low_(j)); }
  [[nodiscard]] double mesh_size(Eigen::Index j) const {
    constexpr double kFinest = 0.125;  // of the poll at its first size: a few directions besides the axes
    return kFinest * std::min(1.0, poll_(j) / initial_) * poll_size(j);
  }
  /// The mesh point about `center` that is next to `x`, moved into the bounds.
  [[nodiscard]] Eigen::VectorXd snap(const Eigen::VectorXd& x, const Eigen::VectorXd& center) const {
    Eigen::VectorXd snapped(x.size());
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const double step = mesh_size(j);
      snapped(j) = std::clamp(center(j) + step * std::round((x(j) - center(j)) / step), low_(j), high_(j));
    }
    return snapped;
  }
  void succeed(const Eigen::VectorXd& step) {
    Eigen::VectorXd share(step.size());
    for (Eigen::Index j = 0; j < step.size(); ++j) share(j) = std::abs(step(j)) / poll_size(j);
    const double most = share.maxCoeff(), least = most / static_cast<double>(step.size());
    for (Eigen::Index j = 0; j < step.size(); ++j) {
      if (share(j) > least) poll_(j) = std::min(1.0, 2.0 * poll_(j));
    }
  }
  void fail() { poll_ *= 0.5; }

 private:
  Eigen::VectorXd low_, high_;
  double initial_;
  Eigen::VectorXd poll_;
};

/// View of an evaluator: the state of one search.
class PatternSearch {
 public:
  PatternSearch(BatchEvaluator& evaluator, const PatternOptions& options)
      : evaluator_(&evaluator),
        options_(options),
        mesh_(evaluator.problem(), options.initial_mesh),
        random_(options.seed, "directions of a pattern search"),
        first_(evaluator.evaluations().size()) {}

  bool begin(const Eigen::VectorXd& start) {
    std::vector<SearchValues> values;
    best_.x = start;
    if (!evaluator_->evaluate({&start, 1}, values)) return false;
    best_.values = values[0];
    return true;
  }
  /// False when the evaluator ended.
  bool iterate() {
    const SearchPoint before = best_;
    if (options_.nelder_mead && !search()) return false;
    if (!better(best_.values, before.values) && !poll()) return false;
    if (better(best_.values, before.values)) {
      mesh_.succeed(best_.x - before.x);
    } else {
      mesh_.fail();
    }
    return true;
  }
  [[nodiscard]] bool converged() const { return mesh_.poll().maxCoeff() < options_.tolerance; }
  [[nodiscard]] const SearchPoint& best() const { return best_; }
  /// How far, on the logarithm of the poll's size.
  [[nodiscard]] double fraction() const {
    const double all = std::log(options_.initial_mesh / options_.tolerance);
    return std::clamp(std::log(options_.initial_mesh / mesh_.poll().maxCoeff()) / std::max(all, 1e-9), 0.0, 1.0);
  }

 private:
  /// Points near the best one that span a simplex with it, the best ones first; fewer where the log has fewer.
  [[nodiscard]] std::vector<SearchPoint> simplex() const;
  bool search();
  bool poll();

  BatchEvaluator* evaluator_;
  PatternOptions options_;
  AdaptiveMesh mesh_;
  numerics::RandomStream random_;
  std::size_t first_;
  SearchPoint best_;
};

std::vector<SearchPoint> PatternSearch::simplex() const {
  constexpr double kReach = 2.0;         // in sizes of the poll
  constexpr double kIndependent = 0.02;  // least part of a point, in poll sizes, off the plane of those before it
  const Eigen::Index n = best_.x.size();
  std::vector<const SearchEvaluation*> near;
  for (const SearchEvaluation& e : evaluator_->evaluations().subspan(first_)) {
    bool within = e.values.finite() && e.x != best_.x;
    for (Eigen::Index j = 0; within && j < n; ++j)
      within = std::abs(e.x(j) - best_.x(j)) <= kReach * mesh_.poll_size(j);
    if (within) near.push_back(&e);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto* a, const auto* b) { return better(a->values, b->values); });
  std::vector<SearchPoint> chosen = {best_};
  std::vector<Eigen::VectorXd> basis;
  for (const SearchEvaluation* e : near) {
    if (signed_index(basis.size()) == n) break;
    Eigen::VectorXd d(n);
    for (Eigen::Index j = 0; j < n; ++j) d(j) = (e->x(j) - best_.x(j)) / mesh_.poll_size(j);
    for (const Eigen::VectorXd& b : basis) d -= b.dot(d) * b;
    if (d.norm() < kIndependent) continue;
    basis.push_back(d.normalized());
    chosen.push_back({e->x, e->values});
  }
  return chosen;
}

bool PatternSearch::search() {
  std::vector<SearchPoint> points = simplex();
  const std::size_t vertices = at(best_.x.size()) + 1;
  if (points.size() < vertices) return true;
  const std::size_t most = options_.nelder_mead_evaluations > 0 ? options_.nelder_mead_evaluations : 10 * vertices;
  const Eigen::VectorXd center = best_.x;
  const SimplexMoves moves = move_simplex(
      *evaluator_, std::move(points), [&](const Eigen::VectorXd& x) { return mesh_.snap(x, center); }, most);
  if (better(moves.simplex.front().values, best_.values)) best_ = moves.simplex.front();
  return moves.completed;
}

bool PatternSearch::poll() {
  const Eigen::Index n = best_.x.size();
  Eigen::VectorXd v(n);
  for (double& component : v) component = random_.normal();
  v.normalize();
  std::vector<Eigen::VectorXd> points;
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::VectorXd direction = Eigen::VectorXd::Unit(n, k) - 2.0 * v(k) * v;
    direction /= direction.cwiseAbs().maxCoeff();
    for (const double sign : {1.0, -1.0}) {
      Eigen::VectorXd x = best_.x;
      for (Eigen::Index j = 0; j < n; ++j) x(j) += sign * direction(j) * mesh_.poll_size(j);
      x = mesh_.snap(x, best_.x);
      if (x != best_.x) points.push_back(std::move(x));
    }
  }
  std::vector<SearchValues> values;
  if (!evaluator_->evaluate(points, values)) return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (better(values[i], best_.values)) best_ = {points[i], values[i]};
  }
  return true;
}

}  // namespace

void PatternOptions::validate() const {
  if (!(initial_mesh > 0.0 && initial_mesh <= 1.0))
    throw InputError("search.initial_mesh", fmt::format("is {}; must be in (0, 1]", initial_mesh));
  if (!(tolerance > 0.0 && tolerance < initial_mesh))
    throw InputError("search.tolerance",
                     fmt::format("is {}; must be > 0 and below the first mesh, {}", tolerance, initial_mesh));
}

SearchResult pattern_search(BatchEvaluator& evaluator, const Eigen::VectorXd& start, const PatternOptions& options) {
  options.validate();
  const BlackBoxProblem& problem = evaluator.problem();
  if (start.size() != problem.size() || !(start.array() >= problem.low.array()).all() ||
      !(start.array() <= problem.high.array()).all())
    throw InputError(problem.name, "the start of the pattern search is not within the bounds");
  const std::size_t evaluations = evaluator.evaluations().size(), failed = evaluator.failed();
  PatternSearch search(evaluator, options);
  SearchResult result;
  result.termination = SearchTermination::kIterations;
  bool goes_on = search.begin(start);
  if (!goes_on) result.termination = evaluator.ended();
  while (goes_on && result.iterations < options.iterations) {
    goes_on = search.iterate();
    ++result.iterations;
    if (!goes_on) {
      result.termination = evaluator.ended();
    } else if (search.converged()) {
      result.termination = SearchTermination::kConverged;
      break;
    } else if (!evaluator.progress().update(search.fraction())) {
      result.termination = SearchTermination::kInterrupted;
      break;
    }
  }
  result.x = search.best().x;
  result.values = search.best().values;
  result.evaluations = evaluator.evaluations().size() - evaluations;
  result.failed = evaluator.failed() - failed;
  return result;
}

}  // namespace veridyn::estimation
