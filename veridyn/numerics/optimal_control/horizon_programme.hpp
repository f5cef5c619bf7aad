#pragma once

#include <Eigen/Core>
#include <vector>

namespace veridyn::numerics {

/// How a programme over a horizon ended.
enum class ProgrammeEnd {
  kSolved,          ///< residuals below the tolerance
  kIterationLimit,  ///< not yet, after as many iterations as allowed: `residual` says how far
  kInfeasible,      ///< steps came to nothing: the bounds leave no way, or numbers that are none
};

/// Bounds and limits of the iteration.
struct ProgrammeOptions {
  int iterations = 30;      ///< at most
  double tolerance = 1e-9;  ///< of gradient, bounds and complementarity, the cost being of order one
};

/// What a solution is worth.
struct ProgrammeResult {
  ProgrammeEnd end = ProgrammeEnd::kInfeasible;
  int iterations = 0;
  double cost = 0.0;
  double gradient = 0.0;         ///< largest entry of what is left of the stationarity
  double violation = 0.0;        ///< of a bound
  double complementarity = 0.0;  ///< largest product of a bound's distance and multiplier
};

/// A convex quadratic programme over a horizon:
///
///     minimise   sum_k 1/2 x_k' Q_k x_k + q_k' x_k + 1/2 u_k' R_k u_k + r_k' u_k,   k = 0 .. N (no u_N)
///     subject to x_{k+1} = A_k x_k + B_k u_k + b_k,  x_0 given,  x_low <= x_k <= x_high (k > 0),  u_low <= u_k <=
///     u_high
///
/// with a cost of excess where bounds of the state are soft, by Mehrotra's predictor and corrector, each Newton step by
/// a Riccati recursion, so that the work is linear in N (Rao, Wright & Rawlings 1998, J Optim Theory Appl 99:723).
/// Bounds that are infinite cost nothing. Nothing is allocated or thrown after construction.
template <int kStates, int kInputs>
class HorizonProgramme {
 public:
  using State = Eigen::Matrix<double, kStates, 1>;
  using Input = Eigen::Matrix<double, kInputs, 1>;
  using StateMatrix = Eigen::Matrix<double, kStates, kStates>;
  using InputMatrix = Eigen::Matrix<double, kInputs, kInputs>;
  using Map = Eigen::Matrix<double, kStates, kInputs>;

  /// A step of the horizon; of the last one only Q, q and the bounds of x count.
  struct Stage {
    StateMatrix A = StateMatrix::Zero(), Q = StateMatrix::Zero();
    Map B = Map::Zero();
    InputMatrix R = InputMatrix::Identity();
    State b = State::Zero(), q = State::Zero();
    Input r = Input::Zero();
    State x_low, x_high;
    Input u_low, u_high;
    /// Of a soft bound: it gives way by this times its multiplier, so that an excess e costs e^2 / (2 give). 0: hard.
    State x_give = State::Zero();
    Stage();
  };

  /// @param stages N >= 1 steps
  explicit HorizonProgramme(std::size_t stages);

  /// N + 1 of them.
  std::vector<Stage> stages;

  /// From x0. The last solution is where it begins (`warm`): its bounds' multipliers too.
  ProgrammeResult solve(const State& x0, const ProgrammeOptions& options = {}, bool warm = false);
  /// The inputs of the last solution: N.
  [[nodiscard]] const std::vector<Input>& inputs() const { return u_; }
  /// The states of the last solution: N + 1.
  [[nodiscard]] const std::vector<State>& states() const { return x_; }
  /// The last solution one step later, for a warm start at the next sample.
  void shift();

 private:
  /// A bound below and one above of every entry: distance and multiplier.
  template <int kSize>
  struct Bounds {
    using Vector = Eigen::Matrix<double, kSize, 1>;
    Vector s, lambda, t, mu;                              // distance and multiplier, below and above
    Vector s_step, lambda_step, t_step, mu_step;          // of the Newton step
    Vector s_affine, lambda_affine, t_affine, mu_affine;  // of the predictor
    Vector give = Vector::Zero();                         // of soft bounds
    void begin(const Vector& z, const Vector& low, const Vector& high, bool warm);
    /// Adds what the bounds bring to diagonal and gradient.
    void condense(const Vector& z, const Vector& low, const Vector& high, double centre, bool corrected,
                  Vector& diagonal, Vector& gradient) const;
    void take(const Vector& step, const Vector& z, const Vector& low, const Vector& high, double centre,
              bool corrected);
    [[nodiscard]] double longest(double fraction) const;
    void advance(double length);
    void measure(double length, double& sum, double& largest, long& count) const;
    [[nodiscard]] double violation(const Vector& z, const Vector& low, const Vector& high) const;
  };

  void roll_out(const State& x0);
  bool factorise();
  void newton(double centre, bool corrected);
  [[nodiscard]] double gradient() const;
  [[nodiscard]] double cost() const;
  void complementarity(double length, double& mean, double& largest) const;

  std::vector<State> x_, dx_, gx_, dgx_;
  std::vector<Input> u_, du_, gu_, k_;
  std::vector<Eigen::Matrix<double, kInputs, kStates>> K_, G_;
  std::vector<InputMatrix> F_;  // lower triangles of Cholesky factors
  std::vector<StateMatrix> P_;
  std::vector<Bounds<kStates>> of_x_;
  std::vector<Bounds<kInputs>> of_u_;
};

extern template class HorizonProgramme<4, 1>;
extern template class HorizonProgramme<5, 1>;
extern template class HorizonProgramme<7, 1>;
extern template class HorizonProgramme<9, 2>;

}  // namespace veridyn::numerics
