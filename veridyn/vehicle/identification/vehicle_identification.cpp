#include "veridyn/vehicle/identification/vehicle_identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::HonestyCheck;
using estimation::Method;
using estimation::ParameterEstimate;
using estimation::ParameterStatus;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Factor within which the noise of the sensors is known.
constexpr double kNoiseDoubt = 2.0;
/// Correlation of neighbouring residuals from which they are called coloured.
constexpr double kColoured = 0.3;
/// Residual over what noise leaves, from which colour is more than that of the inputs' noise.
constexpr double kBeyondNoise = 1.5;
/// Cut-off of the regressions' filter where none is given [Hz].
constexpr double kDefaultPass_Hz = 2.0;
/// Relative difference between the methods that small angles may make.
constexpr double kSmallAngles = 0.01;
/// Longest correlation of residuals that is looked for.
constexpr double kLongestLag_s = 2.0;

constexpr auto index_of(DriveUnknown u) { return static_cast<std::size_t>(u); }
constexpr auto row_of(DriveUnknown u) { return static_cast<Eigen::Index>(u); }

ParameterEstimate describe(std::string name, std::string unit, double value, double variance, double freedom,
                           double significance) {
  ParameterEstimate p;
  p.name = std::move(name);
  p.unit = std::move(unit);
  p.value = value;
  p.sigma = p.sigma_white = std::sqrt(std::max(0.0, variance));
  const bool known = std::isfinite(p.sigma);
  const double dof = std::max(1.0, freedom);
  const double quantile = numerics::student_t_quantile(0.975, dof);
  p.low95 = known ? value - quantile * p.sigma : -kInfinity;
  p.high95 = known ? value + quantile * p.sigma : kInfinity;
  if (!known) {
    p.status = ParameterStatus::kNotExcited;
    return p;
  }
  p.t = p.sigma > 0.0 ? value / p.sigma : std::copysign(kInfinity, value);
  p.p_value = numerics::student_t_two_sided_p(p.t, dof);
  p.status = p.p_value < significance ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
  return p;
}

/// Derivatives of the understeer gradient with respect to C_f, C_r and a (at a given wheelbase).
Eigen::Vector3d understeer_slope(const VehicleParameters<double>& p) {
  const double L = p.wheelbase(), m = p.mass;
  return {-0.5 * m * p.b / (L * p.C_f * p.C_f), 0.5 * m * p.a / (L * p.C_r * p.C_r),
          -0.5 * m / L * (1.0 / p.C_f + 1.0 / p.C_r)};
}

class Identification {
 public:
  Identification(const DriveSignals& signals, const DriveSegments& segments, const VehicleParameters<double>& start,
                 const DriveSignalOptions& signal_options, const VehicleIdentifyOptions& options, Progress& progress)
      : s_(signals),
        segments_(segments),
        start_(start),
        signal_options_(signal_options),
        o_(options),
        progress_(progress) {}

  VehicleIdentification run() {
    out_.identified = start_;
    if (segments_.identification.empty()) {
      not_excited(fmt::format("there is nothing to identify from: {}", segments_.text));
      return std::move(out_);
    }
    if (o_.equation_error && s_[DriveSignal::kAccelY].available()) {
      progress_.stage("equation error");
      by_equation_error();
    }
    if (o_.output_error && !progress_.interrupted()) {
      progress_.stage("output error");
      by_output_error();
    }
    out_.interrupted = progress_.interrupted();
    if (out_.interrupted) return std::move(out_);
    choose();
    if (out_.chosen.empty()) {
      out_.verdict = VehicleVerdict::kRejected;
      out_.reason = "no method gave an estimate";
      for (const VehicleEstimate& e : out_.estimates) out_.reason += fmt::format("; {}: {}", e.method, e.message);
      if (out_.regression && out_.regression->axles.empty()) out_.reason += "; " + out_.regression->reason;
      return std::move(out_);
    }
    predict();
    judge();
    return std::move(out_);
  }

 private:
  void not_excited(std::string reason) {
    out_.verdict = VehicleVerdict::kNotExcited;
    out_.reason = std::move(reason);
    VehicleEstimate e;
    e.method = "none";
    e.message = out_.reason;
    const VehicleParameters<double>& p = start_;
    for (const auto& [name, unit, value] :
         {std::tuple{"C_f", "N/rad", p.C_f}, std::tuple{"C_r", "N/rad", p.C_r}, std::tuple{"I_z", "kg m^2", p.I_z},
          std::tuple{"understeer_gradient", "rad s^2/m", understeer_gradient(p)}})
      e.parameters.push_back(describe(name, unit, value, kInfinity, 1.0, o_.significance));
    e.covariance = Eigen::MatrixXd::Zero(4, 4);
    e.covariance.diagonal().setConstant(kInfinity);
    out_.estimates.push_back(std::move(e));
    out_.chosen = "none";
  }

  [[nodiscard]] double pass_Hz() const {
    return signal_options_.pass_Hz > 0.0 ? signal_options_.pass_Hz : std::min(kDefaultPass_Hz, 0.1 * s_.grid.rate_Hz());
  }
  [[nodiscard]] estimation::RegressionOptions regression_options() const {
    estimation::RegressionOptions options;
    options.significance = o_.significance;
    options.signal_to_noise = o_.signal_to_noise;
    return options;
  }

  DriveRegressionResult regress(std::span<const TimeSpan> spans, const VehicleParameters<double>& known) const {
    return equation_error(drive_regressions(s_, spans, known, pass_Hz()), known, regression_options());
  }

  /// What the uncertainty of mass, a and b adds to the covariance of C_f, C_r, I_z and K.
  Eigen::Matrix4d known_covariance(const Eigen::Vector4d& value) const {
    Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
    if (o_.mass_sigma > 0.0) {
      Eigen::Vector4d g = value / start_.mass;
      g(3) = 0.0;
      P += o_.mass_sigma * o_.mass_sigma * g * g.transpose();
    }
    for (const bool front : {true, false}) {
      const Eigen::Vector4d& g = front ? a_slope_ : b_slope_;
      const double sigma = front ? o_.a_sigma : o_.b_sigma;
      const Eigen::Vector4d scaled = g.cwiseProduct(value);
      P += sigma * sigma * scaled * scaled.transpose();
    }
    return P;
  }

  static Eigen::Vector4d values_of(const AxleEstimate& e) { return {e.value(0), e.value(1), e.value(2), e.understeer}; }

  void by_equation_error() {
    out_.regression = regress(segments_.identification, start_);
    DriveRegressionResult& result = *out_.regression;
    const AxleEstimate* typical = result.find(Method::kGtls);
    if (typical != nullptr && typical->usable) {
      // Relative change of the result per metre of a and b.
      const auto slope = [&](double VehicleParameters<double>::*field, double sigma) -> Eigen::Vector4d {
        if (!(sigma > 0.0)) return Eigen::Vector4d::Zero();
        VehicleParameters<double> changed = start_;
        changed.*field += sigma;
        const DriveRegressionResult again = regress(segments_.identification, changed);
        const AxleEstimate* other = again.find(Method::kGtls);
        if (other == nullptr || !other->usable) return Eigen::Vector4d::Zero();
        return (values_of(*other) - values_of(*typical)).cwiseQuotient(values_of(*typical)) / sigma;
      };
      a_slope_ = slope(&VehicleParameters<double>::a, o_.a_sigma);
      b_slope_ = slope(&VehicleParameters<double>::b, o_.b_sigma);
    }
    for (const AxleEstimate& axle : result.axles) {
      VehicleEstimate e;
      e.method = std::string(estimation::to_string(axle.method));
      e.message = axle.message;
      const bool steer_bias = !result.data.direct;
      const Eigen::Index n = steer_bias ? 5 : 4;
      e.covariance = Eigen::MatrixXd::Zero(n, n);
      const Eigen::Vector4d value = values_of(axle);
      if (axle.usable) {
        e.usable = true;
        e.covariance.topLeftCorner(3, 3) = axle.covariance;
        VehicleParameters<double> p = start_;
        p.C_f = axle.value(0);
        p.C_r = axle.value(1);
        p.I_z = axle.value(2);
        Eigen::Vector3d g = understeer_slope(p);
        g(2) = 0.0;
        e.covariance.block(0, 3, 3, 1) = axle.covariance * g;
        e.covariance.block(3, 0, 1, 3) = (axle.covariance * g).transpose();
        e.covariance(3, 3) = g.dot(axle.covariance * g);
        e.covariance.topLeftCorner(4, 4) += known_covariance(value);
      } else {
        e.covariance.diagonal().head(3).setConstant(kInfinity);
        e.covariance(3, 3) = axle.understeer_only ? axle.understeer_sigma * axle.understeer_sigma : kInfinity;
      }
      if (steer_bias) e.covariance(4, 4) = axle.steer_bias_sigma * axle.steer_bias_sigma;
      const double dof = axle.degrees_of_freedom;
      const auto add = [&](const char* name, const char* unit, double v) {
        const auto i = static_cast<Eigen::Index>(e.parameters.size());
        e.parameters.push_back(describe(name, unit, v, e.covariance(i, i), dof, o_.significance));
      };
      add("C_f", "N/rad", axle.usable ? value(0) : start_.C_f);
      add("C_r", "N/rad", axle.usable ? value(1) : start_.C_r);
      add("I_z", "kg m^2", axle.usable ? value(2) : start_.I_z);
      add("understeer_gradient", "rad s^2/m", axle.understeer);
      if (steer_bias) add("steer_offset", "rad", axle.steer_bias);
      mark(e);
      // Without the lateral velocity all three come out of the same coefficients: what noise does to one of them (it
      // pulls p and q towards zero) it does to all.
      const auto lost = [](const ParameterEstimate& p) { return p.status == ParameterStatus::kNotExcited; };
      if (std::any_of(e.parameters.begin(), e.parameters.begin() + 3, lost)) {
        for (std::size_t i = 0; i < 3; ++i) e.parameters[i].status = ParameterStatus::kNotExcited;
      }
      out_.estimates.push_back(std::move(e));
    }
  }

  /// Physical parameters that are hardly known are not excited, whatever their t-test says.
  void mark(VehicleEstimate& e) const {
    for (ParameterEstimate& p : e.parameters) {
      const bool physical = p.name == "C_f" || p.name == "C_r" || p.name == "I_z" || p.name == "mu";
      if (physical && !(p.sigma <= o_.max_relative_sigma * std::abs(p.value))) p.status = ParameterStatus::kNotExcited;
    }
  }

  void by_output_error() {
    VehicleParameters<double> begin = start_;
    if (out_.regression) {
      for (const Method method : {out_.regression->recommended, Method::kGtls, Method::kOls}) {
        const AxleEstimate* e = out_.regression->find(method);
        if (e == nullptr || !e->usable) continue;
        const Eigen::Vector3d sigma = e->covariance.diagonal().cwiseSqrt();
        if (!(sigma.cwiseQuotient(e->value).maxCoeff() < o_.max_relative_sigma)) continue;
        begin.C_f = e->value(0);
        begin.C_r = e->value(1);
        begin.I_z = e->value(2);
        break;
      }
    }
    DriveModelOptions model_options = o_.model;
    model_options.gravity = signal_options_.gravity;
    const DriveParametricModel model(s_, segments_.identification, begin, model_options);
    estimation::OutputErrorOptions oe;
    oe.significance = o_.significance;
    // What is not determined by then crawls along a valley: more relaxations would not help it.
    oe.max_relaxations = 12;
    oe.max_lag = std::max<Eigen::Index>(20, static_cast<Eigen::Index>(kLongestLag_s * s_.grid.rate_Hz()));
    out_.output_error = estimation::output_error(model, model.measured(), oe, progress_);
    const estimation::OutputErrorEstimate& result = *out_.output_error;
    VehicleEstimate e;
    e.method = "output error";
    e.usable = result.usable();
    e.message = result.message;
    if (!e.usable) {
      out_.estimates.push_back(std::move(e));
      return;
    }
    // Free unknowns in their order, and the understeer gradient behind the vehicle's own.
    std::vector<Eigen::Index> which;
    for (std::size_t i = 0; i < kDriveUnknowns; ++i) {
      if (model_options.free[i]) which.push_back(static_cast<Eigen::Index>(i));
    }
    const auto own = static_cast<Eigen::Index>(
        std::count_if(which.begin(), which.end(), [](Eigen::Index i) { return i < row_of(DriveUnknown::kSteerBias); }));
    const auto n = static_cast<Eigen::Index>(which.size()) + 1;
    VehicleParameters<double> p = start_;
    p.C_f = result.theta(0);
    p.C_r = result.theta(1);
    p.I_z = result.theta(2);
    p.a = result.theta(3);
    p.b = start_.wheelbase() - p.a;
    const Eigen::Vector3d g = understeer_slope(p);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(kDriveUnknowns));
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == own) {
        J(i, 0) = g(0);
        J(i, 1) = g(1);
        J(i, 3) = g(2);
      } else {
        J(i, which[static_cast<std::size_t>(i < own ? i : i - 1)]) = 1.0;
      }
    }
    const Eigen::MatrixXd finite = result.covariance.unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
    e.covariance = J * finite * J.transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < J.cols(); ++j) {
        if (J(i, j) != 0.0 && !std::isfinite(result.covariance(j, j))) e.covariance(i, i) = kInfinity;
      }
    }
    const Eigen::Matrix4d extra =
        known_covariance({result.theta(0), result.theta(1), result.theta(2), understeer_gradient(p)});
    std::vector<Eigen::Index> place(4, -1);
    for (std::size_t i = 0; i < which.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (which[i] < 3) place[static_cast<std::size_t>(which[i])] = at < own ? at : at + 1;
    }
    place[3] = own;
    for (Eigen::Index i = 0; i < 4; ++i) {
      for (Eigen::Index j = 0; j < 4; ++j) {
        const Eigen::Index a = place[static_cast<std::size_t>(i)], b = place[static_cast<std::size_t>(j)];
        if (a >= 0 && b >= 0) e.covariance(a, b) += extra(i, j);
      }
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == own) {
        e.parameters.push_back(describe("understeer_gradient", "rad s^2/m", understeer_gradient(p), e.covariance(i, i),
                                        result.degrees_of_freedom, o_.significance));
        continue;
      }
      const auto j = static_cast<std::size_t>(which[static_cast<std::size_t>(i < own ? i : i - 1)]);
      const ParameterEstimate& given = result.parameters[j];
      ParameterEstimate made =
          describe(given.name, given.unit, given.value, e.covariance(i, i), result.degrees_of_freedom, o_.significance);
      made.sigma_white = given.sigma_white;
      made.variance_inflation = given.variance_inflation;
      made.unexcited_share = given.unexcited_share;
      if (given.status == ParameterStatus::kNotExcited) made.status = given.status;
      e.parameters.push_back(std::move(made));
    }
    mark(e);
    out_.estimates.push_back(std::move(e));
  }

  void choose() {
    const auto usable = [&](std::string_view method) {
      const VehicleEstimate* e = out_.find(method);
      return e != nullptr && e->usable;
    };
    if (o_.method != "auto") {
      if (usable(o_.method)) out_.chosen = o_.method;
      return;
    }
    if (usable("output error")) {
      out_.chosen = "output error";
      return;
    }
    if (!out_.regression) return;
    std::vector<Method> order{Method::kGtls, Method::kPcaGtls, Method::kOls};
    if (out_.regression->recommends) order.insert(order.begin(), out_.regression->recommended);
    for (const Method m : order) {
      const std::string name(estimation::to_string(m));
      if (usable(name)) {
        out_.chosen = name;
        return;
      }
    }
    // Steady cornering: the understeer gradient alone.
    const AxleEstimate* pca = out_.regression->find(Method::kPcaGtls);
    if (pca != nullptr && pca->understeer_only && std::isfinite(pca->understeer_sigma)) out_.chosen = "PCA-GTLS";
  }

  /// All unknowns of the drive model as the chosen method has them; constant biases that it does not know are fitted.
  Eigen::VectorXd full_theta(Eigen::MatrixXd& covariance) const {
    const auto n = static_cast<Eigen::Index>(kDriveUnknowns);
    if (out_.chosen == "output error") {
      covariance = out_.output_error->covariance.unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
      return out_.output_error->theta;
    }
    const VehicleEstimate& e = *out_.best();
    VehicleParameters<double> p = start_;
    p.C_f = e.find("C_f")->value;
    p.C_r = e.find("C_r")->value;
    p.I_z = e.find("I_z")->value;
    covariance = Eigen::MatrixXd::Zero(n, n);
    const Eigen::MatrixXd own = e.covariance.topLeftCorner(3, 3);
    if (own.allFinite()) covariance.topLeftCorner(3, 3) = own;
    return with_fitted_biases(s_, segments_.identification, p, o_.model);
  }

 public:
  static Eigen::VectorXd with_fitted_biases(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                            const VehicleParameters<double>& p, DriveModelOptions options) {
    options.free.fill(false);
    for (const DriveUnknown u : {DriveUnknown::kSteerBias, DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias})
      options.free[index_of(u)] = true;
    for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA})
      options.start[index_of(u)] = std::numeric_limits<double>::quiet_NaN();
    const DriveParametricModel model(signals, spans, p, options);
    const estimation::OutputErrorEstimate biases = estimation::output_error(model, model.measured());
    if (biases.usable()) return biases.theta;
    Eigen::VectorXd theta(static_cast<Eigen::Index>(kDriveUnknowns));
    for (std::size_t i = 0; i < kDriveUnknowns; ++i) theta(static_cast<Eigen::Index>(i)) = model.parameters()[i].start;
    return theta;
  }

 private:
  void predict() {
    progress_.stage("validating on the hold-out");
    Eigen::MatrixXd covariance;
    const Eigen::VectorXd theta = full_theta(covariance);
    out_.fit = predict_drive(s_, segments_.identification, start_, o_.model, theta, covariance);
    out_.validation = predict_drive(s_, segments_.holdout, start_, o_.model, theta, covariance);
    const VehicleEstimate& e = *out_.best();
    const auto take = [&](const char* name, double& to) {
      const ParameterEstimate* p = e.find(name);
      if (p != nullptr && p->status != ParameterStatus::kNotExcited) to = p->value;
    };
    take("C_f", out_.identified.C_f);
    take("C_r", out_.identified.C_r);
    take("I_z", out_.identified.I_z);
    const double L = start_.wheelbase();
    take("a", out_.identified.a);
    out_.identified.b = L - out_.identified.a;
    if (o_.model.tyre == DriveTyre::kMagicFormula) take("mu", out_.identified.mu);
  }

  /// What noise of steering and speed does to the prediction: the same noise once more, and the difference as fits.
  [[nodiscard]] DriveValidation with_noisier_inputs() const {
    DriveSignals noisier = s_;
    for (const DriveSignal which : {DriveSignal::kSteer, DriveSignal::kSpeed}) {
      GridSignal& signal = noisier[which];
      numerics::RandomStream noise(1, kDriveSignalNames[static_cast<std::size_t>(which)]);
      for (double& v : signal.value) v += signal.sigma * noise.normal();
    }
    Eigen::MatrixXd covariance;
    DriveValidation other = predict_drive(noisier, segments_.identification, start_, o_.model, full_theta(covariance));
    const auto compare = [&](const char* name, std::vector<double> PredictedDrive::*series) {
      std::vector<double> x, y;
      for (std::size_t s = 0; s < std::min(other.drives.size(), out_.fit.drives.size()); ++s) {
        const std::vector<double>&a = out_.fit.drives[s].*series, &b = other.drives[s].*series;
        if (a.size() != b.size()) continue;
        x.insert(x.end(), a.begin(), a.end());
        y.insert(y.end(), b.begin(), b.end());
      }
      for (PredictedDriveQuantity& q : other.quantities) {
        if (q.name == name) q.fit = numerics::fit_measures(x, y);
      }
    };
    compare("yaw_rate", &PredictedDrive::yaw_rate_predicted);
    compare("accel_y", &PredictedDrive::accel_y_predicted);
    compare("lateral_velocity", &PredictedDrive::lateral_velocity_predicted);
    return other;
  }

  void check(std::string name, bool passed, double value, double limit, std::string text) {
    if (!passed) out_.warnings.push_back(text);
    out_.checks.push_back({std::move(name), passed, value, limit, std::move(text)});
  }

  void judge() {
    VehicleEstimate& best = *std::find_if(out_.estimates.begin(), out_.estimates.end(),
                                          [&](const VehicleEstimate& e) { return e.method == out_.chosen; });
    const DriveValidation shaken = with_noisier_inputs();
    double unmodelled = 0.0;
    std::string worst;
    for (const PredictedDriveQuantity& q : out_.fit.quantities) {
      const auto signal = std::find(kDriveSignalNames.begin(), kDriveSignalNames.end(), q.name);
      if (signal == kDriveSignalNames.end() || q.name == "yaw") continue;
      const double own = s_.signals[static_cast<std::size_t>(signal - kDriveSignalNames.begin())].sigma;
      const PredictedDriveQuantity* other = shaken.find(q.name);
      const double sigma = std::hypot(own, other != nullptr ? other->fit.rmse : 0.0);
      const double beyond = std::max(0.0, 1.0 - kNoiseDoubt * kNoiseDoubt * sigma * sigma / (q.fit.rmse * q.fit.rmse));
      const double share = std::max(0.0, 1.0 - q.fit.r2) * beyond;
      if (share > unmodelled) {
        unmodelled = share;
        worst = q.name;
      }
      const bool white = !(q.lag1 > kColoured) || !(q.fit.rmse > kBeyondNoise * sigma);
      check(fmt::format("colour of {}", q.name), white, q.lag1, kColoured,
            white
                ? fmt::format("the residual of {} is {} (correlation of neighbours {:.2f})", q.name,
                              q.lag1 > kColoured ? "no larger than sensors and noisy steering leave" : "white enough",
                              q.lag1)
                : fmt::format("the residual of {} is coloured (correlation of neighbours {:.2f}, rms {:.3g} {} against "
                              "{:.3g} of the sensor): something that moves this vehicle is not in the bicycle model",
                              q.name, q.lag1, q.fit.rmse, q.unit, sigma));
    }
    check("unmodelled share", unmodelled <= o_.max_unmodelled, unmodelled, o_.max_unmodelled,
          unmodelled <= o_.max_unmodelled
              ? fmt::format("{:.1f} % of the outputs' variance is neither modelled nor noise", 100.0 * unmodelled)
              : fmt::format("{:.0f} % of the variance of {} is neither modelled nor noise of the sensors",
                            100.0 * unmodelled, worst));
    agreement();

    const PredictedDriveQuantity* r = out_.validation.find("yaw_rate");
    const PredictedDriveQuantity* fit = out_.fit.find("yaw_rate");
    if (r != nullptr)
      check("hold-out", r->fit.r2 >= o_.min_holdout_r2, r->fit.r2, o_.min_holdout_r2,
            fmt::format("it explains {:.1f} % of the yaw rate's variance on the hold-out",
                        100.0 * std::max(0.0, r->fit.r2)));
    else
      out_.warnings.emplace_back("there was no hold-out to validate on");

    if (r != nullptr && fit != nullptr) {
      const bool systematic = r->lag1 > kColoured && r->fit.rmse > kBeyondNoise * fit->fit.rmse;
      const bool coloured_there = r->lag1 > kColoured && !(fit->lag1 > kColoured);
      const bool holds = !systematic && !coloured_there;
      check("residual on the hold-out", holds, r->fit.rmse, kBeyondNoise * fit->fit.rmse,
            fmt::format(
                "the yaw rate's residual on the hold-out is {:.3g} rad/s rms (identification {:.3g}), correlation of "
                "neighbours {:.2f} ({:.2f}){}",
                r->fit.rmse, fit->fit.rmse, r->lag1, fit->lag1,
                holds ? "" : ": the model is systematically off where it was not identified"));
    }

    const auto reject = [&](std::string reason) {
      out_.verdict = VehicleVerdict::kRejected;
      out_.reason = std::move(reason);
      // What the drive does that the model does not is in all methods.
      for (VehicleEstimate& e : out_.estimates) {
        for (ParameterEstimate& p : e.parameters) {
          if (p.status != ParameterStatus::kNotExcited && p.status != ParameterStatus::kFixed)
            p.status = ParameterStatus::kRejected;
        }
      }
      out_.identified = start_;
    };
    if (fit == nullptr) return reject("rejected: the identified model cannot be simulated over the drive");
    if (!(unmodelled <= o_.max_unmodelled))
      return reject(fmt::format("rejected: {}", find_check("unmodelled share")->text));
    if (r != nullptr && !(r->fit.r2 >= o_.min_holdout_r2))
      return reject(
          fmt::format("rejected: it explains {:.0f} % of the yaw rate's variance on the hold-out, less than "
                      "{:.0f} %",
                      100.0 * std::max(0.0, r->fit.r2), 100.0 * o_.min_holdout_r2));
    // No bicycle moves like this: error bars then mean nothing, however well the yaw rate is predicted.
    // (Equation error knows linear tyres only: with the Magic Formula its contradictions say no more than that.)
    for (const char* name : {"surplus equation", "agreement of methods", "agreement of data parts"}) {
      const HonestyCheck* c = find_check(name);
      if (o_.model.tyre == DriveTyre::kLinear && c != nullptr && !c->passed) {
        return reject(
            fmt::format("rejected: {}. Rolling is not in the model: record roll or give signals.roll_gradient, and a "
                        "lower signals.pass_band",
                        c->text));
      }
    }
    std::vector<std::string> identified, unexcited;
    for (const ParameterEstimate& p : best.parameters) {
      const bool vehicle = p.name == "C_f" || p.name == "C_r" || p.name == "I_z" || p.name == "mu" || p.name == "a" ||
                           p.name == "understeer_gradient";
      if (!vehicle) continue;
      if (p.status == ParameterStatus::kNotExcited)
        unexcited.push_back(p.name);
      else
        identified.push_back(p.name);
    }
    if (identified.empty()) {
      out_.verdict = VehicleVerdict::kNotExcited;
      out_.reason = fmt::format("not excited: the drive does not determine {}", fmt::join(unexcited, ", "));
      return;
    }
    out_.verdict = VehicleVerdict::kIdentified;
    out_.reason = fmt::format("{} identified by {}{}", fmt::join(identified, ", "), out_.chosen,
                              r != nullptr ? fmt::format(": {:.1f} % of the yaw rate's variance on the hold-out",
                                                         100.0 * std::max(0.0, r->fit.r2))
                                           : ", without a hold-out to validate on");
    if (!unexcited.empty()) out_.reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
    std::size_t failed = 0;
    for (const HonestyCheck& c : out_.checks) failed += c.passed ? 0 : 1;
    if (failed > 0)
      out_.reason += fmt::format("; {} of {} checks failed, see the warnings", failed, out_.checks.size());
  }

  const HonestyCheck* find_check(std::string_view name) const {
    for (const HonestyCheck& c : out_.checks) {
      if (c.name == name) return &c;
    }
    return nullptr;
  }

  /// Methods against each other, the bicycle's surplus equation, and the hold-out's own estimate.
  void agreement() {
    if (!out_.regression) return;
    const DriveRegressionResult& regression = *out_.regression;
    const Method method = regression.recommends ? regression.recommended : Method::kGtls;
    const AxleEstimate* axle = regression.find(method);
    const VehicleEstimate* ee = out_.find(estimation::to_string(method));
    if (axle == nullptr || !axle->usable || ee == nullptr) return;
    check("surplus equation", axle->consistency_p >= o_.contradiction_level, axle->consistency_p,
          o_.contradiction_level,
          axle->consistency_p >= o_.contradiction_level
              ? fmt::format("the four coefficients of the regressions belong to one bicycle (p = {:.2g})",
                            axle->consistency_p)
              : fmt::format("the four coefficients of the regressions belong to no bicycle (p = {:.1e}): the model is "
                            "incomplete for this vehicle, or a, b or a sensor's place is wrong",
                            axle->consistency_p));
    const VehicleEstimate* oe = out_.find("output error");
    if (oe != nullptr && oe->usable) {
      Eigen::Vector3d difference;
      Eigen::Matrix3d covariance = axle->covariance;
      bool all = true;
      const std::array<const char*, 3> names{"C_f", "C_r", "I_z"};
      for (Eigen::Index i = 0; i < 3; ++i) {
        const ParameterEstimate* p = oe->find(names[static_cast<std::size_t>(i)]);
        all = all && p != nullptr;
        if (p != nullptr) difference(i) = p->value - axle->value(i);
      }
      if (all) {
        // Both come from the same data, so the sum of covariances is more than their difference has: a weak test, but
        // one that does not cry wolf.
        covariance += out_.output_error->covariance.topLeftCorner(3, 3);
        // Small angles, which only equation error takes.
        covariance.diagonal() += (kSmallAngles * axle->value).cwiseAbs2();
        const double p = estimation::agreement_p(difference, covariance);
        check("agreement of methods", p >= o_.contradiction_level, p, o_.contradiction_level,
              p >= o_.contradiction_level
                  ? fmt::format("equation error and output error agree (p = {:.2g})", p)
                  : fmt::format("equation error and output error contradict each other beyond their error bars (p = "
                                "{:.1e}): the model is incomplete for this drive",
                                p));
      }
    }
    if (segments_.holdout.empty()) return;
    const DriveRegressionResult unseen = regress(segments_.holdout, start_);
    const AxleEstimate* again = unseen.find(method);
    if (again == nullptr || !again->usable) return;
    const double p = estimation::agreement_p(again->value - axle->value, again->covariance + axle->covariance);
    check("agreement of data parts", p >= o_.contradiction_level, p, o_.contradiction_level,
          p >= o_.contradiction_level
              ? fmt::format("identification and hold-out data, estimated apart, agree (p = {:.2g})", p)
              : fmt::format("estimates from two parts of the drive contradict each other beyond their error bars (p = "
                            "{:.1e}): the vehicle, the road or the range of motion is not the same in both",
                            p));
  }

  const DriveSignals& s_;
  const DriveSegments& segments_;
  const VehicleParameters<double>& start_;
  const DriveSignalOptions& signal_options_;
  const VehicleIdentifyOptions& o_;
  Progress& progress_;
  Eigen::Vector4d a_slope_ = Eigen::Vector4d::Zero();
  Eigen::Vector4d b_slope_ = Eigen::Vector4d::Zero();
  VehicleIdentification out_;
};

}  // namespace

std::string_view to_string(VehicleVerdict verdict) {
  switch (verdict) {
    case VehicleVerdict::kIdentified:
      return "identified";
    case VehicleVerdict::kNotExcited:
      return "not excited";
    case VehicleVerdict::kRejected:
      break;
  }
  return "rejected";
}

double understeer_gradient(const VehicleParameters<double>& p) {
  return 0.5 * p.mass / p.wheelbase() * (p.b / p.C_f - p.a / p.C_r);
}

VehicleIdentifyOptions VehicleIdentifyOptions::read(const StudyTable& table) {
  VehicleIdentifyOptions o;
  o.equation_error = table.flag_or("equation_error", o.equation_error);
  o.output_error = table.flag_or("output_error", o.output_error);
  if (!o.equation_error && !o.output_error)
    table.fail("output_error", "and equation_error are both false: nothing is left to identify by");
  const std::vector<std::string> methods{"auto", "output error", "OLS", "TLS", "GTLS", "PCA-GTLS"};
  o.method = table.choice_or("method", methods, o.method);
  o.model.read_keys(table);
  o.signal_to_noise = table.number_or("signal_to_noise", "1", o.signal_to_noise);
  if (!(o.signal_to_noise >= 1.0 && o.signal_to_noise <= 10.0))
    table.fail("signal_to_noise", fmt::format("= {} must be from 1 to 10", o.signal_to_noise));
  o.significance = table.number_or("significance", "1", o.significance);
  if (!(o.significance > 0.0 && o.significance < 1.0))
    table.fail("significance", fmt::format("= {} must be between 0 and 1", o.significance));
  o.min_holdout_r2 = table.number_or("min_holdout_r2", "1", o.min_holdout_r2);
  o.max_unmodelled = table.number_or("max_unmodelled", "1", o.max_unmodelled);
  o.contradiction_level = table.number_or("contradiction_level", "1", o.contradiction_level);
  o.max_relative_sigma = table.positive_or("max_relative_sigma", "1", o.max_relative_sigma);
  const StudyTable known = table.table_or_empty("uncertainty");
  const auto sigma = [&](const char* key, const char* unit) {
    const double s = known.number_or(key, unit, 0.0);
    if (!(s >= 0.0)) known.fail(key, fmt::format("= {:g} must be >= 0: it is a standard deviation", s));
    return s;
  };
  o.mass_sigma = sigma("mass", "kg");
  o.a_sigma = sigma("a", "m");
  o.b_sigma = sigma("b", "m");
  return o;
}

const ParameterEstimate* VehicleEstimate::find(std::string_view name) const {
  for (const ParameterEstimate& p : parameters) {
    if (p.name == name) return &p;
  }
  return nullptr;
}

const VehicleEstimate* VehicleIdentification::find(std::string_view method) const {
  for (const VehicleEstimate& e : estimates) {
    if (e.method == method) return &e;
  }
  return nullptr;
}

VehicleIdentification identify_vehicle(const DriveSignals& signals, const DriveSegments& segments,
                                       const VehicleParameters<double>& start, const DriveSignalOptions& signal_options,
                                       const VehicleIdentifyOptions& options, Progress& progress) {
  return Identification(signals, segments, start, signal_options, options, progress).run();
}

Eigen::VectorXd fit_drive_biases(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                 const VehicleParameters<double>& vehicle, const DriveModelOptions& options) {
  return Identification::with_fitted_biases(signals, spans, vehicle, options);
}

estimation::Estimate make_vehicle_estimate(const VehicleIdentification& identification, const std::string& subject) {
  estimation::Estimate out;
  out.subject = subject;
  out.method = identification.chosen;
  if (const VehicleEstimate* best = identification.best()) {
    for (const ParameterEstimate& p : best->parameters)
      out.parameters.push_back({p.name, p.value, p.sigma, p.low95, p.high95, p.unit, p.status});
    out.covariance = best->covariance;
  }
  for (const VehicleEstimate& e : identification.estimates) {
    if (e.method == identification.chosen || !e.usable) continue;
    for (const ParameterEstimate& p : e.parameters)
      out.other_methods.push_back({p.name, e.method, p.value, p.sigma, p.low95, p.high95, p.unit, p.status});
  }
  for (const PredictedDriveQuantity& q : identification.fit.quantities) {
    out.fit[q.name + ".r2"] = q.fit.r2;
    out.fit[q.name + ".rmse"] = q.fit.rmse;
    if (std::isfinite(q.lag1)) out.fit[q.name + ".lag1"] = q.lag1;
  }
  for (const PredictedDriveQuantity& q : identification.validation.quantities)
    out.validation[q.name] = {q.fit.mae, q.fit.rmse, q.fit.r2, q.fit.theil, q.unit};
  out.verdict = identification.reason;
  out.warnings = identification.warnings;
  return out;
}

}  // namespace veridyn::vehicle
