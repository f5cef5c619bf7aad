#include "veridyn/aircraft/sensors/swing_test.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

/// Inputs of an axis: mass, cradle mass, filar distance, length, cradle length, offset, frequency, cradle frequency.
constexpr int kInputs = 8;

/// The terms for values of the inputs `v`.
template <typename Scalar>
SwingTerms<Scalar> terms_of(const SwingAxis& axis, double g, bool with_cradle, const Scalar* v) {
  const Scalar &m = v[0], &mc = v[1], &d = v[2], &L = v[3], &Lc = v[4], &w = v[6], &wc = v[7];
  const Scalar total = m + mc;
  if (axis.suspension == Suspension::kBifilar) {
    return {total * g * d * d / (4.0 * w * w * L), with_cradle ? mc * g * d * d / (4.0 * wc * wc * Lc) : Scalar(0.0),
            Scalar(0.0)};
  }
  const Scalar arm = L + v[5];
  return {total * g * L / (w * w), with_cradle ? mc * g * Lc / (wc * wc) : Scalar(0.0), m * arm * arm};
}

Eigen::VectorXd values_of(const SwingTest& test, const SwingAxis& axis, double w, double wc) {
  Eigen::VectorXd v(kInputs);
  v << test.mass, test.cradle_mass, axis.filar_distance, axis.length, axis.cradle_length, axis.offset, w, wc;
  return v;
}

const KeyTable<SwingAxis>& axis_keys() {
  using A = SwingAxis;
  static const auto table =
      KeyTable<A>("x", "Swings about one body axis; `y` and `z` likewise, each optional.")
          .choice("suspension", &A::suspension,
                  {{"bifilar", Suspension::kBifilar}, {"pendulum", Suspension::kPendulum}},
                  "`bifilar`: from two parallel lines, turning about the vertical; `pendulum`: about a pivot")
          .number("filar_distance", &A::filar_distance, "m", kPositive, "between the lines")
          .otherwise("required where bifilar")
          .number("length", &A::length, "m", kPositive,
                  "of the lines, or from pivot to centre of gravity, aircraft in its cradle")
          .required()
          .number("cradle_length", &A::cradle_length, "m", kPositive, "the same with the cradle alone")
          .otherwise("required with a cradle")
          .number("offset", &A::offset, "m", kAnyNumber,
                  "pendulum: how much further from the pivot the aircraft's centre of gravity is")
          .files("files", &A::files, "runs with the aircraft")
          .required()
          .files("cradle_files", &A::cradle_files, "runs of the cradle alone")
          .otherwise("required with a cradle")
          .check([](const StudyTable& t, A& axis) {
            const bool bifilar = axis.suspension == Suspension::kBifilar;
            if (bifilar && t.has("offset")) t.fail("offset", "is of a pendulum");
            if (!bifilar && t.has("filar_distance")) t.fail("filar_distance", "is of a bifilar suspension");
            if (bifilar && !t.has("filar_distance")) refuse_missing(t, {"filar_distance"});
            if (axis.files.empty()) t.fail("files", "is empty");
          });
  return table;
}

void read_axes(const StudyTable& table, SwingTest& test) {
  for (const char name : {'x', 'y', 'z'}) {
    const std::string key(1, name);
    if (!table.has(key)) continue;
    const StudyTable own = table.table(key);
    SwingAxis axis = axis_keys().read(own);
    axis.axis = name;
    if (test.cradle_mass > 0.0) {
      require_keys(own, {"cradle_length", "cradle_files"});
      if (axis.cradle_files.empty()) own.fail("cradle_files", "is empty, but there is a cradle_mass");
    } else {
      refuse_keys(own, {"cradle_length", "cradle_files"}, "is given, but cradle_mass is 0");
    }
    test.axes.push_back(std::move(axis));
  }
}

/// Mean of the runs' frequencies and its standard deviation.
std::pair<double, double> mean_frequency(const std::vector<SwingRun>& runs, bool cradle) {
  std::vector<double> w;
  double fits = 0.0;
  for (const SwingRun& run : runs) {
    if (run.cradle_alone != cradle || !run.fit.usable()) continue;
    w.push_back(run.fit.undamped_frequency());
    fits += run.fit.sigma_frequency * run.fit.sigma_frequency;
  }
  if (w.empty()) return {kNaN, kNaN};
  const auto n = static_cast<double>(w.size());
  double mean = 0.0;
  for (const double x : w) mean += x / n;
  double scatter = 0.0;
  for (const double x : w) scatter += (x - mean) * (x - mean);
  const double by_fits = std::sqrt(fits) / n;
  // Runs are repeated because each hangs a little differently: what a fit does not know, the scatter shows.
  return {mean, w.size() > 1 ? std::max(by_fits, std::sqrt(scatter / (n - 1.0) / n)) : by_fits};
}

bool with_cradle(const SwingTest& test) { return test.cradle_mass > 0.0; }

/// What a run has to be warned of.
std::vector<std::string> warnings_of(const SwingRun& run) {
  if (!run.fit.usable()) return {fmt::format("{} is left out: {}", run.file, to_string(run.fit.end))};
  std::vector<std::string> warnings;
  // A pendulum's period grows by a sixteenth of the amplitude squared; of a bifilar suspension it does so as well.
  const double slower = run.fit.mean_square_swing / 16.0;
  if (slower > 0.002) {
    warnings.push_back(fmt::format(
        "{}: swings of {:.0f} deg at first make it slower by about {:.1f} %, the inertia larger by {:.1f} %", run.file,
        run.fit.amplitude() / kDegree, 100.0 * slower, 200.0 * slower));
  }
  if (run.swing.principal_share < 0.9) {
    warnings.push_back(fmt::format("{}: only {:.0f} % of the motion is about its main axis", run.file,
                                   100.0 * run.swing.principal_share));
  }
  return warnings;
}

SwingRun fitted_run(const SwingTest& test, const std::filesystem::path& file, bool cradle_alone) {
  SwingRun run;
  run.file = file.filename().string();
  run.cradle_alone = cradle_alone;
  run.swing = swing_angle(io::read_recording(file), test.channel);
  std::tie(run.begin, run.end) = free_swing(run.swing, test.settle_s, test.fade);
  const std::size_t count = run.end - run.begin;
  run.fit = estimation::fit_damped_cosine(std::span<const double>(run.swing.time).subspan(run.begin, count),
                                          std::span<const double>(run.swing.angle).subspan(run.begin, count));
  return run;
}

/// All runs about an axis, the aircraft's or those of the cradle alone. @throws InputError where none is usable.
std::vector<SwingRun> fitted_runs(const SwingTest& test, const SwingAxis& axis, bool cradle_alone) {
  const std::vector<std::filesystem::path>& files = cradle_alone ? axis.cradle_files : axis.files;
  std::vector<SwingRun> runs;
  for (const std::filesystem::path& file : files) runs.push_back(fitted_run(test, file, cradle_alone));
  if (std::ranges::none_of(runs, [](const SwingRun& run) { return run.fit.usable(); })) {
    throw InputError(files.front().string(),
                     fmt::format("neither this nor another {} run about {} holds a decaying oscillation",
                                 cradle_alone ? "cradle" : "aircraft", axis.axis));
  }
  return runs;
}

Eigen::VectorXd sigma_of(const SwingTest& test, const AxisInertia& i) {
  const bool bifilar = i.test.suspension == Suspension::kBifilar, cradle = with_cradle(test);
  Eigen::VectorXd sigma(kInputs);
  sigma << test.sigma_mass, cradle ? test.sigma_mass : 0.0, bifilar ? test.sigma_filar_distance : 0.0,
      test.sigma_length, cradle ? test.sigma_length : 0.0, bifilar ? 0.0 : test.sigma_length, i.sigma_frequency,
      i.sigma_cradle_frequency;
  return sigma;
}

Eigen::RowVectorXd jacobian_of(const SwingTest& test, const AxisInertia& i) {
  using Jet = ceres::Jet<double, kInputs>;
  const Eigen::VectorXd v = values_of(test, i.test, i.frequency, i.cradle_frequency);
  std::array<Jet, kInputs> jets;
  for (int k = 0; k < kInputs; ++k) jets[k] = Jet(v(k), k);
  return terms_of(i.test, test.gravity, with_cradle(test), jets.data()).inertia().v.transpose();
}

/// The distribution of its error, from those of all that was measured.
estimation::ErrorDistribution error_of(const SwingTest& test, const AxisInertia& i, int threads) {
  estimation::UncertainInputs inputs;
  inputs.names = {"mass",          "cradle mass", "filar distance", "length",
                  "cradle length", "offset",      "frequency",      "cradle frequency"};
  inputs.low = inputs.high = values_of(test, i.test, i.frequency, i.cradle_frequency);
  inputs.correlation = Eigen::MatrixXd::Identity(kInputs, kInputs);
  inputs.error_covariance = sigma_of(test, i).cwiseAbs2().asDiagonal();
  const double g = test.gravity;
  const bool cradle = with_cradle(test);
  const auto f = [&](const double* x, double* y) { y[0] = terms_of(i.test, g, cradle, x).inertia(); };
  const estimation::MonteCarloOptions options{.draws = test.draws, .seed = test.seed, .threads = threads};
  return estimation::propagate_errors(inputs, 1, f, options).outputs[0];
}

/// Whether it is determined, and the sentence that says so.
std::pair<InertiaVerdict, std::string> judged(const SwingTest& test, const AxisInertia& i) {
  const double relative = i.sigma() / i.value;
  const double ratio = i.largest_term / std::abs(i.value);
  const std::string numbers = fmt::format("I{} = {:.4g} +- {:.2g} kg m^2", i.test.axis, i.value, i.sigma());
  if (i.value > 0.0 && relative <= test.max_relative_sigma)
    return {InertiaVerdict::kDetermined, fmt::format("{}, {:.1f} %", numbers, 100.0 * relative)};
  std::string reason = fmt::format("I{} is not determined by this test: {}", i.test.axis, numbers);
  if (!(i.value > 0.0)) {
    reason += ", which no body has";
  } else {
    reason += fmt::format(", {:.0f} % (limit {:.0f} %)", 100.0 * relative, 100.0 * test.max_relative_sigma);
  }
  if (ratio > 5.0) {
    reason += fmt::format(
        "; it is the difference of numbers up to {:.0f} times larger: half a percent of frequency moves it by {:.2g} "
        "kg m^2",
        ratio, i.per_half_percent_of_frequency);
  }
  return {InertiaVerdict::kNotDetermined, std::move(reason)};
}

AxisInertia analysed(const SwingTest& test, const SwingAxis& axis, int threads) {
  AxisInertia i;
  i.test = axis;
  i.runs = fitted_runs(test, axis, false);
  std::tie(i.frequency, i.sigma_frequency) = mean_frequency(i.runs, false);
  i.cradle_frequency = 1.0;
  if (with_cradle(test)) {
    for (SwingRun& run : fitted_runs(test, axis, true)) i.runs.push_back(std::move(run));
    std::tie(i.cradle_frequency, i.sigma_cradle_frequency) = mean_frequency(i.runs, true);
  }
  const SwingTerms<double> terms = swing_terms(test, axis, i.frequency, i.cradle_frequency);
  i.value = terms.inertia();
  i.largest_term = std::max({terms.whole, terms.cradle, terms.transfer});
  const Eigen::RowVectorXd jacobian = jacobian_of(test, i);
  const Eigen::VectorXd parts = jacobian.transpose().cwiseProduct(sigma_of(test, i));
  i.by_mass = parts.head<2>().norm();
  i.by_filar_distance = std::abs(parts(2));
  i.by_length = parts.segment<3>(3).norm();
  i.by_frequency = parts.tail<2>().norm();
  i.per_half_percent_of_frequency = std::abs(jacobian(6)) * 0.005 * i.frequency;
  i.error = error_of(test, i, threads);
  std::tie(i.verdict, i.reason) = judged(test, i);
  return i;
}

Eigen::MatrixXd covariance_of(const SwingTest& test, const std::vector<AxisInertia>& axes) {
  const Eigen::Index n = signed_index(axes.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  const auto by_input = [&](const AxisInertia& i) -> Eigen::RowVectorXd {
    return jacobian_of(test, i).cwiseProduct(sigma_of(test, i).transpose());
  };
  for (Eigen::Index a = 0; a < n; ++a) {
    covariance(a, a) = axes[a].sigma() * axes[a].sigma();
    for (Eigen::Index b = 0; b < a; ++b) {
      // The two masses are the same in all tests; lines and lengths are measured for each.
      const double shared = by_input(axes[a]).head<2>().dot(by_input(axes[b]).head<2>());
      covariance(a, b) = covariance(b, a) = shared;
    }
  }
  return covariance;
}

/// A moment that exceeds the sum of the other two.
struct Excess {
  std::string text;
  bool beyond_error = false;
};

std::optional<Excess> excess_of(const std::vector<AxisInertia>& axes, const Eigen::MatrixXd& covariance) {
  if (axes.size() != 3) return std::nullopt;
  const Eigen::Vector3d J(axes[0].value, axes[1].value, axes[2].value);
  Eigen::Index largest = 0;
  J.maxCoeff(&largest);
  Eigen::Vector3d signs = Eigen::Vector3d::Constant(-1.0);
  signs(largest) = 1.0;
  const double excess = signs.dot(J);
  const double sigma = std::sqrt(std::max(0.0, signs.dot(covariance * signs)));
  if (!(excess > 0.0)) return std::nullopt;
  return Excess{
      fmt::format(
          "I{} exceeds the sum of the other two by {:.2g} +- {:.2g} kg m^2, which no body of positive mass does",
          axes[largest].test.axis, excess, sigma),
      excess > 2.0 * sigma};
}

estimation::Estimate estimate_of(const SwingTest& test, const std::vector<AxisInertia>& axes,
                                 const Eigen::MatrixXd& covariance, const std::vector<std::string>& warnings) {
  estimation::Estimate e;
  e.subject = test.name;
  e.method = "swing test";
  std::vector<std::string> found, missing;
  const double z = numerics::normal_quantile(0.975);
  for (const AxisInertia& i : axes) {
    const bool determined = i.verdict == InertiaVerdict::kDetermined;
    (determined ? found : missing).push_back(fmt::format("J{}", i.test.axis));
    // error = measured - true: the interval of the true value is the other way round.
    const bool skew = i.error.not_finite == 0;
    e.parameters.push_back(
        {.name = fmt::format("J{}", i.test.axis),
         .value = i.value,
         .sigma = i.sigma(),
         .low95 = skew ? i.value - i.error.high : i.value - z * i.sigma(),
         .high95 = skew ? i.value - i.error.low : i.value + z * i.sigma(),
         .unit = "kg m^2",
         .status = determined ? estimation::ParameterStatus::kIdentified : estimation::ParameterStatus::kRejected});
    e.fit[fmt::format("J{}.frequency", i.test.axis)] = i.frequency;
    e.fit[fmt::format("J{}.sigma_frequency", i.test.axis)] = i.sigma_frequency;
    if (with_cradle(test)) {
      e.fit[fmt::format("J{}.cradle_frequency", i.test.axis)] = i.cradle_frequency;
      e.fit[fmt::format("J{}.sigma_cradle_frequency", i.test.axis)] = i.sigma_cradle_frequency;
    }
    if (!determined) e.warnings.push_back(i.reason);
  }
  e.covariance = covariance;
  std::vector<std::string> parts;
  if (!found.empty()) parts.push_back(fmt::format("determined: {}", fmt::join(found, ", ")));
  if (!missing.empty()) parts.push_back(fmt::format("not determined: {}", fmt::join(missing, ", ")));
  e.verdict = fmt::format("{}", fmt::join(parts, "; "));
  e.warnings.insert(e.warnings.end(), warnings.begin(), warnings.end());
  return e;
}

}  // namespace

const KeyTable<SwingTest>& SwingTest::keys() {
  using T = SwingTest;
  static const auto table =
      KeyTable<T>("swing_test", "The aircraft hangs, usually in a cradle, and swings about a body axis.")
          .text("name", &T::name, "of the aircraft")
          .number("mass", &T::mass, "kg", kPositive, "of the aircraft alone")
          .required()
          .number("cradle_mass", &T::cradle_mass, "kg", kNotNegative, "of the cradle; 0: it hung without one")
          .number("gravity", &T::gravity, "m/s^2", kPositive, "acceleration of free fall")
          .text("channel", &T::channel, "the recorded angle")
          .otherwise("quaternion `qx, qy, qz, qw`, or `angle`")
          .number("max_relative_sigma", &T::max_relative_sigma, "1", kPositive,
                  "an inertia that is known worse than this is not determined")
          .number("settle", &T::settle_s, "s", kNotNegative, "left out after the largest excursion")
          .number("fade", &T::fade, "1", {.low = 0.0, .high = 1.0, .with_high = false},
                  "what comes after the last swing of this share of the largest is left out")
          .count("draws", &T::draws, 100, 100'000'000, "of the Monte Carlo")
          .table("sigma", std::identity(),
                 KeyTable<T>("sigma", "Standard errors of what was measured by hand.")
                     .number("mass", &T::sigma_mass, "kg", kNotNegative, "of aircraft and cradle, each")
                     .number("filar_distance", &T::sigma_filar_distance, "m", kNotNegative,
                             "of the distance between the lines")
                     .number("length", &T::sigma_length, "m", kNotNegative, "of each length and of the offset"))
          .within("x", axis_keys(), read_axes)
          .check([](const StudyTable& t, T& test) {
            if (test.axes.empty()) t.fail("x", "is missing: the swing test has none of the tables x, y, z");
          });
  return table;
}

SwingAngle swing_angle(const Recording& recording, const std::string& channel) {
  SwingAngle swing;
  const auto take = [&](const Channel& angle) {
    swing.time.assign(angle.times().begin(), angle.times().end());
    swing.angle = angle.value;
    numerics::unwrap_angles(swing.angle);
  };
  if (!channel.empty()) {
    take(recording.at(channel));
    return swing;
  }
  const std::array<const char*, 4> names{"qx", "qy", "qz", "qw"};
  if (std::any_of(names.begin(), names.end(), [&](const char* n) { return !recording.has(n); })) {
    if (const Channel* angle = recording.find("angle")) {
      if (!angle->unit.same_dimension(parse_unit("rad")))
        throw InputError(recording.source, "channel angle has no unit: write angle[deg] or angle[rad] in the header");
      take(*angle);
      return swing;
    }
    throw InputError(
        recording.source,
        fmt::format("holds no swing: neither the quaternion qx, qy, qz, qw nor a channel `angle`; it has {}",
                    fmt::join(recording.names(), ", ")));
  }
  const Channel& first = recording.at("qx");
  std::vector<Eigen::Vector4d> q;
  for (std::size_t i = 0; i < first.size(); ++i) {
    Eigen::Vector4d v;
    for (std::size_t k = 0; k < 4; ++k) v(k) = recording.at(names[k]).value[i];
    if (!v.allFinite() || !(v.norm() > 0.5)) continue;
    swing.time.push_back(first.times()[i]);
    q.push_back(v.normalized());
  }
  if (q.empty()) throw InputError(recording.source, "its quaternion holds no attitude");
  // Mean attitude: the eigenvector of sum q q' (Markley 2007), which is indifferent to the sign of q.
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  for (const Eigen::Vector4d& v : q) A += v * v.transpose();
  const Eigen::Vector4d m = numerics::symmetric_eigen(A).vectors.col(3);
  const Eigen::Quaterniond mean(m(3), m(0), m(1), m(2));
  Eigen::MatrixXd turn(q.size(), 3);
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Eigen::Quaterniond d = mean.conjugate() * Eigen::Quaterniond(q[i](3), q[i](0), q[i](1), q[i](2));
    const double s = d.w() < 0.0 ? -1.0 : 1.0;
    const double n = d.vec().norm();
    const double scale = n > 1e-12 ? 2.0 * std::atan2(n, std::abs(d.w())) / n : 2.0;
    turn.row(i) = s * scale * d.vec().transpose();
  }
  const numerics::SymmetricEigen principal = numerics::symmetric_eigen(turn.transpose() * turn);
  const Eigen::Vector3d axis = principal.vectors.col(2);
  const Eigen::VectorXd angle = turn * axis;
  swing.angle.assign(angle.begin(), angle.end());
  const double all = principal.values.sum();
  swing.principal_share = all > 0.0 ? principal.values(2) / all : 1.0;
  return swing;
}

std::pair<std::size_t, std::size_t> free_swing(const SwingAngle& swing, double settle_s, double fade) {
  const std::size_t n = swing.angle.size();
  if (n == 0) return {0, 0};
  const double rest = numerics::median(swing.angle);
  const auto away = [&](std::size_t i) { return std::abs(swing.angle[i] - rest); };
  std::size_t peak = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (away(i) > away(peak)) peak = i;
  }
  std::size_t begin = peak, end = n;
  while (begin < n && swing.time[begin] < swing.time[peak] + settle_s) ++begin;
  while (end > begin && !(away(end - 1) >= fade * away(peak))) --end;
  return {begin, end};
}

const AxisInertia* SwingTestResult::find(char axis) const {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const AxisInertia& i) { return i.test.axis == axis; });
  return found == axes.end() ? nullptr : &*found;
}

SwingTerms<double> swing_terms(const SwingTest& test, const SwingAxis& axis, double frequency,
                               double cradle_frequency) {
  const Eigen::VectorXd v = values_of(test, axis, frequency, cradle_frequency);
  return terms_of(axis, test.gravity, with_cradle(test), v.data());
}

SwingTestResult analyse_swing_test(const SwingTest& test, Progress& progress) {
  SwingTestResult result;
  for (const SwingAxis& axis : test.axes) {
    progress.stage(fmt::format("fitting the swings about {}", axis.axis));
    result.axes.push_back(analysed(test, axis, progress.threads()));
    for (const SwingRun& run : result.axes.back().runs)
      for (std::string& warning : warnings_of(run)) result.warnings.push_back(std::move(warning));
  }
  result.covariance = covariance_of(test, result.axes);
  if (const std::optional<Excess> excess = excess_of(result.axes, result.covariance)) {
    if (!excess->beyond_error) result.warnings.push_back(excess->text + " (within its error)");
    for (AxisInertia& i : result.axes) {
      if (!excess->beyond_error) break;
      i.verdict = InertiaVerdict::kNotDetermined;
      i.reason += "; " + excess->text;
    }
  }
  result.estimate = estimate_of(test, result.axes, result.covariance, result.warnings);
  return result;
}

std::string inertia_toml(const SwingTest& test, const SwingTestResult& result) {
  std::string text = fmt::format("# Inertia of {} from a swing test, to be copied into its [subject].\n", test.name);
  for (const AxisInertia& i : result.axes) text += fmt::format("# {}\n", i.reason);
  std::vector<std::string> values, sigmas{fmt::format("mass = {}", test.sigma_mass)};
  for (const char axis : {'x', 'y', 'z'}) {
    const AxisInertia* i = result.find(axis);
    if (i == nullptr) {
      text += fmt::format("# J{} was not measured: give it\n", axis);
      continue;
    }
    values.push_back(fmt::format("J{} = {:.6g}", axis, i->value));
    sigmas.push_back(fmt::format("J{} = {:.3g}", axis, i->sigma()));
  }
  text += "# Jxz was not measured: 0 is an assumption; give Jxz and its sigma where they are known\n";
  text += fmt::format("[subject]\nmass = {}\ninertia = {{ {} }}\nsigma = {{ {} }}\n", test.mass,
                      fmt::join(values, ", "), fmt::join(sigmas, ", "));
  return text;
}

}  // namespace veridyn::aircraft
