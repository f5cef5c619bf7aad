#include "veridyn/estimation/search/nelder_mead.hpp"

#include <algorithm>

namespace veridyn::estimation {
namespace {

/// View of an evaluator: trial points of a simplex.
class Trials {
 public:
  Trials(BatchEvaluator& evaluator, const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& snap,
         std::size_t most)
      : evaluator_(&evaluator), snap_(&snap), most_(evaluator.evaluations().size() + most) {}

  /// Whether the point could be evaluated and is none of the vertices.
  bool at_point(const Eigen::VectorXd& x, const std::vector<SearchPoint>& simplex) {
    const std::vector<Eigen::VectorXd> point = {(*snap_)(x)};
    const bool vertex = std::any_of(simplex.begin(), simplex.end(), [&](const auto& v) { return v.x == point[0]; });
    if (vertex || evaluator_->evaluations().size() >= most_) return false;
    std::vector<SearchValues> values;
    if (!evaluator_->evaluate(point, values)) {
      completed_ = false;
      return false;
    }
    tried_ = {point[0], values[0]};
    return true;
  }
  [[nodiscard]] const SearchPoint& tried() const { return tried_; }
  [[nodiscard]] bool completed() const { return completed_; }

 private:
  BatchEvaluator* evaluator_;
  const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>* snap_;
  std::size_t most_;
  SearchPoint tried_;
  bool completed_ = true;
};

/// One move of the worst vertex; false where there is none.
bool move_worst(std::vector<SearchPoint>& simplex, Trials& trials) {
  const std::size_t n = simplex.size() - 1;
  Eigen::VectorXd center = Eigen::VectorXd::Zero(simplex.front().x.size());
  for (std::size_t i = 0; i < n; ++i) center += simplex[i].x / static_cast<double>(n);
  SearchPoint& worst = simplex.back();
  const Eigen::VectorXd away = center - worst.x;
  if (!trials.at_point(center + away, simplex)) return false;
  const SearchPoint reflected = trials.tried();
  if (better(reflected.values, simplex.front().values)) {
    const bool expanded = trials.at_point(center + 2.0 * away, simplex);
    worst = expanded && better(trials.tried().values, reflected.values) ? trials.tried() : reflected;
    return trials.completed();
  }
  if (better(reflected.values, simplex[n - 1].values)) {
    worst = reflected;
    return true;
  }
  const bool outside = better(reflected.values, worst.values);
  if (!trials.at_point(center + (outside ? 0.5 : -0.5) * away, simplex)) {
    if (outside) worst = reflected;
    return false;
  }
  const SearchValues& bound = outside ? reflected.values : worst.values;
  if (!better(trials.tried().values, bound)) {
    if (outside) worst = reflected;
    return false;
  }
  worst = trials.tried();
  return true;
}

void sort_simplex(std::vector<SearchPoint>& simplex) {
  std::stable_sort(simplex.begin(), simplex.end(),
                   [](const auto& a, const auto& b) { return better(a.values, b.values); });
}

}  // namespace

SimplexMoves move_simplex(BatchEvaluator& evaluator, std::vector<SearchPoint> simplex,
                          const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& snap,
                          std::size_t max_evaluations) {
  Trials trials(evaluator, snap, max_evaluations);
  sort_simplex(simplex);
  // A simplex on known points only moves for nothing, but could do so for ever: between equal points, say.
  const std::size_t most_moves = 10 * max_evaluations;
  for (std::size_t move = 0; move < most_moves && move_worst(simplex, trials); ++move) sort_simplex(simplex);
  sort_simplex(simplex);
  return {std::move(simplex), trials.completed()};
}

}  // namespace veridyn::estimation
