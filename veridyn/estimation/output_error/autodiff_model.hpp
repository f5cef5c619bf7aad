#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"

namespace veridyn::estimation {

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
