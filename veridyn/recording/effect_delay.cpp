// Delays of causes against their effects: effect_delay and common_effect_delay of delays.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/recording/delays.hpp"

namespace veridyn::recording {
namespace {

/// Rows that the search looks at: five minutes at 100 Hz are plenty.
constexpr std::size_t kMostRows = 30000;
/// Share of the effect that must be explained, and how much of that by the cause: never less than what is left.
constexpr double kLeastExplained = 0.3;
constexpr double kLeastByCause = 0.05;
/// What the cause must explain for a delay in doubt to be told.
constexpr double kLeastInDoubt = 0.2;
/// Standard errors by which a delay must explain more than none. What few manoeuvres show scatters between parts.
constexpr double kBetterThanNone = 2.0;
/// Parts of the recording that the jackknife leaves out in turn.
constexpr std::size_t kParts = 10;

/// Products of the columns [1, explanatory ..., effect] with each other, summed over one part of the recording.
struct PartialSums {
  Eigen::MatrixXd products;

  explicit PartialSums(Eigen::Index columns) : products(Eigen::MatrixXd::Zero(columns, columns)) {}
  /// `noise` are the variances of the columns' noise, which is taken off their power.
  [[nodiscard]] double share_explained(const Eigen::VectorXd& noise) const {
    const Eigen::Index last = products.cols() - 1;
    const double count = products(0, 0), sum = products(0, last), squares = products(last, last);
    const double total = squares - sum * sum / std::max(1.0, count);
    if (!(count > 100.0) || !(total > 0.0)) return 0.0;
    Eigen::MatrixXd signal = products.topLeftCorner(last, last);
    // At least half of it is signal, or the noise is not what it was taken for.
    const Eigen::VectorXd power = signal.diagonal();
    signal.diagonal() = (power - count * noise).cwiseMax(0.5 * power);
    const Eigen::VectorXd right = products.col(last).head(last);
    return 1.0 - (squares - right.dot(numerics::shortest_least_squares(signal, right))) / total;
  }
};

/// View of a signal as a column of `sums_at`: the signal `lag` samples before; null: 1.
struct Column {
  const std::vector<double>* signal = nullptr;
  long lag = 0;
};

std::vector<Column> columns_at(const DelayedEffect& e, long lag, bool with_causes) {
  std::vector<Column> columns{{}};
  for (const Explanatory& other : e.others) columns.push_back({&other.value, 0});
  for (const Explanatory& late : e.late_others) columns.push_back({&late.value, lag});
  if (with_causes)
    for (const Explanatory& cause : e.causes) columns.push_back({&cause.value, lag});
  columns.push_back({&e.effect, 0});
  return columns;
}

/// Rows of one of the kParts parts of a recording of `n` samples that have a sample `lag` before: from begin to end.
struct RowRange {
  long begin = 0, end = 0;
};
RowRange rows_of(long part, long n, long lag) {
  const auto parts = static_cast<long>(kParts);
  return {std::max((part * n + parts - 1) / parts, std::max(0L, lag)),
          std::min(((part + 1) * n + parts - 1) / parts, n + std::min(0L, lag))};
}

/// Of a regression of the effect on a constant, the others, and what is late and the causes (or no causes) `lag`
/// samples before, part by part.
std::vector<PartialSums> sums_at(const DelayedEffect& e, long lag, bool with_causes) {
  constexpr long kBlock = 256;
  const auto n = static_cast<long>(e.effect.size());
  const long stride = std::max<long>(1, n / static_cast<long>(kMostRows));
  const std::vector<Column> columns = columns_at(e, lag, with_causes);
  const auto width = static_cast<Eigen::Index>(columns.size());
  std::vector<PartialSums> sums(kParts, PartialSums(width));
  Eigen::MatrixXd block(kBlock, width);
  using Strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  for (long part = 0; part < static_cast<long>(kParts); ++part) {
    const auto [begin, end] = rows_of(part, n, lag);
    for (long k = (begin + stride - 1) / stride * stride; k < end; k += kBlock * stride) {
      const long rows = std::min(kBlock, (end - k + stride - 1) / stride);
      auto filled = block.topRows(rows);
      for (Eigen::Index j = 0; j < width; ++j) {
        const Column& column = columns[static_cast<std::size_t>(j)];
        if (column.signal == nullptr)
          filled.col(j).setOnes();
        else
          filled.col(j) = Strided(column.signal->data() + (k - column.lag), rows, Eigen::InnerStride<>(stride));
      }
      // A row without one of its values counts nothing.
      const Eigen::VectorXd total = filled.rowwise().sum();
      for (long i = 0; i < rows; ++i)
        if (!std::isfinite(total(i))) filled.row(i).setZero();
      block.bottomRows(kBlock - rows).setZero();
      sums[static_cast<std::size_t>(part)].products += numerics::transposed_product(block, block);
    }
  }
  return sums;
}

/// `sums_at` for every lag of signals without gaps: only products of what moves with what does not are computed for
/// each of them, the others are differences of running sums.
class SumsWithoutGaps {
 public:
  /// Nothing where a value is missing, or rows are left out.
  static std::optional<SumsWithoutGaps> of(const DelayedEffect& e) {
    if (e.effect.size() >= 2 * kMostRows) return std::nullopt;
    const auto complete = [](const std::vector<double>& x) {
      return std::ranges::all_of(x, [](double v) { return std::isfinite(v); });
    };
    const auto all = [&](const std::vector<Explanatory>& list) {
      return std::ranges::all_of(list, [&](const Explanatory& x) { return complete(x.value); });
    };
    if (!complete(e.effect) || !all(e.others) || !all(e.late_others) || !all(e.causes)) return std::nullopt;
    return SumsWithoutGaps(e);
  }

  [[nodiscard]] std::vector<PartialSums> at(long lag) const {
    std::vector<PartialSums> sums(kParts, PartialSums(width()));
    for (long part = 0; part < static_cast<long>(kParts); ++part) {
      const auto [begin, end] = rows_of(part, n_, lag);
      if (begin >= end) continue;
      Eigen::MatrixXd& products = sums[static_cast<std::size_t>(part)].products;
      put_running(still_, still_place_, begin, end, products);
      put_running(moving_, moving_place_, begin - lag, end - lag, products);
      for (std::size_t i = 0; i < still_.signals.size(); ++i) {
        for (std::size_t j = 0; j < moving_.signals.size(); ++j) {
          const Eigen::Index row = still_place_[i], column = moving_place_[j];
          products(row, column) = products(column, row) =
              still_.signals[i].segment(begin, end - begin).dot(moving_.signals[j].segment(begin - lag, end - begin));
        }
      }
    }
    return sums;
  }

 private:
  /// Signals, and of each pair the sum of its products before each sample.
  struct Group {
    std::vector<Eigen::VectorXd> signals;
    std::vector<Eigen::VectorXd> running;  ///< pairs (i, j <= i), row by row
  };

  explicit SumsWithoutGaps(const DelayedEffect& e) : n_(static_cast<long>(e.effect.size())) {
    const std::vector<Column> columns = columns_at(e, 1, true);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const bool moves = columns[c].lag != 0;
      (moves ? moving_place_ : still_place_).push_back(static_cast<Eigen::Index>(c));
      (moves ? moving_ : still_)
          .signals.push_back(columns[c].signal == nullptr
                                 ? Eigen::VectorXd(Eigen::VectorXd::Ones(n_))
                                 : Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(columns[c].signal->data(), n_)));
    }
    for (Group* group : {&still_, &moving_}) {
      for (std::size_t i = 0; i < group->signals.size(); ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
          Eigen::VectorXd sum(n_ + 1);
          sum(0) = 0.0;
          for (long k = 0; k < n_; ++k) sum(k + 1) = sum(k) + group->signals[i](k) * group->signals[j](k);
          group->running.push_back(std::move(sum));
        }
      }
    }
  }

  [[nodiscard]] Eigen::Index width() const {
    return static_cast<Eigen::Index>(still_.signals.size() + moving_.signals.size());
  }

  static void put_running(const Group& group, const std::vector<Eigen::Index>& place, long begin, long end,
                          Eigen::MatrixXd& products) {
    std::size_t pair = 0;
    for (std::size_t i = 0; i < group.signals.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j, ++pair)
        products(place[i], place[j]) = products(place[j], place[i]) =
            group.running[pair](end) - group.running[pair](begin);
    }
  }

  long n_;
  Group still_, moving_;
  std::vector<Eigen::Index> still_place_, moving_place_;  ///< columns of `sums_at`
};

/// Variances of the noise of the columns of `sums_at`.
Eigen::VectorXd noise_of(const DelayedEffect& e, bool with_causes) {
  std::vector<double> variances{0.0};
  for (const Explanatory& other : e.others) variances.push_back(other.noise_variance);
  for (const Explanatory& late : e.late_others) variances.push_back(late.noise_variance);
  if (with_causes)
    for (const Explanatory& cause : e.causes) variances.push_back(cause.noise_variance);
  return Eigen::Map<const Eigen::VectorXd>(variances.data(), static_cast<Eigen::Index>(variances.size()));
}

/// The share that is explained at each lag, of all effects: with all parts, and without each.
struct Shares {
  explicit Shares(const std::vector<DelayedEffect>& effects) {
    for (const DelayedEffect& effect : effects) complete.push_back(SumsWithoutGaps::of(effect));
  }

  std::vector<double> whole;
  std::array<std::vector<double>, kParts> without;
  std::vector<std::optional<SumsWithoutGaps>> complete;  ///< by effect

  void add(const std::vector<DelayedEffect>& effects, long lag) {
    double all = 0.0;
    std::array<double, kParts> rest{};
    for (std::size_t e = 0; e < effects.size(); ++e) {
      const DelayedEffect& effect = effects[e];
      const std::vector<PartialSums> parts = complete[e] ? complete[e]->at(lag) : sums_at(effect, lag, true);
      const Eigen::VectorXd noise = noise_of(effect, true);
      for (std::size_t left_out = 0; left_out <= kParts; ++left_out) {
        PartialSums together(parts[0].products.cols());
        for (std::size_t i = 0; i < kParts; ++i)
          if (i != left_out) together.products += parts[i].products;
        (left_out < kParts ? rest[left_out] : all) +=
            together.share_explained(noise) / static_cast<double>(effects.size());
      }
    }
    whole.push_back(all);
    for (std::size_t i = 0; i < kParts; ++i) without[i].push_back(rest[i]);
  }
};

/// Where the parabola through the best of the inner points and its neighbours has its top, in samples from the first.
double top_of(const std::vector<double>& shares) {
  const auto best = std::max_element(shares.begin() + 1, shares.end() - 1) - shares.begin();
  const auto at = static_cast<std::size_t>(best);
  const double curvature = shares[at - 1] - 2.0 * shares[at] + shares[at + 1];
  const double part = curvature < 0.0 ? 0.5 * (shares[at - 1] - shares[at + 1]) / curvature : 0.0;
  return static_cast<double>(best) + std::clamp(part, -1.0, 1.0);
}

/// Standard error of what `statistic` is of the shares, by what it is without each part (Efron & Tibshirani 1993,
/// section 11.5).
template <typename Statistic>
double jackknife_sigma(const Shares& shares, const Statistic& statistic) {
  std::array<double, kParts> values{};
  double mean = 0.0;
  for (std::size_t i = 0; i < kParts; ++i) mean += (values[i] = statistic(shares.without[i])) / kParts;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt((kParts - 1.0) / kParts * squares);
}

/// The share that is explained without the causes.
double share_without_causes(const std::vector<DelayedEffect>& effects, long lag) {
  double mean = 0.0;
  for (const DelayedEffect& effect : effects) {
    const Eigen::VectorXd noise = noise_of(effect, false);
    PartialSums together(noise.size() + 1);
    for (const PartialSums& part : sums_at(effect, lag, false)) together.products += part.products;
    mean += together.share_explained(noise) / static_cast<double>(effects.size());
  }
  return mean;
}

}  // namespace

DelayReport common_effect_delay(std::string cause_name, std::string effect_name,
                                const std::vector<DelayedEffect>& effects, double step_s, const DelayOptions& options,
                                const Progress& progress, std::string_view kind) {
  DelayReport report{std::move(cause_name), std::move(effect_name), 0.0, 0.0, 0.0};
  report.kind = kind;
  const auto longest = static_cast<long>(options.max_delay_s / step_s);
  const long first = -longest;
  Shares shares(effects);
  for (long lag = first; lag <= longest; ++lag) {
    if (progress.interrupted()) {
      report.finding = DelayFinding::kInterrupted;
      return report;
    }
    shares.add(effects, lag);
  }
  const std::vector<double>& explained = shares.whole;
  const auto best = std::max_element(explained.begin(), explained.end()) - explained.begin();
  const auto at = static_cast<std::size_t>(best);
  const double top = explained[at];
  report.correlation = std::sqrt(std::clamp(top, 0.0, 1.0));
  const double by_cause = top - share_without_causes(effects, first + best);
  if (!(top > kLeastExplained) || !(by_cause > kLeastByCause)) {
    report.finding = DelayFinding::kLittleExplained;
    return report;
  }
  const bool outweighed = by_cause < 1.0 - top;
  // Where causes and others move together two lags may explain as much: the top's own error does not show that.
  const auto gain = [&](const std::vector<double>& share) {
    return share[at] - share[static_cast<std::size_t>(longest)];
  };
  const bool better_than_none = gain(explained) >= kBetterThanNone * jackknife_sigma(shares, gain);
  if (best == 0 && !outweighed) {
    report.delay_s = static_cast<double>(first) * step_s;
    report.finding = better_than_none ? DelayFinding::kBeforeCause : DelayFinding::kNoneAsGood;
    return report;
  }
  if (best == 0 || at + 1 == explained.size()) {
    report.finding = DelayFinding::kNoOptimum;
    return report;
  }
  report.delay_s = (static_cast<double>(first) + top_of(explained)) * step_s;
  // A cause that jumps between two samples, as a servo without lag does, is known to half a sample.
  constexpr double kOfASample = 0.5;
  report.sigma_s = std::hypot(jackknife_sigma(shares, top_of), kOfASample) * step_s;
  if (outweighed && (by_cause < kLeastInDoubt || report.delay_s < 0.0)) {
    // A cause that reacts to what is left seems to follow its effect.
    report.delay_s = report.sigma_s = 0.0;
    report.finding = DelayFinding::kLittleExplained;
    return report;
  }
  if (outweighed) {
    report.finding = DelayFinding::kInDoubt;
    return report;
  }
  const double least = std::max(options.min_delay_s, estimation::kBeyondChance * report.sigma_s);
  if (std::abs(report.delay_s) < least) {
    report.finding = finding_of_small(least, options);
  } else if (!better_than_none) {
    report.finding = DelayFinding::kNoneAsGood;
  } else {
    report.finding = report.delay_s < 0.0 ? DelayFinding::kBeforeCause : DelayFinding::kApplied;
  }
  return report;
}

DelayReport effect_delay(std::string cause_name, std::string effect_name, const std::vector<double>& effect,
                         const Explanatory& cause, const std::vector<Explanatory>& others, double step_s,
                         const DelayOptions& options, const Progress& progress, std::string_view kind) {
  return common_effect_delay(std::move(cause_name), std::move(effect_name), {{effect, {cause}, others, {}}}, step_s,
                             options, progress, kind);
}

double correlation_of(const std::vector<double>& a, const std::vector<double>& b) {
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
    n += 1.0;
    sum_a += a[k];
    sum_b += b[k];
    aa += a[k] * a[k];
    bb += b[k] * b[k];
    ab += a[k] * b[k];
  }
  if (!(n > 1.0)) return 0.0;
  const double spread = (aa - sum_a * sum_a / n) * (bb - sum_b * sum_b / n);
  return spread > 0.0 ? (ab - sum_a * sum_b / n) / std::sqrt(spread) : 0.0;
}

}  // namespace veridyn::recording
