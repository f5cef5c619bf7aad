// veridyn regress TABLE --response z: regression of a plain table, with everything that may be said of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/regression_judgement.hpp"
#include "veridyn/io/tables/number_table.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/regression_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::estimation;

/// "a, b,c" as words.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + ",") {
    if (c == ',') {
      if (!word.empty()) words.push_back(word);
      word.clear();
    } else if (c != ' ') {
      word += c;
    }
  }
  return words;
}

const io::NumberColumn& numbers_of(const io::NumberTable& table, const std::string& name) {
  const io::NumberColumn& column = table.at(name);
  if (!column.is_number()) throw InputError(table.source, fmt::format("column '{}' holds text, not numbers", name));
  return column;
}

/// All columns of numbers but those that have another part.
std::vector<std::string> regressors_of(const io::NumberTable& table, const Arguments& arguments) {
  if (arguments.given("--regressors")) return words_of(arguments.text("--regressors"));
  std::vector<std::string> names;
  for (const io::NumberColumn& column : table.columns) {
    const bool other = column.name == arguments.text("--response") || column.name == arguments.text("--segments") ||
                       column.name == arguments.text("--row-sigma");
    if (column.is_number() && !other) names.push_back(column.name);
  }
  return names;
}

/// Numbers of a row by its labels: contiguous, a new one wherever the label changes.
std::vector<int> segments_of(const io::NumberColumn& column, std::size_t rows) {
  std::vector<int> segment(rows, 0);
  for (std::size_t i = 1; i < rows; ++i) {
    const bool same =
        column.is_number() ? column.number[i] == column.number[i - 1] : column.text[i] == column.text[i - 1];
    segment[i] = segment[i - 1] + (same ? 0 : 1);
  }
  return segment;
}

/// W of [x, z] from "name=sigma" words; empty without any.
Eigen::MatrixXd errors_of(const std::vector<std::string>& words, const std::vector<std::string>& columns) {
  if (words.empty()) return {};
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(columns.size(), columns.size());
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const auto column = std::ranges::find(columns, word.substr(0, equals));
    double sigma = kNaN;
    try {
      if (equals != std::string::npos) sigma = std::stod(word.substr(equals + 1));
    } catch (const std::exception&) {
      sigma = kNaN;
    }
    if (column == columns.end() || !(sigma >= 0.0))
      throw InputError("--noise", fmt::format("holds '{}'; expected the name of response or regressor = its standard "
                                              "deviation, such as alpha=0.01",
                                              word));
    const auto i = column - columns.begin();
    W(i, i) = sigma * sigma;
  }
  return W;
}

RegressionData data_of(const io::NumberTable& table, const Arguments& arguments) {
  const io::NumberColumn& response = numbers_of(table, arguments.text("--response"));
  const std::vector<std::string> names = regressors_of(table, arguments);
  RegressionData data;
  data.regressand_name = response.name;
  const bool constant = !arguments.flag("--no-constant");
  if (constant) {
    data.parameter_names.emplace_back("constant");
    data.parameter_units.push_back(response.unit);
  }
  for (const std::string& name : names) {
    if (name == response.name) throw InputError("--regressors", fmt::format("holds the response '{}'", name));
    data.parameter_names.push_back(name);
    const std::string& unit = numbers_of(table, name).unit;
    data.parameter_units.push_back(unit == "1" ? response.unit : fmt::format("{}/({})", response.unit, unit));
  }
  const auto rows = signed_index(table.rows);
  data.regressors = RowMatrix::Ones(rows, data.parameter_names.size());
  for (std::size_t j = 0; j < names.size(); ++j)
    data.regressors.col(signed_index(j) + (constant ? 1 : 0)) =
        Eigen::Map<const Eigen::VectorXd>(table.at(names[j]).number.data(), rows);
  data.regressand = Eigen::Map<const Eigen::VectorXd>(response.number.data(), rows);
  if (arguments.given("--segments")) data.segment = segments_of(table.at(arguments.text("--segments")), table.rows);
  if (arguments.given("--row-sigma"))
    data.row_scale =
        Eigen::Map<const Eigen::VectorXd>(numbers_of(table, arguments.text("--row-sigma")).number.data(), rows);
  std::vector<std::string> columns = data.parameter_names;
  columns.push_back(response.name);
  data.error_covariance = errors_of(words_of(arguments.text("--noise")), columns);
  return data;
}

JudgedRegressionOptions regression_options(const Arguments& arguments) {
  static const std::map<std::string, Method> kMethods{
      {"OLS", Method::kOls}, {"TLS", Method::kTls}, {"GTLS", Method::kGtls}, {"PCA-GTLS", Method::kPcaGtls}};
  JudgedRegressionOptions options;
  if (const auto method = kMethods.find(arguments.text("--method")); method != kMethods.end())
    options.method = method->second;
  if (arguments.text("--structure") == "stepwise") options.structure = StructureMethod::kStepwise;
  if (arguments.text("--structure") == "orthogonal") options.structure = StructureMethod::kOrthogonal;
  options.bootstrap = static_cast<std::size_t>(std::max(0.0, arguments.number("--bootstrap")));
  options.seed = arguments.common.seed.value_or(1);
  return options;
}

std::string rows_csv(const JudgedRegression& result) {
  std::string text = "measured,modelled,residual\n";
  for (Eigen::Index i = 0; i < result.predicted.size(); ++i)
    text += fmt::format("{},{},{}\n", result.data.regressand(i), result.predicted(i),
                        result.data.regressand(i) - result.predicted(i));
  return text;
}

int regress(const Arguments& arguments) {
  const std::string& file = arguments.text("TABLE");
  const CommonOptions& options = arguments.common;
  const io::NumberTable table = io::read_number_table_file(file);
  RegressionData data = data_of(table, arguments);
  OutputFolder folder(options.out);
  TerminalProgress progress = progress_of(options);
  const JudgedRegression result = judged_regression(std::move(data), regression_options(arguments), progress);
  if (result.interrupted) throw Interrupted();
  folder.write("rows.csv", rows_csv(result));
  folder.write("report.html", report::to_html(report::regression_report(result, file, program_name())));
  const double condition_number = result.chosen ? result.chosen->condition_number : kNaN;
  publish_analysis(
      folder,
      {.command = "regress", .study_name = file, .study_toml = {}, .seed = options.seed.value_or(1), .inputs = {file}},
      options, result, {.summary = {{"condition_number", condition_number}}});
  return kDone;
}

}  // namespace

Command regress_command() {
  return {
      .name = "regress",
      .summary = "regression of a plain table: all methods, collinearity, intervals, judgement",
      .arguments =
          {{.name = "TABLE",
            .help = "numbers in columns under a row of names, name[unit]; comma, semicolon, tabulator or blanks",
            .required = true},
           {.name = "--response", .help = "column that is explained", .type = "COLUMN", .required = true},
           {.name = "--regressors", .help = "columns that explain it; without: all others of numbers", .type = "A,B"},
           {.name = "--segments",
            .help = "column whose changes part the rows: runs, days; residuals are not correlated across",
            .type = "COLUMN"},
           {.name = "--row-sigma",
            .help = "column of the standard deviation of each row's errors, up to a factor: weights",
            .type = "COLUMN"},
           {.name = "--noise",
            .help = "standard deviations of the errors of columns: with those of regressors total least squares "
                    "corrects for them (GTLS, PCA-GTLS)",
            .type = "NAME=S,..."},
           {.name = "--method",
            .help = "\"auto\" takes what the comparison recommends",
            .value = std::string("auto"),
            .choices = {"auto", "OLS", "TLS", "GTLS", "PCA-GTLS"}},
           {.name = "--structure",
            .help = "chooses among the regressors first",
            .value = std::string("given"),
            .choices = {"given", "stepwise", "orthogonal"}},
           {.name = "--bootstrap", .help = "replicates of a block bootstrap alongside", .value = 0.0, .type = "N"},
           {.name = "--no-constant", .help = "no constant term", .value = false}},
      .default_out = "out/regress",
      .example = "veridyn regress examples/tables/coast_down.csv --response deceleration --segments run",
      .run = regress};
}

}  // namespace veridyn::app
