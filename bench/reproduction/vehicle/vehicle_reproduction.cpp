#include "bench/reproduction/vehicle/vehicle_reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "veridyn/core/nearest.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"

namespace veridyn::vehicle {
namespace {

struct Numeral {
  double value = 0.0;
  double half_digit = 0.0;
  std::string unit;
};

/// "34.9515 deg/s": the number, half a unit of its last digit, the unit.
Numeral read_numeral(const StudyTable& table, const std::string& text) {
  Numeral n;
  std::size_t end = 0;
  try {
    n.value = std::stod(text, &end);
  } catch (const std::exception&) {
    table.fail("value", "is not a number with a unit");
  }
  const std::string digits = text.substr(0, end);
  const std::size_t point = digits.find('.');
  const auto decimals = point == std::string::npos ? std::size_t{0} : digits.size() - point - 1;
  n.half_digit = 0.5 * std::pow(10.0, -static_cast<double>(decimals));
  const std::size_t unit = text.find_first_not_of(' ', end);
  n.unit = unit == std::string::npos ? "1" : text.substr(unit);
  return n;
}

/// The values of a quantity and its SI unit.
std::pair<std::vector<double>, std::string> quantity_of(const StudyTable& table, const VehicleTrajectory& t,
                                                        const std::string& name) {
  if (name == "radius") {
    std::vector<double> radius(t.size());
    for (std::size_t k = 0; k < t.size(); ++k) radius[k] = std::hypot(t.u[k], t.v[k]) / t.r[k];
    return {radius, "m"};
  }
  std::vector<std::string> names{"radius"};
  for (const TrajectoryQuantity& q : trajectory_quantities()) {
    if (name == q.name && !(t.*q.values).empty()) return {t.*q.values, q.unit};
    if (!(t.*q.values).empty()) names.emplace_back(q.name);
  }
  for (const WheelQuantity& q : wheel_quantities()) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      const std::string full = fmt::format("{}_{}", q.name, kWheelNames[i]);
      if (name == full && !(t.*q.values)[i].empty()) return {(t.*q.values)[i], q.unit};
      if (!(t.*q.values)[i].empty()) names.push_back(full);
    }
  }
  table.fail("quantity", fmt::format("'{}' is not in this drive{}", name, suggestion(name, names)));
}

const ScaledRun* exact_twin(const ScaleAnalysis& a) {
  return a.runs.empty() ? nullptr : &a.runs.front();  // the one whose gravity makes it exact comes first
}

PublishedNumber read_number(const StudyTable& table, const ScaleAnalysis& analysis) {
  PublishedNumber n;
  static const std::vector<std::string> kRuns{"prototype", "exact twin"};
  n.run = table.choice_or("run", kRuns, "prototype");
  n.quantity = table.text("quantity");
  n.time = table.number("time", "s");
  n.printed = table.text("value");
  const Numeral printed = read_numeral(table, n.printed);
  n.published = printed.value;
  n.tolerance = printed.half_digit;
  n.unit = printed.unit;
  const bool twin = n.run == "exact twin";
  const VehicleTrajectory& t = twin ? exact_twin(analysis)->trajectory : analysis.prototype;
  const auto [values, si] = quantity_of(table, t, n.quantity);
  const Unit unit = parse_unit_like(printed.unit, parse_unit(si));
  const double at = twin ? n.time * analysis.scaled.factors.time() : n.time;
  std::size_t k = 0;
  while (k + 1 < t.size() && t.time[k] < at - 1e-9) ++k;
  if (t.size() == 0 || std::abs(t.time[k] - at) > 1e-9)
    table.fail("time", fmt::format("{:g} s is no sample of the drive", n.time));
  n.ours = unit.from_si(values[k]);
  return n;
}

std::vector<CheckOutcome> check_groups(const StudyTable& expect, const ScaleAnalysis& a) {
  std::vector<CheckOutcome> checks;
  if (!expect.has("mismatch")) return checks;
  const StudyTable table = expect.table("mismatch");
  if (!a.given_report) expect.fail("mismatch", "needs a [scale.model]");
  std::map<std::string, double> expected;
  for (const std::string& key : table.keys()) expected[key] = table.number(key, "1");
  double largest_other = 0.0;
  std::string other;
  for (const GroupComparison& g : a.given_report->groups) {
    if (const auto found = expected.find(g.parameter); found != expected.end()) {
      checks.push_back(
          {std::abs(g.mismatch_percent - found->second) <= 0.05,
           fmt::format("{}: mismatch {:+.3f} %, expected {:+.1f} %", g.formula, g.mismatch_percent, found->second)});
      expected.erase(found);
    } else if (!(std::abs(g.mismatch_percent) <= largest_other)) {
      largest_other = std::abs(g.mismatch_percent);
      other = g.formula;
    }
  }
  for (const auto& [name, value] : expected) table.fail(name, "is no group of these vehicles");
  checks.push_back({largest_other <= 0.1, fmt::format("no other group is off by more than 0.1 %: at most {:.2g} % ({})",
                                                      largest_other, other.empty() ? "none" : other)});
  return checks;
}

}  // namespace

bool VehicleReproduction::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const CheckOutcome& c) { return c.passed; });
}

VehicleReproduction reproduce_vehicle(const StudyTable& root, Progress& progress) {
  VehicleReproduction r;
  r.title = root.text_or("title", "vehicle");
  r.finding = root.text_or("finding", "");
  r.study = read_scale_study(root, progress);
  const StudyTable expect = root.table_or_empty("expect");
  progress.stage(r.title);
  r.analysis = run_scale_study(r.study, progress);
  if (r.analysis.interrupted) return r;
  for (const StudyTable& table : root.tables("published")) {
    r.numbers.push_back(read_number(table, r.analysis));
    const PublishedNumber& n = r.numbers.back();
    r.checks.push_back({n.passed(), fmt::format("{}, {} at {:g} s: published {}, ours {:.8g} {}", n.run, n.quantity,
                                                n.time, n.printed, n.ours, n.unit)});
  }
  const std::vector<CheckOutcome> groups = check_groups(expect, r.analysis);
  r.checks.insert(r.checks.end(), groups.begin(), groups.end());
  if (expect.has("gravity")) {
    const SimilarityReport& report = r.analysis.judged();
    const double expected = expect.number("gravity", "1");
    r.checks.push_back(
        {std::abs(report.gravity.mismatch_percent - expected) <= 0.5,
         fmt::format("{}: {:.4f} and {:.4f}, mismatch {:+.1f} %, expected {:+.0f} %", report.gravity.formula,
                     report.gravity.prototype, report.gravity.model, report.gravity.mismatch_percent, expected)});
  }
  if (expect.has("twin_within")) {
    const double within = expect.positive("twin_within", "1");
    double largest = 0.0;
    std::string where = "path";
    for (const MotionDifference& d : exact_twin(r.analysis)->differences) {
      const double share = d.range > 0.0 ? d.largest / d.range : d.largest;
      if (!(share <= largest)) {
        largest = share;
        where = d.quantity;
      }
    }
    r.checks.push_back({largest <= within, fmt::format("{} moves as the prototype: largest difference {:.2g} ({}), "
                                                       "tolerance {:g}",
                                                       exact_twin(r.analysis)->name, largest, where, within)});
  }
  return r;
}

}  // namespace veridyn::vehicle
