#include "veridyn/estimation/output_error/logged_model.hpp"

#include <chrono>
#include <utility>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::estimation {
namespace {

/// As the log keeps them.
std::vector<double> kept_values(const ModelResponse& response) {
  std::vector<double> values(response.output.data(), response.output.data() + response.output.size());
  values.insert(values.end(), response.sensitivity.data(), response.sensitivity.data() + response.sensitivity.size());
  return values;
}

}  // namespace

LoggedModel::LoggedModel(const ParametricModel& model, std::string name, Misfit misfit, numerics::ValueLog* log)
    : ModelView(model), name_(std::move(name)), misfit_(std::move(misfit)), log_(log) {}

std::uint64_t LoggedModel::key_of(std::size_t segment, const Eigen::VectorXd& theta,
                                  std::span<const Eigen::Index> active) const {
  numerics::Fingerprint key;
  key.add(name_);
  key.add(static_cast<std::uint64_t>(segment));
  for (const double value : theta) key.add(value);
  for (const Eigen::Index i : active) key.add(static_cast<std::uint64_t>(i));
  return key.value();
}

bool LoggedModel::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                          ModelResponse& response) const {
  const auto begun = std::chrono::steady_clock::now();
  const Eigen::Index rows = samples(segment), columns = signed_index(outputs().size());
  const Eigen::Index output = rows * columns, sensitivity = output * signed_index(active.size());
  // One that did not finish is kept without values.
  const auto fits = [&](std::size_t count) { return count == 0 || signed_index(count) == output + sensitivity; };
  bool computed = false, finished = false;
  double seconds = 0.0;
  const auto compute = [&] {
    computed = true;
    finished = viewed().respond(segment, theta, active, response);
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return finished ? kept_values(response) : std::vector<double>();
  };
  const std::vector<double> values = numerics::kept_or_computed(log_, key_of(segment, theta, active), fits, compute);
  if (!computed) {
    finished = !values.empty();
    if (finished) {
      response.output = Eigen::Map<const RowMatrix>(values.data(), rows, columns);
      response.sensitivity = Eigen::Map<const RowMatrix>(values.data() + output, output, signed_index(active.size()));
    }
    const std::lock_guard lock(mutex_);
    ++resumed_;
  }
  note(segment, theta, !active.empty(), finished, seconds, response);
  return finished;
}

void LoggedModel::note(std::size_t segment, const Eigen::VectorXd& theta, bool derivatives, bool finished,
                       double seconds, const ModelResponse& response) const {
  const double misfit = finished ? misfit_(segment, response.output) : kNaN;
  const auto shared = theta.head(parameters().size());
  const std::lock_guard lock(mutex_);
  const auto [found, fresh] =
      place_.try_emplace({std::vector<double>(shared.begin(), shared.end()), derivatives}, evaluations_.size());
  if (fresh)
    evaluations_.push_back({.theta = shared,
                            .derivatives = derivatives,
                            .misfit = std::vector<double>(segments(), kNaN),
                            .failed = std::vector<char>(segments(), 0)});
  ModelEvaluation& e = evaluations_[found->second];
  e.misfit[segment] = misfit;
  e.failed[segment] = finished ? 0 : 1;
  e.seconds += seconds;
}

std::vector<ModelEvaluation> LoggedModel::evaluations() const {
  const std::lock_guard lock(mutex_);
  return evaluations_;
}

std::size_t LoggedModel::resumed() const {
  const std::lock_guard lock(mutex_);
  return resumed_;
}

}  // namespace veridyn::estimation
