#include "bench/reproduction/muscle/muscle_reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/study/identify_muscles.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::muscle {
namespace {

constexpr std::array kQuantities = {ComparedQuantity::kParameterError, ComparedQuantity::kIdentifiedError,
                                    ComparedQuantity::kTrained,        ComparedQuantity::kUnseen,
                                    ComparedQuantity::kSimulations,    ComparedQuantity::kSeconds};

/// What is expected, of the cases by their index.
struct Expectation {
  ComparedQuantity quantity = ComparedQuantity::kUnseen;
  std::size_t of = 0;
  bool largest = false;
  double below = kInfinity;
  std::optional<std::size_t> than;
  double lessened_by = 0.0;
  std::string published;
  std::vector<std::size_t> covered;
};

std::size_t case_named(const StudyTable& table, std::string_view key, const std::string& name,
                       const std::vector<ComparedCase>& cases) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (cases[i].name == name) return i;
    names.push_back(cases[i].name);
  }
  table.fail(key, fmt::format("'{}' is no [[case]]{}", name, suggestion(name, names)));
}

ComparedCase read_case(const StudyTable& table, const TaskStudy& study) {
  ComparedCase c{.name = table.text("name")};
  if (table.has("numbers")) {
    for (const double number : table.numbers("numbers", "1")) {
      const int task = static_cast<int>(number);
      if (task != number || task < 1 || task > kElbowTasks)
        table.fail("numbers", fmt::format("{:g} is none of the tasks 1 to {}", number, kElbowTasks));
      const std::string why = obstacle(study.subject.system->model(), *study.elbow, task);
      if (!why.empty()) table.fail("numbers", fmt::format("task {}: {}", task, why));
      c.tasks.push_back(task);
    }
  } else {
    for (const Task& task : study.tasks)
      if (!task.hold_out && task.number > 0) c.tasks.push_back(task.number);
  }
  if (c.tasks.empty()) table.fail("numbers", "leaves no task to estimate from");
  c.load = table.number_or("load", "kg", study.elbow->load);
  if (!(c.load >= 0.0)) table.fail("load", fmt::format("{:g} must be >= 0", c.load));
  c.spread = table.positive_or("spread", "1", study.person->spread);
  static const std::vector<std::string> kRoutes = {"gradient", "published"};
  c.published = table.choice_or("route", kRoutes, "gradient") == "published";
  const long long most = table.integer_or("evaluations", static_cast<long long>(c.evaluations));
  if (most < 1) table.fail("evaluations", fmt::format("= {} must be at least 1", most));
  c.evaluations = static_cast<std::size_t>(most);
  return c;
}

Expectation read_expectation(const StudyTable& table, const std::vector<ComparedCase>& cases) {
  Expectation e;
  if (table.has("covered")) {
    for (const std::string& name : table.texts("covered"))
      e.covered.push_back(case_named(table, "covered", name, cases));
    return e;
  }
  std::vector<std::string> names;
  for (const ComparedQuantity q : kQuantities) names.emplace_back(to_string(q));
  const std::string quantity = table.choice_or("quantity", names, names.front());
  e.quantity = kQuantities[std::find(names.begin(), names.end(), quantity) - names.begin()];
  e.of = case_named(table, "case", table.text("case"), cases);
  static const std::vector<std::string> kStatistics = {"median", "largest"};
  e.largest = table.choice_or("statistic", kStatistics, "median") == "largest";
  e.below = table.positive_or("below", "1", kInfinity);
  if (table.has("than")) {
    e.than = case_named(table, "than", table.text("than"), cases);
    e.lessened_by = table.number_or("lessened_by", "1", 0.0);
  }
  e.published = table.text_or("published", "");
  if (!e.than && std::isinf(e.below)) table.fail("", "says nothing: it needs `below`, `than` or `covered`");
  return e;
}

/// Makes it the study of one case and person.
void arrange(TaskStudy& study, const std::vector<Task>& unseen, const ComparedCase& c, std::uint64_t seed) {
  study.seed = study.search.seed = seed;
  study.person->spread = c.spread;
  ElbowTaskOptions options = *study.elbow;
  options.load = c.load;
  study.tasks.clear();
  for (const int number : c.tasks)
    study.tasks.push_back(make_elbow_task(study.subject.system->model(), options, number));
  study.tasks.insert(study.tasks.end(), unseen.begin(), unseen.end());
  study.published.reset();
  if (!c.published) return;
  study.published.emplace();
  study.published->swarm.seed = study.published->pattern.seed = seed;
  study.published->evaluation.max_evaluations = c.evaluations;
}

/// The root of the mean square error of all free unknowns, and what is said of those that are identified.
void compare_parameters(const MuscleAnalysis& a, const TaskStudy& study, ComparedPerson& person) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    if (study.unknowns[i].fixed) continue;
    const estimation::Parameter& p = a.result.best.parameters[i];
    const double truth = a.truth.at(study.unknowns[i].name);
    const double error = (p.value - truth) / truth;
    squares += error * error;
    count += 1.0;
    if (a.result.best.parameters[i].status == estimation::ParameterStatus::kAtBound) ++person.at_bound;
    if (a.result.best.parameters[i].status != estimation::ParameterStatus::kIdentified) continue;
    ++person.identified;
    const estimation::Parameter* shown = estimation::find_parameter(a.groups.front().parameters, p.name);
    if (truth >= shown->low95 && truth <= shown->high95) ++person.covered;
    person.identified_error =
        std::max(std::isnan(person.identified_error) ? 0.0 : person.identified_error, std::abs(error));
  }
  person.parameter_error = std::sqrt(squares / count);
}

ComparedPerson compared(const TaskStudy& study, Progress& progress) {
  ComparedPerson person{.seed = study.seed};
  try {
    const auto begun = std::chrono::steady_clock::now();
    const MuscleAnalysis a = identify(study, progress);
    if (a.interrupted) return person;
    person.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() - a.preparing_s;
    compare_parameters(a, study, person);
    const auto nrmse = [&](std::string_view part) {
      const auto found = a.estimate.fit.find(std::string(part));
      return found == a.estimate.fit.end() ? kNaN : found->second;
    };
    person.trained = nrmse("nrmse_trained");
    person.unseen = nrmse("nrmse_unseen");
    person.simulations = a.result.simulations;
  } catch (const std::runtime_error& error) {
    person.trouble = error.what();
  }
  return person;
}

std::string number(double value) {
  return value >= 1000.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
}

CheckOutcome check_quantity(const Expectation& e, const std::vector<ComparedOutcome>& cases) {
  const auto statistic = [&](const ComparedOutcome& c) {
    return e.largest ? c.largest(e.quantity) : c.median(e.quantity);
  };
  const double ours = statistic(cases[e.of]);
  CheckOutcome check{.passed = std::isfinite(ours) && ours < e.below,
                     .text = fmt::format("{} of {}, {}: {}", e.largest ? "largest" : "median", to_string(e.quantity),
                                         cases[e.of].setting.name, number(ours))};
  if (std::isfinite(e.below)) check.text += fmt::format(" (below {})", number(e.below));
  if (e.than) {
    const double other = statistic(cases[*e.than]);
    const double lessened = 1.0 - ours / other;
    check.passed = check.passed && lessened >= e.lessened_by;
    check.text += fmt::format("; {}: {}: {:+.1f} %", cases[*e.than].setting.name, number(other), -100.0 * lessened);
    check.text += e.lessened_by > 0.0 ? fmt::format(" (at least {:+.1f} %)", -100.0 * e.lessened_by) : " (less)";
  }
  if (!e.published.empty()) check.text += fmt::format("; published {}", e.published);
  return check;
}

CheckOutcome check_coverage(const Expectation& e, const std::vector<ComparedOutcome>& cases) {
  int identified = 0, covered = 0;
  std::string names;
  for (const std::size_t c : e.covered) {
    names += (names.empty() ? "" : ", ") + cases[c].setting.name;
    for (const ComparedPerson& p : cases[c].persons) {
      identified += p.identified;
      covered += p.covered;
    }
  }
  const double share = static_cast<double>(covered) / std::max(1, identified);
  return {.passed = identified > 0 && share >= 0.90 && share <= 0.98,
          .text = fmt::format("{}: {} of {} identified parameters inside their 95 % intervals: {:.1f} % (90 to 98 %)",
                              names, covered, identified, 100.0 * share)};
}

}  // namespace

std::string_view to_string(ComparedQuantity quantity) {
  switch (quantity) {
    case ComparedQuantity::kParameterError:
      return "parameter error";
    case ComparedQuantity::kIdentifiedError:
      return "error of identified parameters";
    case ComparedQuantity::kTrained:
      return "trained NRMSE";
    case ComparedQuantity::kUnseen:
      return "unseen NRMSE";
    case ComparedQuantity::kSimulations:
      return "simulations";
    case ComparedQuantity::kSeconds:
      return "seconds";
  }
  return "";
}

double value_of(const ComparedPerson& person, ComparedQuantity quantity) {
  switch (quantity) {
    case ComparedQuantity::kParameterError:
      return person.parameter_error;
    case ComparedQuantity::kIdentifiedError:
      return person.identified_error;
    case ComparedQuantity::kTrained:
      return person.trained;
    case ComparedQuantity::kUnseen:
      return person.unseen;
    case ComparedQuantity::kSimulations:
      return static_cast<double>(person.simulations.values + person.simulations.with_derivatives);
    case ComparedQuantity::kSeconds:
      return person.seconds;
  }
  return kNaN;
}

double ComparedOutcome::median(ComparedQuantity quantity) const {
  std::vector<double> values;
  for (const ComparedPerson& p : persons)
    if (p.trouble.empty() && std::isfinite(value_of(p, quantity))) values.push_back(value_of(p, quantity));
  return values.empty() ? kNaN : numerics::median(values);
}

double ComparedOutcome::largest(ComparedQuantity quantity) const {
  double largest = kNaN;
  for (const ComparedPerson& p : persons) {
    const double value = value_of(p, quantity);
    if (p.trouble.empty() && std::isfinite(value)) largest = std::isnan(largest) ? value : std::max(largest, value);
  }
  return largest;
}

bool MuscleReproduction::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const CheckOutcome& c) { return c.passed; });
}

MuscleReproduction reproduce_muscle(const Study& source, Progress& progress) {
  const StudyTable& root = source.root();
  MuscleReproduction r;
  r.finding = root.text_or("finding", "");
  r.conditions = root.text_or("conditions", "");
  const long long persons = root.table_or_empty("compare").integer_or("persons", 1);
  if (persons < 1 || persons > 1000)
    root.table("compare").fail("persons", fmt::format("= {} must be from 1 to 1000", persons));
  const std::vector<StudyTable> case_tables = root.tables("case"), expectations = root.tables("expect");
  if (case_tables.empty()) root.fail("case", "is missing: there is nothing to compare");
  for (const char* own : {"case", "expect"}) root.accept(own);
  r.study = read_task_study(source, progress);
  r.title = r.study.subject.title;
  if (!r.study.person) root.fail("person", "is missing: hidden persons are simulated");
  if (!r.study.elbow) root.fail("tasks", "have to be elbow tasks");
  r.study.advice = false;
  std::vector<ComparedCase> cases;
  for (const StudyTable& table : case_tables) {
    cases.push_back(read_case(table, r.study));
    table.finish();
  }
  std::vector<Expectation> expected;
  for (const StudyTable& table : expectations) {
    expected.push_back(read_expectation(table, cases));
    table.finish();
  }
  const std::uint64_t seed = r.study.seed;
  std::vector<Task> unseen = r.study.tasks;
  std::erase_if(unseen, [](const Task& task) { return !task.hold_out; });
  for (const ComparedCase& c : cases) {
    r.cases.push_back({c, {}});
    for (long long k = 0; k < persons; ++k) {
      progress.stage(fmt::format("{}: {}, person {} of {}", r.title, c.name, k + 1, persons));
      arrange(r.study, unseen, c, seed + static_cast<std::uint64_t>(k));
      r.cases.back().persons.push_back(compared(r.study, progress));
      r.interrupted = progress.interrupted();
      if (r.interrupted) return r;
    }
    for (const ComparedPerson& p : r.cases.back().persons)
      if (!p.trouble.empty()) r.checks.push_back({false, fmt::format("{}, person {}: {}", c.name, p.seed, p.trouble)});
  }
  for (const Expectation& e : expected)
    r.checks.push_back(e.covered.empty() ? check_quantity(e, r.cases) : check_coverage(e, r.cases));
  return r;
}

}  // namespace veridyn::muscle
