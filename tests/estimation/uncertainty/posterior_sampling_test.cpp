#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing_support::Column;
using testing_support::Table;

constexpr double kLineNoise = 0.1;

/// Two segments, y = slope t + offset of the segment; or y = exp(-rate t).
class Lines : public AutodiffModel<Lines, 4> {
 public:
  explicit Lines(bool exponential) : exponential_(exponential) {}
  std::span<const ModelParameter> parameters() const override { return parameters_; }
  std::span<const ModelOutput> outputs() const override { return outputs_; }
  std::size_t segments() const override { return 2; }
  Index samples(std::size_t) const override { return 20; }
  std::span<const ModelParameter> initial_conditions(std::size_t) const override { return offset_; }
  template <typename Scalar>
  bool simulate(std::size_t, const Column<Scalar>& theta, Table<Scalar>& y) const {
    using std::exp;
    for (Index k = 0; k < y.rows(); ++k) {
      const double t = 0.05 * static_cast<double>(k);
      y(k, 0) = exponential_ ? Scalar(exp(-theta(0) * t) + theta(2)) : Scalar(theta(0) * t + theta(2));
    }
    return true;
  }
  std::vector<ModelParameter> parameters_{{.name = "slope", .unit = "1/s", .start = 1.0, .prior_sigma = 0.2},
                                          {.name = "none", .unit = "1", .start = 3.0, .fixed = true}};

 private:
  bool exponential_;
  std::vector<ModelOutput> outputs_{{"y", "1"}};
  std::vector<ModelParameter> offset_{{.name = "offset", .unit = "1", .start = 0.0}};
};

std::vector<RowMatrix> recorded(const Lines& model, double slope) {
  std::vector<RowMatrix> measured;
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0.0, kLineNoise);
  for (std::size_t s = 0; s < 2; ++s) {
    ModelResponse response;
    EXPECT_TRUE(model.respond(s, Eigen::Vector3d(slope, 3.0, 0.2 * static_cast<double>(s)), {}, response));
    for (Index k = 0; k < response.output.rows(); ++k) response.output(k, 0) += normal(engine);
    response.output(3, 0) = kNaN;
    measured.push_back(response.output);
  }
  return measured;
}

OutputErrorEstimate estimate_of(const Lines& model, const std::vector<RowMatrix>& measured) {
  return output_error(model, measured,
                      {.noise = OutputNoise::kGiven, .noise_start = VectorXd::Constant(1, kLineNoise)});
}

TEST(PosteriorSampling, OfALinearModelIsItsNormalPosterior) {
  const Lines model(false);
  const std::vector<RowMatrix> measured = recorded(model, 1.3);
  const OutputErrorEstimate e = estimate_of(model, measured);
  ASSERT_TRUE(e.usable()) << e.message;
  Progress progress;
  const PosteriorSample s = sample_posterior(model, measured, e, {.ensemble = {.effective = 4000}}, progress);
  ASSERT_TRUE(s.ensemble.converged) << s.ensemble.message;
  ASSERT_EQ(s.parameters.size(), 1u);  // the fixed one and the offsets are none
  EXPECT_EQ(s.ensemble.draws.cols(), 3);
  const double sigma = std::sqrt(e.covariance_white(0, 0)), error = 4.0 * sigma / std::sqrt(s.ensemble.effective);
  EXPECT_NEAR(s.parameters[0].mean, e.theta(0), error);
  EXPECT_NEAR(s.parameters[0].sd, sigma, error);
  EXPECT_NEAR(s.parameters[0].low, e.theta(0) - 1.96 * sigma, 2.5 * error);
  EXPECT_NEAR(s.parameters[0].high, e.theta(0) + 1.96 * sigma, 2.5 * error);
  // Twice the variance of the noise: the likelihood counts half, the prior as before.
  const PosteriorSample wide =
      sample_posterior(model, measured, e, {.ensemble = {.effective = 4000}, .dispersion = 2.0}, progress);
  const double by_data = 1.0 / (sigma * sigma) - 25.0;
  const double expected = std::sqrt(1.0 / (by_data / 2.0 + 25.0));
  EXPECT_NEAR(wide.parameters[0].sd, expected, 4.0 * expected / std::sqrt(wide.ensemble.effective));
}

TEST(PosteriorSampling, OfABentModelIsThatOfIntegrationOnAGrid) {
  Lines model(true);
  model.parameters_[0].prior_sigma = 3.0;
  model.parameters_[0].low = 0.0;
  model.parameters_[0].high = 20.0;
  const std::vector<RowMatrix> measured = recorded(model, 6.0);
  const OutputErrorEstimate e = estimate_of(model, measured);
  ASSERT_TRUE(e.usable()) << e.message;
  Progress progress;
  const PosteriorSample s = sample_posterior(model, measured, e, {.ensemble = {.effective = 4000}}, progress);
  ASSERT_TRUE(s.ensemble.converged) << s.ensemble.message;
  // The offsets enter linearly: of each the integral over it is a normal one, in closed form.
  double sum = 0.0, first = 0.0, second = 0.0;
  for (double rate = 0.005; rate < 20.0; rate += 0.01) {
    double log_density = -0.5 * std::pow((rate - 1.0) / 3.0, 2);
    for (const RowMatrix& z : measured) {
      double n = 0.0, r = 0.0, r2 = 0.0;
      for (Index k = 0; k < z.rows(); ++k) {
        if (std::isnan(z(k, 0))) continue;
        const double d = z(k, 0) - std::exp(-rate * 0.05 * static_cast<double>(k));
        n += 1.0;
        r += d;
        r2 += d * d;
      }
      log_density -= 0.5 * (r2 - r * r / n) / (kLineNoise * kLineNoise);
    }
    const double density = std::exp(log_density + 20.0);
    sum += density;
    first += density * rate;
    second += density * rate * rate;
  }
  const double mean = first / sum, sd = std::sqrt(second / sum - mean * mean);
  EXPECT_NEAR(s.parameters[0].mean, mean, 4.0 * sd / std::sqrt(s.ensemble.effective));
  EXPECT_NEAR(s.parameters[0].sd, sd, 5.0 * sd / std::sqrt(s.ensemble.effective));
  // The case is bent: a parabola about the estimate would be off by more than that.
  EXPECT_GT(std::abs(mean - e.theta(0)), 4.0 * sd / std::sqrt(s.ensemble.effective));
}

TEST(PosteriorSampling, RefusesBiasesOfOutputsAndUnknownsThatNothingDetermines) {
  Lines model(false);
  const std::vector<RowMatrix> measured = recorded(model, 1.3);
  Progress progress;
  OutputErrorEstimate e = estimate_of(model, measured);
  EXPECT_THROW((void)sample_posterior(model, measured, e, {.dispersion = 0.5}, progress), InputError);
  e.segment_parameters.push_back({0, "bias of y", "1", 0.0});
  EXPECT_THROW((void)sample_posterior(model, measured, e, {}, progress), InputError);
  model.parameters_[1].fixed = false;
  const OutputErrorEstimate open = estimate_of(model, measured);
  EXPECT_THROW((void)sample_posterior(model, measured, open, {}, progress), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
