#include "veridyn/estimation/output_error/shared_model.hpp"

#include <utility>
#include <vector>

#include "veridyn/core/index.hpp"

namespace veridyn::estimation {

// A request: segment, number of active unknowns, these, theta. A reply: the outputs, then the sensitivities, both row
// by row; nothing where the simulation did not finish.

numerics::SharedWork::Compute SharedModel::responses_of(const ParametricModel& model) {
  return [&model](std::span<const double> request, std::vector<double>& reply) {
    const auto segment = static_cast<std::size_t>(request[0]), count = static_cast<std::size_t>(request[1]);
    std::vector<Eigen::Index> active;
    for (const double i : request.subspan(2, count)) active.push_back(static_cast<Eigen::Index>(i));
    const std::span<const double> values = request.subspan(2 + count);
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(values.data(), signed_index(values.size()));
    ModelResponse response;
    reply.clear();
    if (!model.respond(segment, theta, active, response)) return;
    for (const RowMatrix* part : {&response.output, &response.sensitivity})
      reply.insert(reply.end(), part->data(), part->data() + part->size());
  };
}

bool SharedModel::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                          ModelResponse& response) const {
  if (work_->alone()) return viewed().respond(segment, theta, active, response);
  std::vector<double> request = {static_cast<double>(segment), static_cast<double>(active.size())}, reply;
  for (const Eigen::Index i : active) request.push_back(static_cast<double>(i));
  request.insert(request.end(), theta.begin(), theta.end());
  work_->ask(request, reply);
  if (reply.empty()) return false;
  const Eigen::Index rows = samples(segment), columns = signed_index(outputs().size());
  response.output = Eigen::Map<const RowMatrix>(reply.data(), rows, columns);
  response.sensitivity =
      Eigen::Map<const RowMatrix>(reply.data() + rows * columns, rows * columns, signed_index(active.size()));
  return true;
}

}  // namespace veridyn::estimation
