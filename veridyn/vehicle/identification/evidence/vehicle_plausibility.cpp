#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Parameter;
using estimation::ParameterStatus;

/// A parameter over what it would be in an ordinary vehicle; nothing where it was not determined.
void add_ratio(std::vector<Evidence>& rows, Check check, std::span<const Parameter> parameters, std::string_view name,
               double ordinary) {
  const Parameter* p = estimation::find_parameter(parameters, name);
  if (p == nullptr || p->status == ParameterStatus::kNotExcited || p->status == ParameterStatus::kFixed) return;
  if (!std::isfinite(p->value) || !std::isfinite(p->sigma) || !(ordinary > 0.0)) return;
  rows.push_back(estimation::row_of(check, p->name, p->value / ordinary, p->sigma / ordinary));
  if (!rows.back().passed()) rows.back().cause = Cause::kSubject;
}

}  // namespace

std::vector<Evidence> plausibility(std::span<const Parameter> parameters, const VehicleParameters<double>& known) {
  std::vector<Evidence> rows;
  const double weight = known.mass * kGravity, L = known.a + known.b;
  const auto add = [&](Check check, DriveUnknown u, double ordinary) {
    add_ratio(rows, check, parameters, kDriveUnknownNames[u], ordinary);
  };
  add(Check::kPlausibleYawInertia, DriveUnknown::kIz, known.mass * known.a * known.b);
  add(Check::kPlausibleStiffness, DriveUnknown::kCf, 0.5 * weight * known.b / L);
  add(Check::kPlausibleStiffness, DriveUnknown::kCr, 0.5 * weight * known.a / L);
  add(Check::kPlausibleGrip, DriveUnknown::kMu, 1.0);
  add_ratio(rows, Check::kPlausibleUndersteer, parameters, kUndersteerGradient, 1.0 / kGravity);
  return rows;
}

std::vector<Evidence> bound_rows(std::span<const Parameter> parameters) {
  std::vector<Evidence> rows;
  for (const Parameter& p : parameters) {
    constexpr double kNoError = 1e-12;  // a share of the value
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited) continue;
    const bool no_error = p.sigma <= kNoError * std::abs(p.value) && p.value != 0.0;
    if (p.status != ParameterStatus::kAtBound && !no_error) continue;
    // Of what no one asked for, a bound leaves the others to be used with care.
    Evidence row = estimation::row_of(
        Check::kAtBound, p.name, is_of_vehicle(p.name) ? estimation::Outcome::kFailed : estimation::Outcome::kCare);
    row.cause = Cause::kBound;
    row.value = row.limit = p.value;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace veridyn::vehicle
