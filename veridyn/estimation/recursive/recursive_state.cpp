#include "veridyn/estimation/recursive/recursive_state.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kNotInData = 1e-10;  // share (of amplitude) of z below which a vector says nothing of it
constexpr double kNoise = 3.0;        // standard deviations of the largest singular value of noise, about
constexpr double kMoreNoise = 4.0;    // factor on h'Wh that an estimate may need in one step
constexpr double kLargestValue = 1e150;

SmallMatrix error_covariance_of(const RecursiveOptions& options, Eigen::Index parameters,
                                const std::vector<Eigen::Index>& free, const std::vector<Eigen::Index>& pinned,
                                const SmallVector& prior) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(parameters + 1, parameters + 1);
  W(parameters, parameters) = 1.0;
  if (options.method != Method::kOls) W = options.error_covariance;
  // [X, z] P = [X_free, z - X_pinned theta_0]
  const auto count = signed_index(free.size());
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(parameters + 1, count + 1);
  for (Eigen::Index j = 0; j < count; ++j) P(free[j], j) = 1.0;
  P(parameters, count) = 1.0;
  for (const Eigen::Index i : pinned) P(i, count) = -prior(i);
  return P.transpose() * W * P;
}

std::vector<Eigen::Index> indices(const RecursiveOptions& options, Eigen::Index parameters, bool of_pinned) {
  std::vector<Eigen::Index> result;
  for (Eigen::Index i = 0; i < parameters; ++i) {
    const bool pinned = options.method == Method::kPcaGtls && options.prior_weight.size() > 0 &&
                        !std::isfinite(options.prior_weight(i));
    if (pinned == of_pinned) result.push_back(i);
  }
  return result;
}

SmallVector prior_of(const RecursiveOptions& options, Eigen::Index parameters) {
  return options.prior.size() > 0 ? SmallVector(options.prior) : SmallVector(SmallVector::Zero(parameters));
}

}  // namespace

RecursiveRegression::State::State(std::vector<std::string> parameter_names, RecursiveOptions recursive_options)
    : names(std::move(parameter_names)),
      options(std::move(recursive_options)),
      free(indices(options, names.size(), false)),
      pinned(indices(options, names.size(), true)),
      prior(prior_of(options, names.size())),
      W(error_covariance_of(options, names.size(), free, pinned, prior)),
      forgets(options.forgetting.lambda < 1.0 || options.forgetting.variable),
      data(W),
      variable(options.forgetting, free.size()) {
  const Eigen::Index n = count();
  free_weight = SmallVector::Ones(n);
  free_theta.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Index i = free[j];
    free_theta(j) = prior(i);
    if (options.method == Method::kPcaGtls && options.prior_weight.size() > 0) free_weight(j) = options.prior_weight(i);
  }
  theta = prior;
  squares = SmallMatrix::Zero(n, n);
  column_sums = column_squares = SmallVector::Zero(n);
  scores.reset(n, options.block);
  h.resize(n + 1);
  h << free_theta, -1.0;
  W_h = W.lazyProduct(h);
  h_W_h = h.dot(W_h);
  unexcited.resize(n, 0);
  const auto all = signed_index(names.size());
  unexcited_combinations.resize(all, 0);
  unexcited_share = SmallVector::Zero(all);
  if (options.method != Method::kOls) singular_values = SmallVector::Zero(data.noisy_columns());
}

void RecursiveRegression::State::start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows_behind,
                                       double residual_sd) {
  const Eigen::Index n = count();
  Eigen::MatrixXd P(n, n);
  Eigen::VectorXd start_theta(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    start_theta(j) = theta_0(free[j]);
    for (Eigen::Index i = 0; i < n; ++i) P(i, j) = P_0(free[i], free[j]);
  }
  const Eigen::VectorXd sd = P.diagonal().cwiseSqrt();
  Eigen::MatrixXd correlation = P;
  if ((P.diagonal().array() > 0.0).all())
    correlation = sd.cwiseInverse().asDiagonal() * P * sd.cwiseInverse().asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(correlation);
  if (!(P.diagonal().array() > 0.0).all() || cholesky.info() != Eigen::Success) {
    throw InputError("recursive.start", "P_0 is not positive definite; must be the covariance of a usable estimate");
  }
  free_theta = start_theta;
  h.head(n) = free_theta;
  W_h = W.lazyProduct(h);
  h_W_h = h.dot(W_h);
  const double c_0 = residual_sd > 0.0 ? residual_sd : std::sqrt(h_W_h);
  // Rows c_0 L^-1 diag(1/sd) with P = diag(sd) L L' diag(sd).
  const Eigen::MatrixXd scaled = sd.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd root = c_0 * cholesky.matrixL().solve(scaled);
  internal::RecursiveRow row{};
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) row[j] = root(i, j);
    row[n] = root.row(i).dot(start_theta);
    if (!data.append(row.data(), 1.0))
      throw InputError("recursive.start", "P_0 is too small or theta_0 too large for a computation");
  }
  const auto prior_count = static_cast<double>(n);
  prior_rows = rows_behind > 0.0 ? rows_behind : prior_count;
  // The rows behind the estimate also held errors.
  if (prior_rows > prior_count) data.append_errors((prior_rows - prior_count) * c_0 * c_0 / h_W_h);
  samples = squared_weights = prior_rows;
  const Eigen::MatrixXd information = root.transpose() * root;
  squares = information;
  scores.start(c_0 * c_0 * information, information, prior_rows);
  for (Eigen::Index j = 0; j < n; ++j) theta(free[j]) = free_theta(j);
  solve();
  most_excited = excited_directions;
}

void RecursiveRegression::State::set_equation_error(double variance) {
  const Eigen::Index n = count();
  options.error_covariance.bottomRightCorner<1, 1>()(0, 0) += variance - equation_error;
  W(n, n) += variance - equation_error;
  equation_error = variance;
  // The rows so far, whitened by the new W: all that is kept of them is D'D.
  SmallMatrix A;
  data.square_root(A);
  data = RecursiveTotalLeastSquares(W);
  internal::RecursiveRow row{};
  for (Eigen::Index i = 0; i <= n; ++i) {
    for (Eigen::Index j = 0; j <= n; ++j) row[j] = A(i, j);
    (void)data.append(row.data(), 1.0);
  }
  W_h = W.lazyProduct(h);
  h_W_h = h.dot(W_h);
  solve();
}

RecursiveUpdate RecursiveRegression::State::update(std::span<const double> x, double z) {
  VERIDYN_ASSERT(x.size() == names.size());
  RecursiveUpdate result;
  result.innovation = result.innovation_sigma = kNaN;
  internal::RecursiveRow row{};
  if (!take_row(x, z, row)) {
    ++refused;
    return result;
  }
  const Eigen::Index n = count();
  double predicted = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) predicted += row[j] * free_theta(j);
  result.innovation = row[n] - predicted;
  result.lambda = options.forgetting.square_weight();
  if (termination == EstimateTermination::kEstimated)
    score_row(row, result);
  else
    scores.forget(result.lambda);
  const double lambda = result.lambda;
  (void)data.append(row.data(), lambda);
  column_weight = lambda * column_weight + 1.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double value = row[j];
    column_sums(j) = lambda * column_sums(j) + value;
    column_squares(j) = lambda * column_squares(j) + value * value;
  }
  if (forgets) {
    const double square = lambda * lambda;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = 0; i <= j; ++i) {
        squares(i, j) = square * squares(i, j) + row[i] * row[j];
      }
    }
  }
  samples = lambda * samples + 1.0;
  squared_weights = lambda * lambda * squared_weights + 1.0;
  ++rows;
  result.accepted = true;
  solve();
  if (options.method == Method::kPcaGtls && excited_directions > most_excited) {
    // Until now innovations held the error of a parameter that was not known.
    most_excited = excited_directions;
    scores.restart();
  }
  return result;
}

bool RecursiveRegression::State::take_row(std::span<const double> x, double z, internal::RecursiveRow& row) const {
  const Eigen::Index n = count();
  bool good = std::abs(z) <= kLargestValue;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double value = x[free[j]];
    row[j] = value;
    good = good && std::abs(value) <= kLargestValue;
  }
  double regressand = z;
  for (const Eigen::Index i : pinned) {
    good = good && std::abs(x[i]) <= kLargestValue;
    regressand -= x[i] * prior(i);
  }
  row[n] = regressand;
  return good && data.accepts(row.data());
}

void RecursiveRegression::State::score_row(const internal::RecursiveRow& row, RecursiveUpdate& result) {
  const Eigen::Index n = count();
  const double innovation = result.innovation;
  // Maximum-likelihood regressor, and q = x_hat M^-1 x_hat' from S and V of the excited part; d_hat h = 0.
  internal::RecursiveRow d_hat{}, along{}, along_exact{};
  const double slope = innovation / h_W_h;
  double fitted = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    d_hat[j] = row[j] + slope * W_h(j);
    fitted += d_hat[j] * free_theta(j);
  }
  d_hat[n] = fitted;
  data.coordinates(d_hat.data(), along.data(), along_exact.data());
  double q = 0.0;
  for (int i = 0; i < data.exact_rank(); ++i) q += along_exact[i] * along_exact[i];
  const int last = data.noisy_columns() - 1;
  const double smallest = data.singular_value(last);
  const int excited = options.method == Method::kPcaGtls ? excited_noisy : last;
  for (int j = 0; j < excited; ++j) {
    const double s = data.singular_value(j);
    const double f = along[j];
    q += f * f / ((s - smallest) * (s + smallest));
  }
  if (!(q < 1e300)) q = 1e300;
  if (residual_variance >= 0.0)
    result.innovation_sigma = std::sqrt(residual_variance * (1.0 + q * squared_weights / samples));
  if (options.forgetting.variable) result.lambda = variable.update(innovation, q);
  result.triggered = options.forgetting.variable && variable.triggered();
  // A recursive residual e/sqrt(1 + q) has the variance of the error (Brown, Durbin & Evans 1975).
  SmallVector score(n);
  const double residual = innovation / std::sqrt(1.0 + q);
  for (Eigen::Index j = 0; j < n; ++j) score(j) = d_hat[j] * residual;
  scores.add(d_hat.data(), score, result.lambda);
}

void RecursiveRegression::State::solve() {
  const Eigen::Index n = count();
  const int w = data.noisy_columns();
  const double freedom = std::max(1.0, samples - static_cast<double>(n));
  const double smallest = data.singular_value(w - 1);
  white_bars.fresh = autocorrelated_bars.fresh = false;
  scale = smallest * smallest / freedom;
  // Rows of pure noise have singular values up to sqrt(N) + sqrt(w), which matters while there are few.
  threshold = std::max((options.signal_to_noise + 1.0) * std::sqrt(freedom),
                       std::sqrt(samples) + std::sqrt(static_cast<double>(w)) + kNoise);
  if (!options.error_scale_known) threshold *= std::sqrt(scale);
  excited_noisy = 0;
  while (excited_noisy < w - 1 && data.singular_value(excited_noisy) > threshold) ++excited_noisy;
  for (Eigen::Index j = 0; j < singular_values.size(); ++j)
    singular_values(j) = data.singular_value(static_cast<int>(j));

  if (!(static_cast<double>(rows) + prior_rows > static_cast<double>(n))) {
    termination = EstimateTermination::kTooFewRows;
    excited_directions = 0;
    return;
  }
  bool solved = false;
  if (options.method == Method::kPcaGtls) {
    // A direction of misfit exceeds the noise as one of signal does; taken for signal, it leaves z to directions that
    // hold no information on it, and theta diverges along those. Such an estimate needs larger errors of the rows
    // (h'Wh) than the one before and explains them worse: then the weakest direction is not taken for excited.
    const SmallVector before = free_theta;
    const double power_before = data.power(h.data()), noise_before = h_W_h;
    for (;; --excited_noisy) {
      solved = solve_excited(excited_noisy);
      if (!solved || excited_noisy == 0) break;
      double noise = 0.0;
      h.head(n) = free_theta;
      for (Eigen::Index j = 0; j <= n; ++j) {
        double value = 0.0;
        for (Eigen::Index i = 0; i <= n; ++i) value += W(i, j) * h(i);
        noise += value * h(j);
      }
      if (noise <= kMoreNoise * noise_before || data.power(h.data()) <= power_before) break;
      free_theta = before;
      h.head(n) = before;
    }
  } else {
    solved = data.null_columns() == 0 && solve_least();
    excited_directions = options.method == Method::kOls ? data.exact_rank() : data.exact_rank() + excited_noisy;
  }
  termination =
      solved ? EstimateTermination::kEstimated
             : (options.method != Method::kPcaGtls && data.null_columns() > 0 ? EstimateTermination::kRankDeficient
                                                                              : EstimateTermination::kNongeneric);
  if (!solved) return;
  h.head(n) = free_theta;
  for (Eigen::Index i = 0; i <= n; ++i) {
    double value = 0.0;
    for (Eigen::Index j = 0; j <= n; ++j) value += W(j, i) * h(j);
    W_h(i) = value;
  }
  h_W_h = h.dot(W_h);
  residual_variance = samples > static_cast<double>(n) ? data.power(h.data()) / freedom : -1.0;
  for (Eigen::Index j = 0; j < n; ++j) theta(free[j]) = free_theta(j);
}

// OLS and GTLS: the vector of the smallest singular value. False, and theta stays, where there is none for z.
bool RecursiveRegression::State::solve_least() {
  const Eigen::Index n = count();
  const int last = data.noisy_columns() - 1;
  if (last > 0) {
    const double next = data.singular_value(last - 1);
    if (!(next - data.singular_value(last) > 1e-12 * next)) return false;
  }
  internal::RecursiveRow b;
  data.basis(last, b.data());
  if (!(data.share_of_last(b.data()) > kNotInData * kNotInData)) return false;
  const double factor = -1.0 / b[n];
  double largest = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) largest = std::max(largest, std::abs(b[j] * factor));
  if (!(largest < std::numeric_limits<double>::max())) return false;
  for (Eigen::Index j = 0; j < n; ++j) free_theta(j) = b[j] * factor;
  return true;
}

// PCA-GTLS: nearest to the estimate before, in |U (theta - theta_0)|, of what the excited directions allow.
bool RecursiveRegression::State::solve_excited(int excited) {
  const Eigen::Index n = count();
  const int w = data.noisy_columns();
  const int dimension = w - excited + data.null_columns();
  if (dimension == 1) {
    if (!solve_least()) return false;
    excited_directions = n;
    if (unexcited.cols() > 0) {
      unexcited.resize(n, 0);
      unexcited_combinations.resize(names.size(), 0);
      unexcited_share.setZero();
    }
    return true;
  }
  // All h that the data allow: combinations of these columns with h_z = -1.
  SmallMatrix allowed = SmallMatrix::Zero(n + 1, dimension);
  int pivot = 0;
  for (int j = 0; j < dimension; ++j) {
    double* b = allowed.col(j).data();
    if (j < w - excited) {
      data.basis(excited + j, b);
    } else {
      data.null_basis(j - (w - excited), b);
    }
    double length = b[n] * b[n];
    for (Eigen::Index i = 0; i < n; ++i) length += (free_weight(i) * b[i]) * (free_weight(i) * b[i]);
    length = std::sqrt(length);
    if (!(length > 0.0) || !(length < 1e300)) return false;
    allowed.col(j) *= 1.0 / length;
    if (std::abs(allowed(n, j)) > std::abs(allowed(n, pivot))) pivot = j;
  }
  const double pivot_z = allowed(n, pivot);
  if (!(std::abs(pivot_z) > kNotInData)) return false;
  SmallVector offset(n);
  for (Eigen::Index i = 0; i < n; ++i) offset(i) = free_weight(i) * (-allowed(i, pivot) / pivot_z - free_theta(i));
  // Moves of theta that do not show, orthonormal in U coordinates (Gram-Schmidt, twice).
  unexcited.resize(n, dimension - 1);
  int moves = 0;
  for (int j = 0; j < dimension; ++j) {
    if (j == pivot) continue;
    auto move = unexcited.col(moves);
    const double ratio = allowed(n, j) / pivot_z;
    for (Eigen::Index i = 0; i < n; ++i) move(i) = free_weight(i) * (allowed(i, j) - ratio * allowed(i, pivot));
    const double before = move.norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k < moves; ++k) move -= unexcited.col(k).dot(move) * unexcited.col(k);
    }
    const double length = move.norm();
    if (!(length > 1e-13 * before)) continue;
    move *= 1.0 / length;
    ++moves;
  }
  unexcited.conservativeResize(n, moves);
  for (int k = 0; k < moves; ++k) offset -= unexcited.col(k).dot(offset) * unexcited.col(k);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(offset(i))) return false;
  }
  for (Eigen::Index i = 0; i < n; ++i) free_theta(i) += offset(i) / free_weight(i);
  excited_directions = n - moves;

  unexcited_combinations.setZero(names.size(), moves);
  unexcited_share.setZero();
  for (int k = 0; k < moves; ++k) {
    double power = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index full = free[i];
      unexcited_combinations(full, k) = unexcited(i, k) / free_weight(i);
      power += unexcited_combinations(full, k) * unexcited_combinations(full, k);
      unexcited_share(full) = std::min(1.0, unexcited_share(full) + unexcited(i, k) * unexcited(i, k));
    }
    unexcited_combinations.col(k) *= 1.0 / std::sqrt(power);
  }
  return true;
}

}  // namespace veridyn::estimation
