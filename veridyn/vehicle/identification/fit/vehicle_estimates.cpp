#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"

#include <algorithm>
#include <cmath>
namespace veridyn::vehicle {
namespace {

using estimation::Method;
using estimation::Parameter;
using estimation::ParameterStatus;

/// Cut-off of the regressions' filter where none is given [Hz].
constexpr double kDefaultPass_Hz = 2.0;
/// Longest correlation of residuals that is looked for.
constexpr double kLongestLag_s = 2.0;
/// Of a search that only compares structures.
constexpr int kRelaxationsToCompare = 4, kStepsToCompare = 10;
constexpr double kToleranceToCompare = 0.1;
/// Of a search [sigma]: a fiftieth of what is not known anyway.
constexpr double kTolerance = 0.02;

constexpr auto row_of(DriveUnknown u) { return static_cast<Eigen::Index>(u); }

Parameter describe(std::string name, std::string unit, double value, double variance, double freedom,
                   double significance) {
  Parameter p;
  p.name = std::move(name);
  p.unit = std::move(unit);
  p.value = value;
  p.sigma = p.sigma_white = std::sqrt(std::max(0.0, variance));
  estimation::set_interval(p, std::max(1.0, freedom));
  p.status = !std::isfinite(p.sigma)    ? ParameterStatus::kNotExcited
             : p.p_value < significance ? ParameterStatus::kIdentified
                                        : ParameterStatus::kInsignificant;
  return p;
}

/// Derivatives of the understeer gradient with respect to C_f, C_r and a (at a given wheelbase); of tyres with a trail.
Eigen::Vector3d understeer_slope(const VehicleParameters<double>& p, double trail = 0.0) {
  const double L = p.wheelbase(), m = p.mass;
  return {-0.5 * m * (p.b + trail) / (L * p.C_f * p.C_f), 0.5 * m * (p.a - trail) / (L * p.C_r * p.C_r),
          -0.5 * m / L * (1.0 / p.C_f + 1.0 / p.C_r)};
}

/// Physical parameters that are hardly known are not excited, whatever their t-test says.
std::vector<Parameter> with_unexcited(std::vector<Parameter> parameters, double max_relative_sigma) {
  for (Parameter& p : parameters) {
    // At a bound that the data do not even hold it to, a search ends by chance.
    const double most = p.status == ParameterStatus::kAtBound ? 1.0 : max_relative_sigma;
    if (is_one_of(p.name, kVehicleUnknowns) && !(p.sigma <= most * std::abs(p.value)))
      p.status = ParameterStatus::kNotExcited;
  }
  return parameters;
}

/// What `[identify.uncertainty]` adds to the covariance of C_f, C_r, I_z and the understeer gradient.
Eigen::Matrix4d known_covariance(const VehicleProblem& problem, const GivenSlopes& slopes,
                                 const Eigen::Vector4d& value) {
  const VehicleIdentifyOptions& o = problem.options;
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  if (o.given.mass > 0.0) {
    Eigen::Vector4d g = value / problem.start.mass;
    g(3) = 0.0;
    P += o.given.mass * o.given.mass * g * g.transpose();
  }
  for (const auto& [slope, sigma] :
       {std::pair{&slopes.a, o.given.a}, {&slopes.b, o.given.b}, {&slopes.steer_scale, o.given.steer_scale}}) {
    const Eigen::Vector4d moved = sigma * slope->cwiseProduct(value);
    P += moved * moved.transpose();
  }
  return P;
}

Eigen::Vector4d values_of(const AxleEstimate& e) { return {e.value(0), e.value(1), e.value(2), e.understeer}; }

GivenSlopes given_slopes(const VehicleProblem& problem, const AxleEstimate& typical) {
  const GivenVehicleSigma& sigma = problem.options.given;
  const auto slope = [&](const VehicleProblem& changed, const VehicleParameters<double>& known,
                         double by) -> Eigen::Vector4d {
    const DriveRegressionResult again = regress(changed, changed.segments.identification, known);
    const AxleEstimate* other = again.find(Method::kGtls);
    if (other == nullptr || !other->usable) return Eigen::Vector4d::Zero();
    return (values_of(*other) - values_of(typical)).cwiseQuotient(values_of(typical)) / by;
  };
  const auto of_geometry = [&](double VehicleParameters<double>::*field, double by) -> Eigen::Vector4d {
    if (!(by > 0.0)) return Eigen::Vector4d::Zero();
    VehicleParameters<double> changed = problem.start;
    changed.*field += by;
    return slope(problem, changed, by);
  };
  GivenSlopes slopes{.a = of_geometry(&VehicleParameters<double>::a, sigma.a),
                     .b = of_geometry(&VehicleParameters<double>::b, sigma.b)};
  if (sigma.steer_scale > 0.0) {
    DriveSignals scaled = problem.signals;
    for (double& steer : scaled[DriveSignal::kSteer].value) steer /= 1.0 + sigma.steer_scale;
    slopes.steer_scale = slope({scaled, problem.segments, problem.start, problem.signal_options, problem.options},
                               problem.start, sigma.steer_scale);
  }
  return slopes;
}

/// Covariance of C_f, C_r, I_z, the understeer gradient and, where there is one, the steer offset; mass, a and b taken
/// as exact.
Eigen::MatrixXd axle_covariance(const VehicleProblem& problem, const AxleEstimate& axle, bool steer_bias) {
  const Eigen::Index n = steer_bias ? 5 : 4;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, n);
  if (axle.usable) {
    VehicleParameters<double> p = problem.start;
    p.C_f = axle.value(0);
    p.C_r = axle.value(1);
    p.I_z = axle.value(2);
    Eigen::Vector3d g = understeer_slope(p);
    g(2) = 0.0;
    P.topLeftCorner(3, 3) = axle.covariance;
    P.block(0, 3, 3, 1) = axle.covariance * g;
    P.block(3, 0, 1, 3) = (axle.covariance * g).transpose();
    P(3, 3) = g.dot(axle.covariance * g);
  } else {
    P.diagonal().head(3).setConstant(kInfinity);
    P(3, 3) = axle.understeer_only ? axle.understeer_sigma * axle.understeer_sigma : kInfinity;
  }
  if (steer_bias) P(4, 4) = axle.steer_bias_sigma * axle.steer_bias_sigma;
  return P;
}

VehicleEstimate estimate_of(const VehicleProblem& problem, const AxleEstimate& axle, const GivenSlopes& slopes,
                            bool steer_bias) {
  VehicleEstimate e;
  e.method = vehicle_method(axle.method);
  e.message = axle.message;
  e.usable = axle.usable;
  e.covariance = axle_covariance(problem, axle, steer_bias);
  if (axle.usable) {
    e.given_covariance = Eigen::MatrixXd::Zero(e.covariance.rows(), e.covariance.cols());
    e.given_covariance.topLeftCorner(4, 4) = known_covariance(problem, slopes, values_of(axle));
    e.covariance += e.given_covariance;
  }
  e.degrees_of_freedom = std::max(1.0, axle.degrees_of_freedom);
  const auto add = [&](const char* name, const char* unit, double v) {
    const auto i = static_cast<Eigen::Index>(e.parameters.size());
    e.parameters.push_back(
        describe(name, unit, v, e.covariance(i, i), axle.degrees_of_freedom, problem.options.significance));
  };
  add("C_f", "N/rad", axle.usable ? axle.value(0) : problem.start.C_f);
  add("C_r", "N/rad", axle.usable ? axle.value(1) : problem.start.C_r);
  add("I_z", "kg m^2", axle.usable ? axle.value(2) : problem.start.I_z);
  add("understeer_gradient", "rad s^2/m", axle.understeer);
  if (steer_bias) add("steer_offset", "rad", axle.steer_bias);
  e.parameters = with_unexcited(std::move(e.parameters), problem.options.max_relative_sigma);
  // Without the lateral velocity all three come out of the same coefficients: what noise does to one of them (it
  // pulls p and q towards zero) it does to all.
  const auto unexcited = [](const Parameter& p) { return p.status == ParameterStatus::kNotExcited; };
  if (std::any_of(e.parameters.begin(), e.parameters.begin() + 3, unexcited)) {
    for (std::size_t i = 0; i < 3; ++i) e.parameters[i].status = ParameterStatus::kNotExcited;
  }
  return e;
}

/// Where output error begins: the equation error that is known well enough, else the start.
VehicleParameters<double> begin_of_search(const VehicleProblem& problem, const EquationErrorEstimates* equation_error) {
  VehicleParameters<double> begin = problem.start;
  if (equation_error == nullptr) return begin;
  const DriveRegressionResult& regression = equation_error->regression;
  for (const Method method : {regression.recommended, Method::kGtls, Method::kOls}) {
    const AxleEstimate* e = regression.find(method);
    if (e == nullptr || !e->usable) continue;
    const Eigen::Vector3d sigma = e->covariance.diagonal().cwiseSqrt();
    if (!(sigma.cwiseQuotient(e->value).array() < problem.options.max_relative_sigma).all()) continue;
    begin.C_f = e->value(0);
    begin.C_r = e->value(1);
    begin.I_z = e->value(2);
    break;
  }
  return begin;
}

/// The free unknowns in their order, with the understeer gradient after those of the vehicle.
struct Places {
  std::vector<Eigen::Index> unknown;  // of each free one
  Eigen::Index understeer = 0;        // row of the understeer gradient
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(unknown.size()) + 1; }
  /// Row i's unknown; not for the understeer gradient's row.
  [[nodiscard]] Eigen::Index at(Eigen::Index row) const { return unknown[row < understeer ? row : row - 1]; }
};

Places places_of(const DriveModelOptions& options) {
  Places places;
  for (std::size_t i = 0; i < kDriveUnknowns; ++i) {
    if (options.free[i]) places.unknown.push_back(static_cast<Eigen::Index>(i));
  }
  places.understeer = std::count_if(places.unknown.begin(), places.unknown.end(),
                                    [](Eigen::Index i) { return i < row_of(DriveUnknown::kSteerBias); });
  return places;
}

/// The understeer gradient of the identified model, and its derivatives by all unknowns: trail moves the side forces
/// back, roll steer is slip that needs no steering.
struct IdentifiedUndersteer {
  double value = 0.0;
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(kDriveUnknowns);
};
IdentifiedUndersteer identified_understeer(const VehicleParameters<double>& p, const Eigen::VectorXd& theta,
                                           bool rolls) {
  const auto unknown = [&](DriveUnknown u) { return theta(row_of(u)); };
  const double trail = unknown(DriveUnknown::kTrail);
  const Eigen::Vector3d slope = understeer_slope(p, trail);
  // A trail is a centre of gravity as much further back.
  IdentifiedUndersteer out{.value = understeer_gradient(p) - slope(2) * trail};
  out.slope(row_of(DriveUnknown::kCf)) = slope(0);
  out.slope(row_of(DriveUnknown::kCr)) = slope(1);
  out.slope(row_of(DriveUnknown::kA)) = slope(2);
  out.slope(row_of(DriveUnknown::kTrail)) = -slope(2);
  if (!rolls) return out;
  const double steer = unknown(DriveUnknown::kRollSteerF) - unknown(DriveUnknown::kRollSteerR);
  const double gradient = unknown(DriveUnknown::kRollGradient);
  out.value -= steer * gradient;
  out.slope(row_of(DriveUnknown::kRollSteerF)) = -gradient;
  out.slope(row_of(DriveUnknown::kRollSteerR)) = gradient;
  out.slope(row_of(DriveUnknown::kRollGradient)) = -steer;
  return out;
}

/// Covariance of the rows of `places`, mass, a and b taken as exact.
Eigen::MatrixXd output_error_covariance(const estimation::OutputErrorEstimate& result,
                                        const IdentifiedUndersteer& gradient, const Places& places) {
  const Eigen::Index n = places.rows(), understeer = places.understeer;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, kDriveUnknowns);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i == understeer) {
      J.row(i) = gradient.slope.transpose();
    } else {
      J(i, places.at(i)) = 1.0;
    }
  }
  const Eigen::MatrixXd total = result.total_covariance();
  const Eigen::MatrixXd finite = total.unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
  Eigen::MatrixXd P = J * finite * J.transpose();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      if (J(i, j) != 0.0 && !std::isfinite(total(j, j))) P(i, i) = kInfinity;
    }
  }
  return P;
}

/// What the uncertainty of mass, a and b adds to the rows of `places`; the steering's scale is fitted again for.
Eigen::MatrixXd given_covariance(const VehicleProblem& problem, const GivenSlopes& slopes,
                                 const estimation::OutputErrorEstimate& result, const VehicleParameters<double>& p,
                                 const Places& places) {
  const Eigen::Index understeer = places.understeer;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(places.rows(), places.rows());
  const Eigen::Matrix4d extra =
      known_covariance(problem, slopes, {result.theta(0), result.theta(1), result.theta(2), understeer_gradient(p)});
  // Rows of C_f, C_r, I_z (where free) and the understeer gradient.
  std::array<Eigen::Index, 4> row{-1, -1, -1, understeer};
  for (std::size_t i = 0; i < places.unknown.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (places.unknown[i] < 3) row[places.unknown[i]] = at < understeer ? at : at + 1;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      if (row[i] >= 0 && row[j] >= 0) P(row[i], row[j]) += extra(i, j);
    }
  }
  return P;
}

VehicleEstimate estimate_of(const VehicleProblem& problem, const GivenSlopes& slopes,
                            const estimation::OutputErrorEstimate& result) {
  VehicleEstimate e;
  e.method = VehicleMethod::kOutputError;
  e.usable = result.has_estimate();
  e.message = result.message;
  if (!e.usable) return e;
  e.degrees_of_freedom = std::max(1.0, result.degrees_of_freedom);
  const VehicleIdentifyOptions& o = problem.options;
  const Places places = places_of(o.model);
  VehicleParameters<double> p = problem.start;
  p.C_f = result.theta(0);
  p.C_r = result.theta(1);
  p.I_z = result.theta(2);
  p.a = result.theta(3);
  p.b = problem.start.wheelbase() - p.a;
  e.given_covariance = given_covariance(problem, slopes, result, p, places);
  const IdentifiedUndersteer understeer = identified_understeer(p, result.theta, has_roll(o.model.structure));
  e.covariance = output_error_covariance(result, understeer, places) + e.given_covariance;
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    if (i == places.understeer) {
      e.parameters.push_back(describe("understeer_gradient", "rad s^2/m", understeer.value, e.covariance(i, i),
                                      result.degrees_of_freedom, o.significance));
      continue;
    }
    const Parameter& given = result.parameters[places.at(i)];
    Parameter made =
        describe(given.name, given.unit, given.value, e.covariance(i, i), result.degrees_of_freedom, o.significance);
    made.sigma_white = given.sigma_white;
    made.variance_inflation = given.variance_inflation;
    made.unexcited_share = given.unexcited_share;
    if (given.status == ParameterStatus::kNotExcited || given.status == ParameterStatus::kAtBound)
      made.status = given.status;
    e.parameters.push_back(std::move(made));
  }
  e.parameters = with_unexcited(std::move(e.parameters), o.max_relative_sigma);
  return e;
}

/// How the parameters move with one standard deviation of the steering's scale, by fitting the drive with it; nothing
/// where that fit does not end.
Eigen::VectorXd moved_by_steer_scale(const VehicleProblem& problem, const estimation::OutputErrorEstimate& here,
                                     Progress& progress) {
  DriveModelOptions model = problem.options.model;
  model.start[DriveUnknown::kSteerScale] = problem.options.given.steer_scale;
  const std::optional<estimation::OutputErrorEstimate> there =
      fitted_again(problem, problem.segments.identification, model, here, kLongestLag_s, progress);
  if (!there) return {};
  const VehicleEstimate from = estimate_of(problem, GivenSlopes{}, here),
                        to = estimate_of(problem, GivenSlopes{}, *there);
  Eigen::VectorXd moved(signed_index(from.parameters.size()));
  for (Eigen::Index i = 0; i < moved.size(); ++i) moved(i) = to.parameters[i].value - from.parameters[i].value;
  return moved;
}

/// Widens an estimate by what is not known of the steering's scale.
VehicleEstimate with_steer_scale(VehicleEstimate estimate, Eigen::VectorXd moved, double significance) {
  const Eigen::MatrixXd added = moved * moved.transpose();
  Eigen::MatrixXd grown = estimate.covariance + added;
  estimate.given_covariance += added;
  estimate.by_steer_scale = std::move(moved);
  return with_covariance(std::move(estimate), std::move(grown), significance);
}

}  // namespace

DriveRegressionResult regress(const VehicleProblem& problem, std::span<const TimeSpan> spans,
                              const VehicleParameters<double>& known) {
  estimation::RegressionOptions options;
  options.significance = problem.options.significance;
  options.signal_to_noise = problem.options.signal_to_noise;
  const double pass_Hz = problem.signal_options.pass_Hz > 0.0
                             ? problem.signal_options.pass_Hz
                             : std::min(kDefaultPass_Hz, 0.1 * problem.signals.grid.rate_Hz());
  return equation_error(drive_regressions(problem.signals, spans, known, pass_Hz), known, options);
}

EquationErrorEstimates estimate_by_equation_error(const VehicleProblem& problem) {
  EquationErrorEstimates out;
  out.regression = regress(problem, problem.segments.identification, problem.start);
  const AxleEstimate* typical = out.regression.find(Method::kGtls);
  if (typical != nullptr && typical->usable) out.slopes = given_slopes(problem, *typical);
  for (const AxleEstimate& axle : out.regression.axles)
    out.estimates.push_back(estimate_of(problem, axle, out.slopes, !out.regression.data.direct));
  return out;
}

OutputErrorProblem output_error_problem(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                                        double search_factor) {
  DriveModelOptions model_options = problem.options.model;
  model_options.gravity = problem.signal_options.gravity;
  model_options.search_factor = search_factor;
  estimation::OutputErrorOptions options;
  options.significance = problem.options.significance;
  // What is not determined by then crawls along a valley: more relaxations would not help it.
  options.max_relaxations = 12;
  options.tolerance = kTolerance;
  options.model_error = true;
  options.max_lag =
      std::max<Eigen::Index>(20, static_cast<Eigen::Index>(kLongestLag_s * problem.signals.grid.rate_Hz()));
  return {DriveParametricModel(problem.signals, problem.segments.identification,
                               begin_of_search(problem, equation_error), model_options),
          options};
}

void OutputErrorProblem::begin_at(const Eigen::VectorXd& theta) {
  options.search_start = within_bounds(model, theta);
  options.input_noise = model.steering_noise(options.search_start);
}

OutputErrorResult estimate_by_output_error(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                                           const Eigen::VectorXd& search_start, SearchEffort effort,
                                           Progress& progress) {
  OutputErrorProblem given = output_error_problem(problem, equation_error);
  if (effort == SearchEffort::kToCompare) {
    given.options.max_relaxations = kRelaxationsToCompare;
    given.options.max_steps = kStepsToCompare;
    given.options.tolerance = kToleranceToCompare;
  }
  Eigen::VectorXd start = search_start;
  if (start.size() == 0) {
    start.resize(kDriveUnknowns);
    for (Eigen::Index i = 0; i < start.size(); ++i) start(i) = given.model.parameters()[i].start;
  }
  given.begin_at(start);
  OutputErrorResult out;
  out.raw = estimation::output_error(given.model, given.model.measured(), given.options, progress);
  GivenSlopes slopes = equation_error != nullptr ? equation_error->slopes : GivenSlopes{};
  const GivenVehicleSigma& sigma = problem.options.given;
  const bool scaled = effort == SearchEffort::kToTheEnd && sigma.steer_scale > 0.0 && out.raw.usable() &&
                      !problem.options.model.free[DriveUnknown::kSteerScale];
  const Eigen::VectorXd moved = scaled ? moved_by_steer_scale(problem, out.raw, progress) : Eigen::VectorXd();
  // Where that fit does not end, as the regression moves.
  if (!scaled || moved.size() > 0) slopes.steer_scale.setZero();
  out.estimate = estimate_of(problem, slopes, out.raw);
  if (moved.size() > 0) out.estimate = with_steer_scale(std::move(out.estimate), moved, problem.options.significance);
  return out;
}

std::optional<estimation::OutputErrorEstimate> fitted_again(const VehicleProblem& problem,
                                                            std::span<const TimeSpan> spans,
                                                            const DriveModelOptions& model_options,
                                                            const estimation::OutputErrorEstimate& here,
                                                            double longest_memory_s, Progress& progress) {
  VehicleParameters<double> start = problem.start;
  start.C_f = here.theta(0);
  start.C_r = here.theta(1);
  start.I_z = here.theta(2);
  DriveModelOptions with_gravity = model_options;
  with_gravity.gravity = problem.signal_options.gravity;
  OutputErrorProblem again{DriveParametricModel(problem.signals, spans, start, with_gravity), {}};
  again.begin_at(here.theta);
  estimation::OutputErrorOptions& options = again.options;
  options.significance = problem.options.significance;
  options.noise_start = here.noise_covariance.diagonal().cwiseSqrt();
  options.model_error = true;
  // After the first one knows how much its samples count for, as the other part does.
  options.max_relaxations = 2;
  options.max_steps = 3;
  options.max_lag =
      std::max<Eigen::Index>(20, static_cast<Eigen::Index>(longest_memory_s * problem.signals.grid.rate_Hz()));
  estimation::OutputErrorEstimate there =
      estimation::output_error(again.model, again.model.measured(), options, progress);
  if (there.termination != estimation::OutputErrorTermination::kConverged &&
      there.termination != estimation::OutputErrorTermination::kRelaxations)
    return std::nullopt;
  return there;
}

Eigen::VectorXd within_bounds(const DriveParametricModel& model, Eigen::VectorXd theta) {
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const estimation::ModelParameter& p = model.parameters()[i];
    theta(i) = p.fixed ? p.start : std::clamp(theta(i), p.low, p.high);
  }
  return theta;
}

VehicleEstimate unexcited_estimate(const VehicleProblem& problem, std::string reason) {
  VehicleEstimate e;
  e.message = std::move(reason);
  const VehicleParameters<double>& p = problem.start;
  for (const auto& [name, unit, value] :
       {std::tuple{"C_f", "N/rad", p.C_f}, std::tuple{"C_r", "N/rad", p.C_r}, std::tuple{"I_z", "kg m^2", p.I_z},
        std::tuple{"understeer_gradient", "rad s^2/m", understeer_gradient(p)}})
    e.parameters.push_back(describe(name, unit, value, kInfinity, 1.0, problem.options.significance));
  e.covariance = Eigen::MatrixXd::Zero(4, 4);
  e.covariance.diagonal().setConstant(kInfinity);
  return e;
}

VehicleMethod choose_method(std::span<const VehicleEstimate> estimates, const DriveRegressionResult* regression,
                            std::optional<VehicleMethod> desired) {
  const auto usable = [&](VehicleMethod method) {
    const VehicleEstimate* e = find_estimate(estimates, method);
    return e != nullptr && e->usable;
  };
  if (desired) return usable(*desired) ? *desired : VehicleMethod::kNone;
  if (usable(VehicleMethod::kOutputError)) return VehicleMethod::kOutputError;
  if (regression == nullptr) return VehicleMethod::kNone;
  std::vector<Method> order{Method::kGtls, Method::kPcaGtls, Method::kOls};
  if (regression->recommends) order.insert(order.begin(), regression->recommended);
  for (const Method m : order) {
    if (usable(vehicle_method(m))) return vehicle_method(m);
  }
  // Steady cornering: the understeer gradient alone.
  const AxleEstimate* pca = regression->find(Method::kPcaGtls);
  const bool understeer = pca != nullptr && pca->understeer_only && std::isfinite(pca->understeer_sigma);
  return understeer ? VehicleMethod::kPcaGtls : VehicleMethod::kNone;
}

}  // namespace veridyn::vehicle
