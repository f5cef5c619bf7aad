#include "veridyn/cueing/score/least_error.hpp"

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/cueing/perception/felt_pair.hpp"
#include "veridyn/cueing/washout/shared_channels.hpp"
#include "veridyn/numerics/linear_systems/discretisation.hpp"
#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;

constexpr double kStep = 0.02;  // [s]
/// Cost of accelerations over their limits: so small that it only settles what nothing else does.
constexpr double kEffort = 1e-6;
constexpr int kIterations = 80;
constexpr double kTolerance = 1e-4;  // of the cost

/// Force and rate of the pair on an even grid, on lines between samples.
std::vector<Eigen::Vector2d> on_grid(const std::vector<MotionSample>& vehicle, Eigen::Index pair) {
  const auto points = static_cast<std::size_t>((vehicle.back().time - vehicle.front().time) / kStep) + 1;
  std::vector<Eigen::Vector2d> grid(points);
  const auto of = [&](const MotionSample& s) { return Eigen::Vector2d(tilted_force(s.force)(pair), s.rate(pair)); };
  std::size_t i = 0;
  for (std::size_t k = 0; k < points; ++k) {
    const double t = vehicle.front().time + kStep * static_cast<double>(k);
    while (i + 2 < vehicle.size() && vehicle[i + 1].time <= t) ++i;
    const double part = (t - vehicle[i].time) / (vehicle[i + 1].time - vehicle[i].time);
    grid[k] = of(vehicle[i]) + part * (of(vehicle[i + 1]) - of(vehicle[i]));
  }
  return grid;
}

template <int kStates, int kInputs>
std::optional<LeastError> solved(const std::vector<Eigen::Vector2d>& drive, const numerics::StateSpace& model,
                                 const Platform& platform, Eigen::Index pair) {
  using Programme = numerics::HorizonProgramme<kStates, kInputs>;
  using State = typename Programme::State;
  constexpr bool shifts = kInputs == 2;
  const std::size_t steps = drive.size() - 1;
  const numerics::HeldSystem held = numerics::held(model, kStep, numerics::Hold::kFirstOrder);
  const auto outside = [&](const Eigen::MatrixXd& of, const Eigen::Vector2d& w) {
    return State(of.middleCols(FeltPair::kForce, 2) * w);
  };
  const double share = 1.0 / static_cast<double>(steps);
  typename Programme::Stage stage;
  stage.A = held.Phi;
  stage.B = held.Gamma.leftCols(kInputs);
  stage.Q = 2.0 * share * model.C.transpose() * model.C;
  const auto limit = [&](Eigen::Index state, Eigen::Index input, const AxisLimits& l, bool mirrored) {
    stage.x_low(state) = mirrored ? -l.highest : l.lowest;
    stage.x_high(state) = mirrored ? -l.lowest : l.highest;
    stage.x_low(state + 1) = -l.rate;
    stage.x_high(state + 1) = l.rate;
    stage.u_low(input) = -l.acceleration;
    stage.u_high(input) = l.acceleration;
    stage.R(input, input) = 2.0 * share * kEffort / (l.acceleration * l.acceleration);
  };
  stage.R.setZero();
  limit(FeltPair::kAngle, 0, platform.limits[tilt_axis(pair)], false);
  if constexpr (shifts) limit(FeltPair::kShift, 1, platform.limits[shift_axis(pair)], pair == 0);
  Programme programme(steps);
  std::fill(programme.stages.begin(), programme.stages.end(), stage);
  for (std::size_t k = 0; k < steps; ++k)
    programme.stages[k].b = outside(held.Gamma, drive[k]) + outside(held.Slope, drive[k + 1] - drive[k]);

  // Driver and rider begin at rest with what is there.
  constexpr Eigen::Index kFelt = FeltPair::kFeltStates;
  State x0 = State::Zero();
  x0.template head<kFelt>() =
      -Eigen::Matrix<double, kFelt, kFelt>(model.A.topLeftCorner(kFelt, kFelt))
           .partialPivLu()
           .solve(Eigen::Matrix<double, kFelt, 1>(outside(model.B, drive.front()).template head<kFelt>()));

  LeastError least;
  State still = x0;
  for (const typename Programme::Stage& s : programme.stages) {
    least.still += 0.5 * still.dot(s.Q * still);
    still = s.A * still + s.b;
  }
  const numerics::ProgrammeResult r =
      programme.solve(x0, {.iterations = kIterations, .tolerance = 1e-2 * kTolerance * share});
  const double bounds = 2.0 * static_cast<double>(steps) * (shifts ? 6.0 : 3.0);
  // Of a convex programme no more can be left than distances times multipliers and slopes times ranges.
  const double ranges = static_cast<double>(steps) * (stage.u_high - stage.u_low).sum();
  least.residual = (r.complementarity * bounds + r.gradient * ranges) / std::max(r.cost, 1e-12);
  if (r.end == numerics::ProgrammeEnd::kInfeasible || !(least.residual <= 100.0 * kTolerance)) return std::nullopt;
  least.iterations = r.iterations;
  for (std::size_t k = 0; k <= steps; ++k) {
    const State& x = programme.states()[k];
    least.error += 0.5 * x.dot(stage.Q * x);
    least.time.push_back(kStep * static_cast<double>(k));
    least.angle.push_back(x(FeltPair::kAngle));
    if constexpr (shifts) least.shift.push_back((pair == 0 ? -1.0 : 1.0) * x(FeltPair::kShift));
  }
  least.error = std::sqrt(least.error);
  least.still = std::sqrt(least.still);
  return least;
}

}  // namespace

std::optional<LeastError> least_error(const std::vector<MotionSample>& vehicle, const Platform& platform,
                                      const VestibularModel& model, const MotionThresholds& thresholds,
                                      Eigen::Index pair) {
  if (!platform.limits[tilt_axis(pair)].moves())
    throw InputError("platform", pair == 0 ? "does not roll" : "does not pitch");
  if (vehicle.size() < 2 || vehicle.back().time - vehicle.front().time > kLongestForLeastError) return std::nullopt;
  const std::vector<Eigen::Vector2d> drive = on_grid(vehicle, pair);
  if (drive.size() < 2) return std::nullopt;
  const bool shifts = platform.limits[shift_axis(pair)].moves();
  const numerics::StateSpace felt = felt_pair(model, thresholds, pair, shifts, -platform.rider.z()).system;
  return shifts ? solved<9, 2>(drive, felt, platform, pair) : solved<7, 1>(drive, felt, platform, pair);
}

}  // namespace veridyn::cueing
