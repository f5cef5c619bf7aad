#pragma once

#include <coin/IpIpoptApplication.hpp>
#include <coin/IpTNLP.hpp>
#include <limits>
#include <vector>

#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

namespace veridyn::test {

/// A `numerics::HorizonProgramme` as Ipopt takes it: states x_1 .. x_N and inputs u_0 .. u_{N-1} as variables with
/// their bounds, the system as sparse equations.
template <int kStates, int kInputs>
class IpoptProgramme final : public Ipopt::TNLP {
 public:
  using Programme = numerics::HorizonProgramme<kStates, kInputs>;
  using State = typename Programme::State;
  using Input = typename Programme::Input;

  IpoptProgramme(const Programme& programme, const State& x0) : stages_(&programme.stages), x0_(x0) {}

  double cost = 0.0;
  std::vector<Input> inputs;  ///< of the solution

  bool get_nlp_info(int& n, int& m, int& jacobian, int& hessian, IndexStyleEnum& style) override {
    n = static_cast<int>(steps()) * kStep;
    m = static_cast<int>(steps()) * kStates;
    jacobian = static_cast<int>(steps()) * kStates * (1 + kInputs) + static_cast<int>(steps() - 1) * kStates * kStates;
    hessian = static_cast<int>(steps()) * (kStates * (kStates + 1) / 2 + kInputs * (kInputs + 1) / 2);
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(int, double* low, double* high, int m, double* equal, double* equal_too) override {
    for (std::size_t k = 0; k < steps(); ++k) {
      const auto& s = (*stages_)[k];
      const auto& next = (*stages_)[k + 1];
      for (int i = 0; i < kInputs; ++i) low[u(k, i)] = s.u_low(i), high[u(k, i)] = s.u_high(i);
      for (int i = 0; i < kStates; ++i) low[x(k, i)] = next.x_low(i), high[x(k, i)] = next.x_high(i);
    }
    const State of_x0 = stages_->front().A * x0_;
    for (int i = 0; i < m; ++i) {
      const auto k = static_cast<std::size_t>(i / kStates);
      equal[i] = equal_too[i] = (*stages_)[k].b(i % kStates) + (k == 0 ? of_x0(i) : 0.0);
    }
    return true;
  }
  bool get_starting_point(int n, bool, double* at, bool, double*, double*, int, bool, double*) override {
    std::fill(at, at + n, 0.0);
    return true;
  }
  bool eval_f(int, const double* z, bool, double& value) override {
    value = 0.5 * x0_.dot(stages_->front().Q * x0_) + stages_->front().q.dot(x0_);
    for (std::size_t k = 0; k < steps(); ++k) {
      const State at = state(z, k);
      const Input in = input(z, k);
      const auto &s = (*stages_)[k], &next = (*stages_)[k + 1];
      value += 0.5 * at.dot(next.Q * at) + next.q.dot(at) + 0.5 * in.dot(s.R * in) + s.r.dot(in);
    }
    return true;
  }
  bool eval_grad_f(int, const double* z, bool, double* gradient) override {
    for (std::size_t k = 0; k < steps(); ++k) {
      const State of_x = (*stages_)[k + 1].Q * state(z, k) + (*stages_)[k + 1].q;
      const Input of_u = (*stages_)[k].R * input(z, k) + (*stages_)[k].r;
      for (int i = 0; i < kStates; ++i) gradient[x(k, i)] = of_x(i);
      for (int i = 0; i < kInputs; ++i) gradient[u(k, i)] = of_u(i);
    }
    return true;
  }
  bool eval_g(int, const double* z, bool, int, double* g) override {
    for (std::size_t k = 0; k < steps(); ++k) {
      const auto& s = (*stages_)[k];
      State left = state(z, k) - s.B * input(z, k);
      if (k > 0) left -= s.A * state(z, k - 1);
      for (int i = 0; i < kStates; ++i) g[static_cast<int>(k) * kStates + i] = left(i);
    }
    return true;
  }
  bool eval_jac_g(int, const double*, bool, int, int, int* row, int* column, double* values) override {
    int at = 0;
    const auto put = [&](int r, int c, double v) {
      if (values) {
        values[at] = v;
      } else {
        row[at] = r;
        column[at] = c;
      }
      ++at;
    };
    for (std::size_t k = 0; k < steps(); ++k) {
      const auto& s = (*stages_)[k];
      for (int i = 0; i < kStates; ++i) {
        const int r = static_cast<int>(k) * kStates + i;
        put(r, x(k, i), 1.0);
        for (int j = 0; j < kInputs; ++j) put(r, u(k, j), -s.B(i, j));
        for (int j = 0; k > 0 && j < kStates; ++j) put(r, x(k - 1, j), -s.A(i, j));
      }
    }
    return true;
  }
  bool eval_h(int, const double*, bool, double factor, int, const double*, bool, int, int* row, int* column,
              double* values) override {
    int at = 0;
    const auto put = [&](int r, int c, double v) {
      if (values) {
        values[at] = factor * v;
      } else {
        row[at] = r;
        column[at] = c;
      }
      ++at;
    };
    for (std::size_t k = 0; k < steps(); ++k) {
      for (int i = 0; i < kStates; ++i) {
        for (int j = 0; j <= i; ++j) put(x(k, i), x(k, j), (*stages_)[k + 1].Q(i, j));
      }
      for (int i = 0; i < kInputs; ++i) {
        for (int j = 0; j <= i; ++j) put(u(k, i), u(k, j), (*stages_)[k].R(i, j));
      }
    }
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn, int, const double* z, const double*, const double*, int, const double*,
                         const double*, double value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    cost = value;
    inputs.clear();
    for (std::size_t k = 0; k < steps(); ++k) inputs.push_back(input(z, k));
  }

 private:
  static constexpr int kStep = kStates + kInputs;  ///< variables of a step: u_k, x_{k+1}
  [[nodiscard]] std::size_t steps() const { return stages_->size() - 1; }
  [[nodiscard]] static int u(std::size_t k, int i) { return static_cast<int>(k) * kStep + i; }
  [[nodiscard]] static int x(std::size_t k, int i) { return static_cast<int>(k) * kStep + kInputs + i; }
  [[nodiscard]] static State state(const double* z, std::size_t k) { return Eigen::Map<const State>(z + x(k, 0)); }
  [[nodiscard]] static Input input(const double* z, std::size_t k) { return Eigen::Map<const Input>(z + u(k, 0)); }

  const std::vector<typename Programme::Stage>* stages_;
  State x0_;
};

/// Ipopt for a convex quadratic programme: constant matrices, Mehrotra's steps, quiet.
[[nodiscard]] inline Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt_for_programmes(double tolerance) {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  ipopt->Options()->SetIntegerValue("print_level", 0);
  ipopt->Options()->SetStringValue("sb", "yes");
  ipopt->Options()->SetNumericValue("tol", tolerance);
  ipopt->Options()->SetNumericValue("bound_relax_factor", 0.0);
  for (const char* constant : {"jac_c_constant", "jac_d_constant", "hessian_constant"})
    ipopt->Options()->SetStringValue(constant, "yes");
  ipopt->Options()->SetStringValue("mehrotra_algorithm", "yes");
  ipopt->Initialize();
  return ipopt;
}

}  // namespace veridyn::test
