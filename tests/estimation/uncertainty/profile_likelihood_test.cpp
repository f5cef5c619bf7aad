#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <random>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing_support::Column;
using testing_support::Static;
using testing_support::Table;

constexpr double kNoise = 0.1;

/// y_k = f(theta, k/20).
template <typename Function>
class Curve : public AutodiffModel<Curve<Function>, 4> {
 public:
  Curve(std::vector<ModelParameter> unknowns, Index samples) : unknowns_(std::move(unknowns)), samples_(samples) {}
  std::span<const ModelParameter> parameters() const override { return unknowns_; }
  std::span<const ModelOutput> outputs() const override { return outputs_; }
  std::size_t segments() const override { return 1; }
  Index samples(std::size_t) const override { return samples_; }
  std::span<const ModelParameter> initial_conditions(std::size_t) const override { return {}; }
  template <typename Scalar>
  bool simulate(std::size_t, const Column<Scalar>& theta, Table<Scalar>& y) const {
    for (Index k = 0; k < y.rows(); ++k) y(k, 0) = Function()(theta, 0.05 * static_cast<double>(k));
    return true;
  }

 private:
  std::vector<ModelParameter> unknowns_;
  Index samples_;
  std::vector<ModelOutput> outputs_{{"y", "1"}};
};

struct Decay {
  template <typename Scalar>
  Scalar operator()(const Column<Scalar>& theta, double t) const {
    using std::exp;
    return exp(-theta(0) * t);
  }
};
/// a and b only as their product.
struct Product {
  template <typename Scalar>
  Scalar operator()(const Column<Scalar>& theta, double t) const {
    return theta(0) * theta(1) * std::sin(3.0 * t) + theta(2);
  }
};

RowMatrix noisy(const ParametricModel& model, const VectorXd& truth, unsigned seed) {
  ModelResponse response;
  EXPECT_TRUE(model.respond(0, truth, {}, response));
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, kNoise);
  for (Index k = 0; k < response.output.rows(); ++k)
    for (Index j = 0; j < response.output.cols(); ++j) response.output(k, j) += normal(engine);
  return response.output;
}

OutputErrorOptions given_noise(Index outputs) {
  OutputErrorOptions o;
  o.noise = OutputNoise::kGiven;
  o.noise_start = VectorXd::Constant(outputs, kNoise);
  return o;
}

/// The value beyond `from` (towards `to`) where f crosses `level`.
double crossing(const std::function<double(double)>& f, double level, double from, double to) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (from + to);
    (f(middle) < level ? from : to) = middle;
  }
  return from;
}

class Threads : public Progress {
 public:
  explicit Threads(int threads, bool interrupted = false) : threads_(threads), interrupted_(interrupted) {}
  [[nodiscard]] int threads() const override { return threads_; }
  [[nodiscard]] bool interrupted() const override { return interrupted_; }

 private:
  int threads_;
  bool interrupted_;
};

TEST(ProfileLikelihood, OfALinearModelIsTheIntervalOfItsErrorBar) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  RowMatrix X(80, 3);
  for (Index i = 0; i < X.size(); ++i) X.data()[i] = normal(engine);
  X.col(2) += 0.9 * X.col(1);
  Static model({{X}});
  model.unknowns[1].prior_sigma = 0.02;
  const std::vector<RowMatrix> measured{noisy(model, Eigen::Vector3d(1.0, 0.1, -2.0), 3)};
  const OutputErrorOptions o = given_noise(1);
  const OutputErrorEstimate e = output_error(model, measured, o);
  // The normal equations.
  Eigen::MatrixXd information = X.transpose() * X / (kNoise * kNoise);
  information(1, 1) += 1.0 / (0.02 * 0.02);
  const Eigen::MatrixXd covariance = information.inverse();
  const VectorXd best = covariance * (X.transpose() * measured[0].col(0)) / (kNoise * kNoise);
  Progress progress;
  for (const double dispersion : {1.0, 2.25}) {
    const ProfileResult r =
        profile_likelihood(model, measured, e, {0, 1, 2}, {.output_error = o, .dispersion = dispersion}, progress);
    ASSERT_TRUE(r.usable()) << r.message;
    EXPECT_NEAR(r.threshold, 3.841458820694124, 1e-9);
    ASSERT_EQ(r.profiles.size(), 3u);
    for (const ParameterProfile& p : r.profiles) {
      const auto i = static_cast<Index>(p.parameter);
      const double sigma = std::sqrt(dispersion * covariance(i, i));
      EXPECT_EQ(p.low_end, ProfileEnd::kClosed);
      EXPECT_EQ(p.high_end, ProfileEnd::kClosed);
      EXPECT_NEAR(p.low, best(i) - 1.959963984540054 * sigma, 1e-6 * sigma);
      EXPECT_NEAR(p.high, best(i) + 1.959963984540054 * sigma, 1e-6 * sigma);
      for (const ProfilePoint& q : p.points) EXPECT_NEAR(q.statistic, std::pow((q.value - best(i)) / sigma, 2), 1e-6);
    }
    EXPECT_LE(r.fits, 1 + 3 * 2 * 3);
  }
}

TEST(ProfileLikelihood, IsWiderByTheInflationOfEachParameter) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  RowMatrix X(60, 2);
  for (Index i = 0; i < X.size(); ++i) X.data()[i] = normal(engine);
  const Static model({{X}});
  const std::vector<RowMatrix> measured{noisy(model, Eigen::Vector2d(1.0, -1.0), 3)};
  const OutputErrorOptions o = given_noise(1);
  const OutputErrorEstimate e = output_error(model, measured, o);
  Progress progress;
  const ProfileResult r =
      profile_likelihood(model, measured, e, {0, 1}, {.output_error = o, .inflation = {4.0, 1.0}}, progress);
  ASSERT_TRUE(r.usable()) << r.message;
  for (const std::size_t i : {0u, 1u}) {
    const double sigma = std::sqrt(e.covariance_white(i, i));
    EXPECT_NEAR(r.profiles[i].high - r.profiles[i].low, 2.0 * 1.959963984540054 * sigma * (i == 0 ? 2.0 : 1.0),
                1e-6 * sigma);
  }
  EXPECT_THROW(
      static_cast<void>(profile_likelihood(model, measured, e, {0}, {.output_error = o, .inflation = {1.0}}, progress)),
      InputError);
  EXPECT_THROW(static_cast<void>(
                   profile_likelihood(model, measured, e, {0}, {.output_error = o, .inflation = {0.5, 1.0}}, progress)),
               InputError);
}

// The profile of an only parameter is its likelihood, here in closed form.
TEST(ProfileLikelihood, OfAnOnlyParameterIsItsLikelihood) {
  const Curve<Decay> model({{.name = "a", .start = 1.0, .low = 0.0, .high = 10.0}}, 12);
  const std::vector<RowMatrix> measured{noisy(model, VectorXd::Constant(1, 2.0), 5)};
  const auto squares = [&](double a) {
    double sum = 0.0;
    for (Index k = 0; k < 12; ++k) sum += std::pow(measured[0](k, 0) - std::exp(-a * 0.05 * static_cast<double>(k)), 2);
    return sum;
  };
  for (const bool known : {true, false}) {
    const OutputErrorOptions o = known ? given_noise(1) : OutputErrorOptions();
    const OutputErrorEstimate e = output_error(model, measured, o);
    Progress progress;
    const ProfileResult r = profile_likelihood(model, measured, e, {0}, {.output_error = o}, progress);
    ASSERT_TRUE(r.usable());
    const double best = r.profiles[0].value;
    // With R fitted, 2 J = N ln(RSS) up to a constant.
    const auto statistic = [&](double a) {
      return known ? (squares(a) - squares(best)) / (kNoise * kNoise) : 12.0 * std::log(squares(a) / squares(best));
    };
    const double low = crossing(statistic, r.threshold, best, 0.0), high = crossing(statistic, r.threshold, best, 10.0);
    EXPECT_NEAR(r.profiles[0].low, low, 1e-3 * (high - low));
    EXPECT_NEAR(r.profiles[0].high, high, 1e-3 * (high - low));
    // No parabola: the interval is longer upwards.
    EXPECT_GT(high - best, 1.05 * (best - low));
    for (const ProfilePoint& q : r.profiles[0].points) EXPECT_NEAR(q.statistic, statistic(q.value), 1e-4);
  }
}

TEST(ProfileLikelihood, OfFactorsOfAProductIsOpenAsFarAsTheirBoundsLeaveIt) {
  const std::vector<ModelParameter> wide{{.name = "a", .start = 1.0, .low = 0.5, .high = 2.0},
                                         {.name = "b", .start = 1.0, .low = 0.5, .high = 2.0},
                                         {.name = "c", .start = 0.0, .low = -1.0, .high = 1.0}};
  std::vector<ModelParameter> narrow = wide;
  narrow[1].high = 1.2;
  const OutputErrorOptions o = given_noise(1);
  Progress progress;
  for (const bool all : {true, false}) {
    const Curve<Product> model(all ? wide : narrow, 100);
    const std::vector<RowMatrix> measured{noisy(model, Eigen::Vector3d(1.0, 1.0, 0.2), 11)};
    const OutputErrorEstimate e = output_error(model, measured, o);
    ASSERT_FALSE(e.unidentifiable.empty());
    const ProfileResult r = profile_likelihood(model, measured, e, {0, 1, 2}, {.output_error = o}, progress);
    ASSERT_TRUE(r.usable());
    const ParameterProfile &a = r.profiles[0], &b = r.profiles[1], &c = r.profiles[2];
    EXPECT_EQ(a.high_end, ProfileEnd::kOpen);
    EXPECT_TRUE(std::isnan(a.high));
    EXPECT_EQ(b.low_end, ProfileEnd::kOpen);
    EXPECT_EQ(c.low_end, ProfileEnd::kClosed);
    EXPECT_EQ(c.high_end, ProfileEnd::kClosed);
    EXPECT_THAT(a.text(), ::testing::HasSubstr("open above"));
    if (all) {
      EXPECT_EQ(a.low_end, ProfileEnd::kOpen);
      EXPECT_EQ(b.high_end, ProfileEnd::kOpen);
      continue;
    }
    // b stops at 1.2, so a may not fall much below 1/1.2 of the product.
    EXPECT_EQ(a.low_end, ProfileEnd::kClosed);
    EXPECT_NEAR(a.low, e.theta(0) * e.theta(1) / 1.2, 0.05);
    EXPECT_EQ(b.high_end, ProfileEnd::kOpen);
  }
}

TEST(ProfileLikelihood, HasTheSameBitsOnAnyNumberOfThreadsAndStopsWhenAsked) {
  const Curve<Product> model({{.name = "a", .start = 1.0, .low = 0.1, .high = 9.0},
                              {.name = "b", .start = 1.0, .low = 0.1, .high = 9.0, .prior_sigma = 0.1},
                              {.name = "c", .start = 0.0, .fixed = true}},
                             60);
  const std::vector<RowMatrix> measured{noisy(model, Eigen::Vector3d(1.2, 1.0, 0.0), 2)};
  const OutputErrorOptions o = given_noise(1);
  const OutputErrorEstimate e = output_error(model, measured, o);
  Threads one(1), four(4), stopped(2, true);
  const ProfileResult r = profile_likelihood(model, measured, e, {0, 1}, {.output_error = o}, one);
  const ProfileResult s = profile_likelihood(model, measured, e, {0, 1}, {.output_error = o}, four);
  ASSERT_TRUE(r.usable());
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(r.profiles[k].low, s.profiles[k].low);
    EXPECT_EQ(r.profiles[k].high, s.profiles[k].high);
    ASSERT_EQ(r.profiles[k].points.size(), s.profiles[k].points.size());
    for (std::size_t i = 0; i < r.profiles[k].points.size(); ++i)
      EXPECT_EQ(r.profiles[k].points[i].statistic, s.profiles[k].points[i].statistic);
  }
  // a b is known to a few percent, b by its prior to 10 %: so is a, and by more upwards than downwards.
  const ParameterProfile& a = r.profiles[0];
  EXPECT_NEAR(a.high - a.low, 2.0 * 1.96 * 0.12, 0.08);
  EXPECT_GT(a.high - a.value, a.value - a.low);
  EXPECT_TRUE(profile_likelihood(model, measured, e, {0}, {.output_error = o}, stopped).interrupted);
  EXPECT_THROW(static_cast<void>(profile_likelihood(model, measured, e, {2}, {.output_error = o}, one)), InputError);
  EXPECT_THROW(
      static_cast<void>(profile_likelihood(model, measured, e, {0}, {.confidence = 1.0, .output_error = o}, one)),
      InputError);
  EXPECT_THROW(
      static_cast<void>(profile_likelihood(model, measured, e, {0}, {.output_error = o, .dispersion = 0.5}, one)),
      InputError);
}

}  // namespace
}  // namespace veridyn::estimation
