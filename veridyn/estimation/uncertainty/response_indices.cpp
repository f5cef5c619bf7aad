#include "veridyn/estimation/uncertainty/response_indices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/batches/block_store.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::estimation {
namespace {

/// Runs last a tenth of a second, so that a killed process loses little.
constexpr std::size_t kRunsPerBlock = 32;

/// About its nominal value.
IndexInput within(IndexInput input, double share, const StudyTable& table, const char* key) {
  const double half = share * std::abs(input.nominal);
  if (!(half > 0.0)) table.fail(key, fmt::format("{} is 0, and a share of it nothing: give low and high", input.name));
  input.low = input.nominal - half;
  input.high = input.nominal + half;
  return input;
}

IndexInput input_of(const GivenInputs::Input& given, std::span<const IndexInput> known, double share) {
  const StudyTable& table = given.table;
  std::vector<std::string> names;
  for (const IndexInput& k : known) names.push_back(k.name);
  const auto found = std::find(names.begin(), names.end(), given.parameter);
  if (found == names.end())
    table.fail("parameter", fmt::format("'{}' is not one that can vary here{}", given.parameter,
                                        suggestion(given.parameter, names, 40)));
  IndexInput input = known[found - names.begin()];
  input.place = table.place("parameter");
  const bool low = table.has("low"), high = table.has("high");
  if (!low && !high) return within(std::move(input), given.range > 0.0 ? given.range : share, table, "parameter");
  if (given.range > 0.0) table.fail("range", "and low, high exclude each other");
  if (!low || !high) table.fail(low ? "high" : "low", "is missing: a range has two ends");
  input.low = table.number("low", input.unit);
  input.high = table.number("high", input.unit);
  if (!(input.low < input.high))
    table.fail("low",
               fmt::format("= {:g} {} must be below high = {:g} {}", input.low, input.unit, input.high, input.unit));
  return input;
}

const KeyTable<GivenInputs::Input>& input_keys() {
  using I = GivenInputs::Input;
  // In the unit of the parameter, which only who reads it knows.
  const auto later = [](const StudyTable&, const std::string&, I&) {};
  static const auto table =
      KeyTable<I>("input", "Each number that varies.")
          .text("parameter", &I::parameter, "its name")
          .required()
          .number("range", &I::range, "1", between(0.0, 1.0), "share of the nominal value up and down")
          .otherwise("that of all")
          .other({"low", "SI", "", "by `range`", "lower bound, in place of `range`", true}, later)
          .other({"high", "SI", "", "by `range`", "upper bound", true}, later)
          .check([](const StudyTable& t, I& input) { input.table = t; });
  return table;
}

/// The points in the inputs' units.
Eigen::MatrixXd points_of(std::span<const IndexInput> inputs, const Eigen::MatrixXd& design) {
  Eigen::MatrixXd points(design.rows(), design.cols());
  for (std::size_t i = 0; i < inputs.size(); ++i)
    points.col(i) = (inputs[i].low + (inputs[i].high - inputs[i].low) * design.col(i).array()).matrix();
  return points;
}

std::uint64_t fingerprint_of(const ResponseProblem& problem, const Eigen::MatrixXd& points) {
  numerics::Fingerprint print;
  print.add(problem.fingerprint);
  for (const IndexInput& i : problem.inputs) print.add(std::string_view(i.name));
  for (const Response& r : problem.responses) {
    print.add(std::string_view(r.name));
    print.add(r.nominal);
  }
  print.add(static_cast<std::uint64_t>(points.rows()));
  for (const double v : points.reshaped()) print.add(v);
  return print.value();
}

/// Responses by point: a row each.
using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::size_t failed_runs(const Table& table) {
  std::size_t failed = 0;
  for (Eigen::Index row = 0; row < table.rows(); ++row) failed += table.row(row).array().isNaN().all() ? 1U : 0U;
  return failed;
}

bool moves(const Eigen::VectorXd& values, double negligible) {
  double low = kInfinity, high = -kInfinity;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return high - low > negligible;
}

}  // namespace

const KeyTable<GivenInputs>& GivenInputs::keys() {
  using G = GivenInputs;
  static const auto table =
      KeyTable<G>("sensitivity")
          .number(
              "range", &G::range, "1", between(0.0, 1.0),
              "variation of each input that has no range of its own, as a share of its nominal value: \"10 %\" is 0.1")
          .tables("input", input_keys(),
                  [](const StudyTable& one, G& g) { g.inputs.push_back(input_keys().read(one)); })
          .check([](const StudyTable& t, G& g) {
            if (t.has("samples")) t.fail("samples", "is of muscles; here it is index_samples");
            g.table = t;
          });
  return table;
}

std::vector<IndexInput> index_inputs(const GivenInputs& given, std::span<const IndexInput> known,
                                     std::span<const std::string> defaults) {
  std::vector<IndexInput> inputs;
  for (const GivenInputs::Input& one : given.inputs) {
    IndexInput input = input_of(one, known, given.range);
    for (const IndexInput& other : inputs)
      if (other.name == input.name) one.table.fail("parameter", fmt::format("'{}' comes twice", input.name));
    inputs.push_back(std::move(input));
  }
  if (!inputs.empty()) return inputs;
  for (const IndexInput& k : known) {
    if (std::find(defaults.begin(), defaults.end(), k.name) == defaults.end()) continue;
    inputs.push_back(within(k, given.range, given.table, "range"));
    inputs.back().place = given.table.place("range");
  }
  return inputs;
}

std::optional<std::size_t> ResponseIndices::strongest(std::size_t result) const {
  const ResultIndices& r = results[result];
  std::optional<std::size_t> best;
  double most = -kInfinity;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double weight = i < r.variance.inputs.size() ? r.variance.inputs[i].total
                          : i < r.morris.size()        ? r.morris[i].absolute
                                                       : kNaN;
    if (weight > most) {
      most = weight;
      best = i;
    }
  }
  return best;
}

std::vector<std::string> ResponseIndices::input_names() const {
  std::vector<std::string> names;
  for (const IndexInput& i : inputs) names.push_back(i.name);
  return names;
}

ResponseIndices response_indices(const ResponseProblem& problem, const IndexOptions& options,
                                 numerics::BlockStore& store, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  ResponseIndices result{.inputs = problem.inputs};
  const std::size_t width = problem.responses.size();
  const Eigen::MatrixXd design = index_design(problem.inputs.size(), options);
  const Eigen::MatrixXd points = points_of(problem.inputs, design);
  const auto fill = [&](std::size_t item, std::span<double> values) {
    if (!problem.run(points.row(item).transpose(), values)) std::ranges::fill(values, kNaN);
  };
  const numerics::BatchValues found = store.compute({.name = "indices",
                                                     .fingerprint = fingerprint_of(problem, points),
                                                     .items = at(points.rows()),
                                                     .items_per_block = kRunsPerBlock,
                                                     .values_per_item = width,
                                                     .fill = fill},
                                                    progress);
  result.runs = at(points.rows());
  result.processor_seconds = found.processor_seconds;
  result.completed = found.completed;
  if (!found.completed) return result;
  const Table table = Eigen::Map<const Table>(found.values.data(), points.rows(), signed_index(width));
  result.failed = failed_runs(table);
  if (result.failed > 0)
    result.warnings.push_back(
        fmt::format("{} of {} runs could not finish; their samples do not count", result.failed, result.runs));
  for (std::size_t k = 0; k < width; ++k) {
    const Response& response = problem.responses[k];
    const Eigen::VectorXd values = table.col(k);
    if (result.failed < result.runs && !moves(values, response.negligible)) {
      result.constant.push_back(response.name);
      continue;
    }
    result.responses.push_back(response);
    result.results.push_back(result_indices(response.name, values, design, options, result.warnings));
  }
  std::string wide = wide_interval_warning(result.results, options.variance.samples);
  if (!wide.empty()) result.warnings.push_back(std::move(wide));
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace veridyn::estimation
