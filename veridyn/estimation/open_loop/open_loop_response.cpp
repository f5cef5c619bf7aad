#include "veridyn/estimation/open_loop/open_loop_response.hpp"

#include <vector>

#include "veridyn/core/index.hpp"

namespace veridyn::estimation {

using Eigen::Index;

OpenLoopResponse open_loop_response(const OpenLoopModel& model, std::size_t segment, const Eigen::VectorXd& theta,
                                    const Eigen::MatrixXd& covariance) {
  const auto shared = signed_index(model.parameters().size()), own = theta.size() - shared;
  std::vector<Index> active;
  for (Index i = 0; i < theta.size(); ++i)
    if (i >= shared || covariance(i, i) > 0.0) active.push_back(i);
  ModelResponse all;
  if (!model.respond(segment, theta, active, all)) return {};
  const auto states = signed_index(model.forecast_outputs()), outputs = signed_index(model.outputs().size());
  const Index samples = all.output.rows();
  OpenLoopResponse out{.states = all.output.leftCols(states),
                       .parameters = Eigen::MatrixXd::Zero(samples * states, shared),
                       .conditions = Eigen::MatrixXd::Zero(samples * states, own)};
  for (Index i = 0; i < std::ssize(active); ++i) {
    const Index unknown = active[i];
    auto column = unknown < shared ? out.parameters.col(unknown) : out.conditions.col(unknown - shared);
    for (Index k = 0; k < samples; ++k)
      column.segment(k * states, states) = all.sensitivity.col(i).segment(k * outputs, states);
  }
  return out;
}

}  // namespace veridyn::estimation
