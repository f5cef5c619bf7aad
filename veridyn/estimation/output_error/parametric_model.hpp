#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/numerics/parallel.hpp"

namespace veridyn::estimation {

/// An unknown of a parametric model and what is known of it before the data are used.
struct ModelParameter {
  std::string name;
  std::string unit = "1";
  double start = 0.0;  ///< where the search begins; also the mean of the prior
  double low = -kInfinity;
  double high = kInfinity;
  /// Standard deviation of the prior about `start`; infinity: no prior.
  double prior_sigma = kInfinity;
  bool fixed = false;  ///< stays at `start`
};

/// An output of a parametric model.
struct ModelOutput {
  std::string name;
  std::string unit = "1";
};

/// What a model predicts for one segment.
struct ModelResponse {
  RowMatrix output;  ///< samples x outputs
  /// (samples outputs) x active parameters: row k outputs + j holds d output(k, j) / d parameter.
  RowMatrix sensitivity;
};

/// A dynamic (or static) model as estimators see it, whatever the domain: named parameters that all segments share,
/// initial conditions of each segment, named outputs at the samples of each segment, and their exact derivatives.
///
/// A segment is one stretch of recorded motion. Its inputs, its sampling and its integrator are the model's own
/// business. theta is always [parameters; initial conditions of the segment]. Functions are const and called from
/// several threads at once. `AutodiffModel` below makes the derivatives out of one function template.
class ParametricModel {
 public:
  virtual ~ParametricModel() = default;

  [[nodiscard]] virtual std::span<const ModelParameter> parameters() const = 0;
  [[nodiscard]] virtual std::span<const ModelOutput> outputs() const = 0;
  [[nodiscard]] virtual std::size_t segments() const = 0;
  [[nodiscard]] virtual Eigen::Index samples(std::size_t segment) const = 0;
  /// Unknowns of this segment only: initial states, mostly.
  [[nodiscard]] virtual std::span<const ModelParameter> initial_conditions(std::size_t segment) const = 0;
  /// For messages: "segment 3 (41.0 to 49.5 s)".
  [[nodiscard]] virtual std::string segment_name(std::size_t segment) const {
    return "segment " + std::to_string(segment + 1);
  }

  /// Outputs at `theta`, and their derivatives with respect to theta(active[0]), theta(active[1]), ...; none when
  /// `active` is empty. False when the simulation diverges or leaves the model's range; `response` is then worthless.
  [[nodiscard]] virtual bool respond(std::size_t segment, const Eigen::VectorXd& theta,
                                     std::span<const Eigen::Index> active, ModelResponse& response) const = 0;
};

/// Calls `work(segment)` for all segments of a model, on `threads` threads (0: as many as the machine has).
inline void for_each_segment(const ParametricModel& model, int threads, const std::function<void(std::size_t)>& work) {
  numerics::parallel_for(model.segments(), threads, work);
}

/// Derivatives of `Derived::simulate` by ceres::Jet, exact to rounding; `kStride` parameters per pass.
///
/// Derived has
///
///     template <typename Scalar>
///     bool simulate(std::size_t segment, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
///                   Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const;
///
/// called with double and Jet<double, kStride>; `output` comes sized samples x outputs. It returns false when it
/// diverges. A model that forgets its initial conditions may have
///
///     bool simulate_transient(std::size_t segment, theta, output) const;
///
/// with Jets that have derivatives with respect to initial conditions only, of which only the output's derivatives are
/// used: it need not simulate for longer than they last.
///
/// `Base` is ParametricModel or an interface that extends it.
template <typename Derived, int kStride = 8, std::derived_from<ParametricModel> Base = ParametricModel>
class AutodiffModel : public Base {
 public:
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override {
    const auto& model = static_cast<const Derived&>(*this);
    const Eigen::Index N = model.samples(segment);
    const auto p = signed_index(model.outputs().size());
    const auto n = signed_index(active.size());
    response.output.resize(N, p);
    response.sensitivity.resize(N * p, n);
    if (n == 0) return model.simulate(segment, theta, response.output) && response.output.allFinite();
    JetVector jets(theta.size());
    JetMatrix output(N, p);
    for (const Pass& pass : passes(active)) {
      for (Eigen::Index i = 0; i < theta.size(); ++i) jets(i) = Jet(theta(i));
      for (std::size_t j = 0; j < pass.columns.size(); ++j) jets(active[pass.columns[j]]).v(j) = 1.0;
      if (!run(pass, segment, jets, output)) return false;
      for (Eigen::Index k = 0; k < N; ++k) {
        for (Eigen::Index j = 0; j < p; ++j) {
          if (!pass.transient) response.output(k, j) = output(k, j).a;
          for (std::size_t i = 0; i < pass.columns.size(); ++i)
            response.sensitivity(k * p + j, pass.columns[i]) = output(k, j).v(i);
        }
      }
    }
    return response.output.allFinite() && response.sensitivity.allFinite();
  }

 private:
  using Jet = ceres::Jet<double, kStride>;
  using JetVector = Eigen::Matrix<Jet, Eigen::Dynamic, 1>;
  using JetMatrix = Eigen::Matrix<Jet, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// The unknowns whose derivatives one simulation gives.
  struct Pass {
    std::vector<Eigen::Index> columns;  ///< of the sensitivity
    bool transient = false;             ///< of initial conditions alone
  };

  static constexpr bool has_transients() {
    return requires(const Derived& model, std::size_t segment, const JetVector& theta, JetMatrix& output) {
      { model.simulate_transient(segment, theta, output) } -> std::same_as<bool>;
    };
  }

  /// Initial conditions by themselves, if only while they last, where that leaves fewer whole passes.
  [[nodiscard]] std::vector<Pass> passes(std::span<const Eigen::Index> active) const {
    const auto is_initial = [&](Eigen::Index unknown) { return unknown >= signed_index(this->parameters().size()); };
    const auto whole = [](std::ptrdiff_t unknowns) { return (unknowns + kStride - 1) / kStride; };
    const std::ptrdiff_t initial = std::ranges::count_if(active, is_initial), all = std::ssize(active);
    const bool apart = has_transients() && initial < all && whole(all - initial) < whole(all);
    std::vector<Pass> out;
    for (const bool transient : {false, true}) {
      bool full = true;
      for (Eigen::Index i = 0; i < all; ++i) {
        if ((apart && is_initial(active[i])) != transient) continue;
        if (full) out.push_back({.columns = {}, .transient = transient});
        out.back().columns.push_back(i);
        full = out.back().columns.size() == kStride;
      }
    }
    return out;
  }

  bool run(const Pass& pass, std::size_t segment, const JetVector& theta, JetMatrix& output) const {
    const auto& model = static_cast<const Derived&>(*this);
    if constexpr (has_transients())
      if (pass.transient) return model.simulate_transient(segment, theta, output);
    return model.simulate(segment, theta, output);
  }
};

}  // namespace veridyn::estimation
