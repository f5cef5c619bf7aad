// Noise on the regressors biases least squares; generalised total least squares takes it into account.
//
// The yawing moment of an aircraft, Cn = Cn_0 + Cn_beta beta + Cn_r r_n, is estimated from a noisy vane and a noisy
// gyro. More data do not cure the bias of ordinary least squares: it pulls the estimates towards zero.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "picture.hpp"
#include "veridyn/estimation.hpp"
#include "veridyn/numerics.hpp"

int main() {
  using namespace veridyn;
  constexpr Eigen::Index kRows = 5000;
  const Eigen::Vector3d truth(0.0, 0.25, -1.0);
  const double sigma_beta = 0.012, sigma_r = 0.0025, sigma_z = 0.0005;

  numerics::RandomStream noise(1, "example");  // same seed and name, same numbers everywhere
  estimation::RegressionData data;
  data.regressors.resize(kRows, 3);
  data.regressand.resize(kRows);
  data.parameter_names = {"Cn_0", "Cn_beta", "Cn_r"};
  data.parameter_units = {"1", "1/rad", "1"};
  data.regressand_name = "Cn";
  for (Eigen::Index k = 0; k < kRows; ++k) {
    const double beta = 0.03 * noise.normal();
    const double r_n = 0.006 * noise.normal();
    data.regressand(k) = truth(0) + truth(1) * beta + truth(2) * r_n + sigma_z * noise.normal();
    data.regressors.row(k) << 1.0, beta + sigma_beta * noise.normal(), r_n + sigma_r * noise.normal();
  }
  // How wrong each column of [x, z] is. The constant is exact: its row and column stay zero.
  data.error_covariance =
      Eigen::Vector4d(0.0, sigma_beta * sigma_beta, sigma_r * sigma_r, sigma_z * sigma_z).asDiagonal();

  const estimation::RegressionComparison comparison = estimation::compare(data);
  std::vector<std::string> labels;
  std::vector<double> value, low, high, true_value;
  std::printf("%-10s %22s %22s\n", "", "Cn_beta (true 0.25)", "Cn_r (true -1)");
  for (const estimation::RegressionEstimate& e : comparison.estimates) {
    if (!e.usable()) continue;
    std::printf("%-10s %12.4f +- %.4f %15.4f +- %.4f\n", std::string(estimation::to_string(e.method)).c_str(),
                e.parameters[1].value, 1.96 * e.parameters[1].sigma, e.parameters[2].value,
                1.96 * e.parameters[2].sigma);
    for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
      labels.push_back(e.parameters[i].name + " by " + std::string(estimation::to_string(e.method)));
      value.push_back(e.parameters[i].value);
      low.push_back(e.parameters[i].low95);
      high.push_back(e.parameters[i].high95);
      true_value.push_back(truth(static_cast<Eigen::Index>(i)));
    }
  }
  picture::write("02_regression.csv", {{"value", value}, {"low", low}, {"high", high}, {"true", true_value}}, labels);
  std::printf("recommended: %s\n", comparison.reason.c_str());

  const auto* ols = comparison.find(estimation::Method::kOls);
  const auto* gtls = comparison.find(estimation::Method::kGtls);
  const auto sigmas_off = [&](const estimation::RegressionEstimate& e, Eigen::Index i) {
    return std::abs(e.theta(i) - truth(i)) / e.parameters[static_cast<std::size_t>(i)].sigma;
  };
  const bool as_expected = sigmas_off(*ols, 1) > 10.0 && sigmas_off(*gtls, 1) < 4.0 && sigmas_off(*gtls, 2) < 4.0;
  return as_expected ? 0 : 1;
}
