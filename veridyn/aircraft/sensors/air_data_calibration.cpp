#include "veridyn/aircraft/sensors/air_data_calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/io/tables/table.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kGasConstant = 287.05287;  // of dry air [J/(kg K)], ISO 2533
constexpr double kSignificance = 0.01;
constexpr std::size_t kLeastPoints = 4;
constexpr double kLeastKnownScale = 0.05;  // a scale known worse than this is none

const std::vector<std::string>& calibrated_channels() {
  static const std::vector<std::string> names{"dynamic_pressure", "static_pressure", "air_temperature",
                                              "airspeed",         "alpha",           "beta"};
  return names;
}

std::string unit_of(const std::string& channel) {
  for (const StandardChannel& c : standard_channels()) {
    if (c.name == channel) return c.unit;
  }
  return "1";
}

/// A column for a sensor, its unit checked where it has one.
const std::vector<double>& column(const io::Table& table, const std::string& name, const std::string& unit) {
  const io::TableColumn& c = table.at(name);
  if (!c.unit.same_dimension(parse_unit(unit)))
    throw InputError(table.source, fmt::format("column '{}' is in [{}], expected [{}]", name, c.unit.si_name(), unit));
  return c.value;
}

std::vector<double> reference_of(const io::Table& table, const CalibrationInput& in) {
  if (in.reference_speed.empty()) return column(table, in.reference, unit_of(in.channel));
  std::vector<double> q = column(table, in.reference_speed, "m/s");
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double rho = in.air_density > 0.0 ? in.air_density
                                            : column(table, in.static_pressure, "Pa")[i] /
                                                  (kGasConstant * column(table, in.air_temperature, "K")[i]);
    q[i] *= 0.5 * rho * q[i];
  }
  return q;
}

/// Fits one sensor to its reference.
class Fitting {
 public:
  Fitting(const io::Table& table, const CalibrationInput& in) : in_(in) {
    fit_.calibration.channel = in.channel;
    fit_.unit = unit_of(in.channel);
    const std::vector<double> reference = reference_of(table, in);
    const std::vector<double>& raw = table.at(in.raw).value;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (!std::isfinite(raw[i]) || !std::isfinite(reference[i])) continue;
      fit_.raw.push_back(raw[i]);
      fit_.reference.push_back(reference[i]);
    }
    if (fit_.raw.size() < kLeastPoints) {
      throw InputError(table.source,
                       fmt::format("holds {} points of {}, {} are needed", fit_.raw.size(), in.channel, kLeastPoints));
    }
    const auto [low, high] = std::minmax_element(fit_.reference.begin(), fit_.reference.end());
    if (!(*high > *low)) throw InputError(table.source, fmt::format("the reference of {} never changes", in.channel));
  }

  SensorFit run() {
    line();
    residuals();
    directions();
    nonlinearity();
    findings();
    return std::move(fit_);
  }

 private:
  estimation::RegressionData data(bool with_square) const {
    const auto n = static_cast<Eigen::Index>(fit_.raw.size());
    estimation::RegressionData d;
    d.regressors.resize(n, with_square ? 3 : 2);
    d.regressand.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double x = fit_.reference[i];
      d.regressors(i, 0) = 1.0;
      d.regressors(i, 1) = x;
      if (with_square) d.regressors(i, 2) = x * x;
      d.regressand(i) = fit_.raw[i];
    }
    d.parameter_names = {"bias", "scale"};
    if (with_square) d.parameter_names.emplace_back("quadratic");
    d.regressand_name = in_.channel;
    return d;
  }

  void line() {
    estimation::RegressionData d = data(false);
    if (in_.sigma_reference > 0.0) {
      fit_.method = estimation::Method::kGtls;
      d.error_covariance =
          Eigen::Vector3d(0.0, in_.sigma_reference * in_.sigma_reference, in_.sigma_raw * in_.sigma_raw).asDiagonal();
      // The ratio of the errors is what was stated; their size is what the residual shows.
      d.error_scale_known = false;
    }
    const estimation::RegressionEstimate e = estimation::estimate(d, fit_.method);
    fit_.usable = e.usable() && e.theta(1) != 0.0;
    if (!fit_.usable) {
      fit_.findings.push_back(e.message);
      return;
    }
    fit_.calibration.bias = e.theta(0);
    fit_.calibration.scale = e.theta(1);
    fit_.calibration.covariance << e.covariance(1, 1), e.covariance(0, 1), e.covariance(0, 1), e.covariance(0, 0);
    if (!(e.covariance(1, 1) <= kLeastKnownScale * kLeastKnownScale * e.theta(1) * e.theta(1))) bias_only();
  }

  /// Far from the points a scale that they do not determine would do harm: the sensor's scale is kept.
  void bias_only() {
    const auto n = static_cast<double>(fit_.raw.size());
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < fit_.raw.size(); ++i) mean += (fit_.raw[i] - fit_.reference[i]) / n;
    for (std::size_t i = 0; i < fit_.raw.size(); ++i) squares += std::pow(fit_.raw[i] - fit_.reference[i] - mean, 2);
    fit_.findings.push_back(
        fmt::format("the reference changes too little to tell a scale ({:.2g} +- {:.2g}): scale 1 is kept, the "
                    "bias fitted alone",
                    fit_.calibration.scale, std::sqrt(fit_.calibration.covariance(0, 0))));
    fit_.bias_only = true;
    fit_.calibration.scale = 1.0;
    fit_.calibration.bias = mean;
    fit_.calibration.covariance << 0.0, 0.0, 0.0, squares / (n - 1.0) / n;
  }

  void residuals() {
    SensorCalibration& c = fit_.calibration;
    const auto [low, high] = std::minmax_element(fit_.raw.begin(), fit_.raw.end());
    c.raw_low = *low;
    c.raw_high = *high;
    double sum = 0.0;
    for (std::size_t i = 0; i < fit_.raw.size(); ++i) {
      const double r = c.corrected(fit_.raw[i]) - fit_.reference[i];
      fit_.residual.push_back(r);
      sum += r * r;
      if (std::abs(r) > std::abs(fit_.worst)) {
        fit_.worst = r;
        fit_.worst_point = i + 1;
      }
    }
    const auto n = static_cast<double>(fit_.raw.size());
    fit_.rms = std::sqrt(sum / n);
    c.residual_rms = std::sqrt(sum / (n - 2.0));
    fit_.whiteness = numerics::whiteness_test(fit_.residual);
    const double stated = std::hypot(in_.sigma_reference, in_.sigma_raw / c.scale);
    if (in_.sigma_raw > 0.0) fit_.error_ratio = c.residual_rms * c.residual_rms / (stated * stated);
  }

  void directions() {
    const auto [low, high] = std::minmax_element(fit_.reference.begin(), fit_.reference.end());
    const double least = 1e-3 * (*high - *low);
    fit_.direction.assign(fit_.raw.size(), 0);
    for (std::size_t i = 1; i < fit_.raw.size(); ++i) {
      const double step = fit_.reference[i] - fit_.reference[i - 1];
      fit_.direction[i] = step > least ? 1 : step < -least ? -1 : fit_.direction[i - 1];
    }
    double sum[2] = {0, 0}, squares[2] = {0, 0}, count[2] = {0, 0};
    for (std::size_t i = 0; i < fit_.raw.size(); ++i) {
      if (fit_.direction[i] == 0) continue;
      const std::size_t k = fit_.direction[i] > 0 ? 0 : 1;
      sum[k] += fit_.residual[i];
      squares[k] += fit_.residual[i] * fit_.residual[i];
      count[k] += 1.0;
    }
    fit_.hysteresis = fit_.hysteresis_sigma = kNaN;
    if (count[0] < 3 || count[1] < 3) return;
    double variance = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double mean = sum[k] / count[k];
      variance += (squares[k] / count[k] - mean * mean) / (count[k] - 1.0);
    }
    fit_.hysteresis = sum[0] / count[0] - sum[1] / count[1];
    fit_.hysteresis_sigma = std::sqrt(std::max(0.0, variance));
  }

  void nonlinearity() {
    if (fit_.raw.size() < 6) return;
    // Centred, so that the square is as independent of the line as it can be.
    estimation::RegressionData d = data(true);
    const double mean = d.regressors.col(1).mean();
    const double half = 0.5 * (d.regressors.col(1).maxCoeff() - d.regressors.col(1).minCoeff());
    d.regressors.col(1).array() = (d.regressors.col(1).array() - mean) / half;
    d.regressors.col(2) = d.regressors.col(1).cwiseAbs2();
    const estimation::RegressionEstimate e =
        estimation::estimate(d, estimation::Method::kOls, {.covariance = estimation::CovarianceKind::kWhite});
    if (!e.usable()) return;
    fit_.quadratic = e.theta(2) / (half * half);
    fit_.quadratic_p = e.parameters[2].p_value;
    // Against the straight line the parabola is off by two thirds of its rise at the ends.
    fit_.bend = 2.0 / 3.0 * e.theta(2) / fit_.calibration.scale;
  }

  void findings() {
    if (!fit_.usable) return;
    const auto shown = [&](double value) {
      return fit_.unit == "rad" ? fmt::format("{:.2g} deg", value / kDegree)
                                : fmt::format("{:.3g} {}", value, fit_.unit);
    };
    if (fit_.quadratic_p < kSignificance) {
      fit_.findings.push_back(
          fmt::format("not a straight line: a quadratic term is significant (p = {:.1e}) and amounts to {} at the ends "
                      "of the range",
                      fit_.quadratic_p, shown(std::abs(fit_.bend))));
    }
    if (std::abs(fit_.hysteresis) > 3.0 * fit_.hysteresis_sigma) {
      fit_.findings.push_back(fmt::format("hysteresis: rising reads {} {} than falling",
                                          shown(std::abs(fit_.hysteresis)), fit_.hysteresis > 0.0 ? "more" : "less"));
    }
    if (fit_.raw.size() >= 20 && !fit_.whiteness.white(kSignificance)) {
      fit_.findings.push_back(
          fmt::format("residuals of neighbouring points go together (lag 1: {:.2f}, p = {:.1e}): something drifted, or "
                      "the line is not straight",
                      fit_.whiteness.lag1, fit_.whiteness.p_value));
    }
    if (fit_.error_ratio > 4.0) {
      fit_.findings.push_back(
          fmt::format("the residual is {:.1f} times what the stated errors explain", std::sqrt(fit_.error_ratio)));
    }
    if (std::abs(fit_.worst) > 4.0 * fit_.rms) {
      fit_.findings.push_back(fmt::format("point {} is off by {}, {:.1f} times the rms", fit_.worst_point,
                                          shown(fit_.worst), std::abs(fit_.worst) / fit_.rms));
    }
  }

  CalibrationInput in_;
  SensorFit fit_;
};

}  // namespace

double SensorCalibration::sigma(double raw, bool with_residual) const {
  // d corrected/d scale = -corrected/scale, d/d bias = -1/scale.
  const Eigen::Vector2d J(-corrected(raw) / scale, -1.0 / scale);
  return std::sqrt(std::max(0.0, J.dot(covariance * J)) + (with_residual ? residual_rms * residual_rms : 0.0));
}

namespace {

void check_input(const StudyTable& table, CalibrationInput& in) {
  std::vector<std::string> missing;
  const auto want = [&](const char* key) {
    if (!table.has(key)) missing.emplace_back(key);
  };
  if (in.reference_speed.empty()) {
    want("reference");
    for (const char* key : {"air_density", "static_pressure", "air_temperature"})
      if (table.has(key)) table.fail(key, "is of a reference_speed");
  } else {
    if (table.has("reference")) table.fail("reference", "is given together with reference_speed");
    if (table.has("air_density")) {
      for (const char* key : {"static_pressure", "air_temperature"})
        if (table.has(key)) table.fail(key, "is given together with air_density");
    } else {
      want("static_pressure");
      want("air_temperature");
    }
  }
  refuse_missing(table, missing);
  if (in.sigma_reference > 0.0 && !(in.sigma_raw > 0.0))
    table.fail("sigma_reference", "needs sigma_raw alongside: total least squares goes by their ratio");
}

KeyTable<CalibrationInput> input_keys(const std::string& channel) {
  using I = CalibrationInput;
  KeyTable<I> table(channel, fmt::format("One sensor; likewise {}.", fmt::join(calibrated_channels(), ", ")));
  table.text("raw", &I::raw, "column of its reading")
      .required()
      .text("reference", &I::reference, "column of the truth")
      .otherwise("required without `reference_speed`");
  if (channel == "dynamic_pressure")
    table.text("reference_speed", &I::reference_speed, "dynamic pressure: column of a speed in place of `reference`")
        .text("static_pressure", &I::static_pressure, "and of the pressure that gives the density")
        .text("air_temperature", &I::air_temperature, "and of the temperature")
        .number("air_density", &I::air_density, "kg/m^3", kPositive, "or that density")
        .otherwise("by pressure and temperature");
  return table
      .number("sigma_reference", &I::sigma_reference, unit_of(channel), kNotNegative,
              "standard error of the reference per point; with it total least squares takes the place of least squares")
      .number("sigma_raw", &I::sigma_raw, unit_of(channel), kNotNegative, "standard error of the reading per point")
      .check(check_input);
}

void read_sensors(const StudyTable& table, CalibrationStudy& study) {
  for (const std::string& channel : calibrated_channels()) {
    if (!table.has(channel)) continue;
    study.sensors.push_back(input_keys(channel).read(table.table(channel)));
    study.sensors.back().channel = channel;
  }
}

}  // namespace

const KeyTable<CalibrationStudy>& CalibrationStudy::keys() {
  using S = CalibrationStudy;
  static const auto table =
      KeyTable<S>("calibration", "Points of a wind tunnel, from which sensors are calibrated.")
          .text("name", &S::name, "of what is calibrated")
          .file("file", &S::file,
                "table of the points, columns `name[unit]`, rows in the order in which they were taken")
          .required()
          .within("dynamic_pressure", input_keys("dynamic_pressure"), read_sensors)
          .check([](const StudyTable& t, S& study) {
            if (study.sensors.empty())
              t.fail("file", fmt::format("the calibration names no sensor; known are {}",
                                         fmt::join(calibrated_channels(), ", ")));
          });
  return table;
}

std::string method_text(const SensorFit& fit) {
  return fmt::format("{}{}", estimation::to_string(fit.method), fit.bias_only ? " (bias only)" : "");
}

CalibrationResult calibrate(const CalibrationStudy& study) {
  const io::Table table = io::read_table(study.file);
  CalibrationResult result;
  estimation::Estimate& e = result.estimate;
  e.subject = study.name;
  std::vector<std::string> methods, good, caution;
  for (const CalibrationInput& in : study.sensors) result.sensors.push_back(Fitting(table, in).run());
  const auto n = static_cast<Eigen::Index>(2 * result.sensors.size());
  e.covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index at = 0;
  for (const SensorFit& fit : result.sensors) {
    const SensorCalibration& c = fit.calibration;
    const double z = numerics::student_t_quantile(0.975, static_cast<double>(fit.raw.size()) - 2.0);
    const auto add = [&](const char* name, double value, double sigma, const std::string& unit) {
      e.parameters.push_back({.name = fmt::format("{}.{}", c.channel, name),
                              .value = value,
                              .sigma = sigma,
                              .low95 = value - z * sigma,
                              .high95 = value + z * sigma,
                              .unit = unit,
                              .status = !fit.usable   ? estimation::ParameterStatus::kRejected
                                        : sigma > 0.0 ? estimation::ParameterStatus::kIdentified
                                                      : estimation::ParameterStatus::kFixed});
    };
    add("scale", c.scale, std::sqrt(c.covariance(0, 0)), "1");
    add("bias", c.bias, std::sqrt(c.covariance(1, 1)), fit.unit);
    e.covariance.block(at, at, 2, 2) = c.covariance;
    at += 2;
    e.fit[c.channel + ".rms"] = fit.rms;
    e.fit[c.channel + ".worst"] = fit.worst;
    e.fit[c.channel + ".points"] = static_cast<double>(fit.raw.size());
    e.fit[c.channel + ".whiteness_p"] = fit.whiteness.p_value;
    e.fit[c.channel + ".quadratic_p"] = fit.quadratic_p;
    e.fit[c.channel + ".hysteresis"] = fit.hysteresis;
    const std::string method = method_text(fit);
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
    (fit.findings.empty() ? good : caution).push_back(c.channel);
    for (const std::string& finding : fit.findings) e.warnings.push_back(fmt::format("{}: {}", c.channel, finding));
  }
  e.method = fmt::format("{}", fmt::join(methods, ", "));
  std::vector<std::string> parts;
  if (!good.empty()) parts.push_back(fmt::format("calibrated: {}", fmt::join(good, ", ")));
  if (!caution.empty()) parts.push_back(fmt::format("with reservations: {}", fmt::join(caution, ", ")));
  e.verdict = fmt::format("{}", fmt::join(parts, "; "));
  return result;
}

std::string residuals_csv(const CalibrationResult& result) {
  std::string text = "channel,point,reference,raw,residual,direction\n";
  for (const SensorFit& fit : result.sensors) {
    for (std::size_t i = 0; i < fit.raw.size(); ++i) {
      text += fmt::format("{},{},{},{},{},{}\n", fit.calibration.channel, i + 1, fit.reference[i], fit.raw[i],
                          fit.residual[i], fit.direction[i]);
    }
  }
  return text;
}

std::string calibration_toml(const std::vector<SensorCalibration>& sensors, const std::string& origin) {
  std::string text = fmt::format(
      "# Calibration from {}; `[data] calibration = \"calibration.toml\"` applies it.\n"
      "# true = (raw - bias)/scale, SI and radians; covariance of [scale, bias]; range of the raw reading.\n",
      origin);
  for (const SensorCalibration& c : sensors) {
    text += fmt::format(
        "\n[{}]\nscale = {}\nbias = {}\ncovariance = [{}, {}, {}, {}]\nrange = [{}, {}]\nresidual_rms = {}\n",
        c.channel, c.scale, c.bias, c.covariance(0, 0), c.covariance(0, 1), c.covariance(1, 0), c.covariance(1, 1),
        c.raw_low, c.raw_high, c.residual_rms);
  }
  return text;
}

std::vector<SensorCalibration> read_calibration(const std::filesystem::path& path) {
  const Study file = Study::load(path);
  std::vector<SensorCalibration> sensors;
  for (const std::string& channel : file.root().keys()) {
    const auto& known = calibrated_channels();
    if (std::find(known.begin(), known.end(), channel) == known.end())
      file.root().fail(
          channel, fmt::format("is not a channel that can be calibrated{}", suggestion(channel, known, known.size())));
    const StudyTable t = file.root().table(channel);
    SensorCalibration c;
    c.channel = channel;
    c.scale = t.number("scale", "1");
    if (!(std::abs(c.scale) > 1e-6)) t.fail("scale", fmt::format("= {:g} must not be 0", c.scale));
    c.bias = t.number("bias", unit_of(channel));
    if (t.has("covariance")) {
      const std::vector<double> v = t.numbers("covariance", "1");
      if (v.size() != 4 || !(v[0] >= 0.0) || !(v[3] >= 0.0) || v[1] != v[2] ||
          !(v[0] * v[3] >= v[1] * v[2] * (1 - 1e-9)))
        t.fail("covariance", "must be 4 numbers, a covariance matrix of [scale, bias] by rows");
      c.covariance << v[0], v[1], v[2], v[3];
    }
    c.raw_low = -kInfinity;
    c.raw_high = kInfinity;
    if (t.has("range")) {
      const std::vector<double> v = t.numbers("range", unit_of(channel));
      if (v.size() != 2 || !(v[0] < v[1])) t.fail("range", "must be two numbers, the smaller first");
      c.raw_low = v[0];
      c.raw_high = v[1];
    }
    c.residual_rms = t.number_or("residual_rms", unit_of(channel), 0.0);
    if (!(c.residual_rms >= 0.0)) t.fail("residual_rms", fmt::format("= {:g} must be >= 0", c.residual_rms));
    sensors.push_back(c);
  }
  file.root().finish();
  if (sensors.empty()) throw InputError(path.string(), "holds no calibration");
  return sensors;
}

void apply_calibration(const std::vector<SensorCalibration>& sensors, MappedRecording& mapped) {
  for (const SensorCalibration& c : sensors) {
    const Channel* raw = mapped.recording.find(c.channel);
    if (raw == nullptr) {
      mapped.notes.push_back(fmt::format("the calibration of {} is not used: the log has no such channel", c.channel));
      continue;
    }
    Channel corrected = *raw;
    std::size_t outside = 0;
    double squares = 0.0;
    const double margin = 0.02 * (c.raw_high - c.raw_low);
    for (double& v : corrected.value) {
      if (v < c.raw_low - margin || v > c.raw_high + margin) ++outside;
      const double s = c.sigma(v);
      if (std::isfinite(s)) squares += s * s;
      v = c.corrected(v);
    }
    const auto n = static_cast<double>(std::max<std::size_t>(1, corrected.size()));
    mapped.calibration_sigma.emplace_back(c.channel, std::sqrt(squares / n));
    mapped.recording.set(std::move(corrected));
    for (ChannelOrigin& origin : mapped.origins) {
      if (origin.channel != c.channel) continue;
      origin.note +=
          fmt::format("{}calibrated: (raw - {:.4g})/{:.4g}", origin.note.empty() ? "" : "; ", c.bias, c.scale);
    }
    if (static_cast<double>(outside) > 0.01 * n) {
      mapped.notes.push_back(fmt::format("{}: {:.0f} % of the samples lie outside the range of its calibration",
                                         c.channel, 100.0 * static_cast<double>(outside) / n));
    }
  }
}

}  // namespace veridyn::aircraft
