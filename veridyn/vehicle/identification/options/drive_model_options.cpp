#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::vehicle {
namespace {

constexpr std::array kRolls{
    DriveUnknown::kRollGradient,     DriveUnknown::kRollFrequency,       DriveUnknown::kRollDamping,
    DriveUnknown::kRollArm,          DriveUnknown::kRelaxationLength,    DriveUnknown::kLoadTransfer,
    DriveUnknown::kLoadTransferLoss, DriveUnknown::kLoadTransferBalance, DriveUnknown::kRollSteerF,
    DriveUnknown::kRollSteerR,       DriveUnknown::kAccelHeight};
constexpr std::array kOfCourse{DriveUnknown::kSideslipBias, DriveUnknown::kCourseDelay};
constexpr std::array kOfEffects{DriveUnknown::kDownforceF, DriveUnknown::kDownforceR, DriveUnknown::kLoadSensitivity,
                                DriveUnknown::kFrontForceShare};
constexpr std::array kByGeometry{DriveUnknown::kCf,
                                 DriveUnknown::kCr,
                                 DriveUnknown::kIz,
                                 DriveUnknown::kA,
                                 DriveUnknown::kRollGradient,
                                 DriveUnknown::kRollFrequency,
                                 DriveUnknown::kRollDamping,
                                 DriveUnknown::kRollArm,
                                 DriveUnknown::kRelaxationLength,
                                 DriveUnknown::kLoadTransfer,
                                 DriveUnknown::kLoadTransferLoss,
                                 DriveUnknown::kLoadTransferBalance};

struct Knowledge {
  double mean = 0.0, sigma = 0.0;
};

/// What is known of an unknown by the vehicle's geometry; without a prior where its sigma is infinite.
Knowledge by_geometry(DriveUnknown unknown, const VehicleParameters<double>& vehicle, double roll_gradient) {
  constexpr double kGradient = 0.0089, kFrequency = 10.0, kWheelbase = 2.6;
  switch (unknown) {
    case DriveUnknown::kCf:
      return {vehicle.C_f, kInfinity};
    case DriveUnknown::kCr:
      return {vehicle.C_r, kInfinity};
    case DriveUnknown::kIz:
      return {vehicle.I_z, kInfinity};
    case DriveUnknown::kA:
      return {vehicle.a, kInfinity};
    case DriveUnknown::kRollGradient:
      return roll_gradient > 0.0 ? Knowledge{roll_gradient, 0.2 * roll_gradient}
                                 : Knowledge{kGradient, 0.5 * kGradient};
    case DriveUnknown::kRollFrequency: {
      const double typical = kFrequency * std::sqrt(kWheelbase / vehicle.wheelbase());
      return {typical, 0.4 * typical};
    }
    case DriveUnknown::kRollDamping:
      return {0.3, 0.2};
    case DriveUnknown::kRollArm:
      return {0.85 * vehicle.cg_height, 0.4 * vehicle.cg_height};
    case DriveUnknown::kLoadTransfer: {
      const double rigid = 4.0 * vehicle.cg_height / (vehicle.track_f + vehicle.track_r);
      return {rigid, 0.25 * rigid};
    }
    case DriveUnknown::kLoadTransferLoss:
      return {0.2, 0.2};
    case DriveUnknown::kLoadTransferBalance:
      return {0.0, 0.4};
    default:
      return {0.12 * vehicle.wheelbase(), 0.06 * vehicle.wheelbase()};
  }
}

/// Whether a structure frees an unknown of those that structures free.
bool frees(DriveStructure structure, DriveUnknown unknown) {
  switch (unknown) {
    case DriveUnknown::kRelaxationLength:
      return has_relaxation(structure);
    case DriveUnknown::kLoadTransfer:
      return structure == DriveStructure::kSaturation;
    case DriveUnknown::kLoadTransferLoss:
      return structure == DriveStructure::kMagicFormula;
    case DriveUnknown::kLoadTransferBalance:
      return saturates(structure);
    default:
      return has_roll(structure);
  }
}

/// Lowest and highest value of an unknown that starts at `start`; `factor` is `DriveModelOptions::search_factor`.
std::pair<double, double> bounds_of(DriveUnknown unknown, double start, double wheelbase, double factor) {
  switch (unknown) {
    case DriveUnknown::kCf:
    case DriveUnknown::kCr:
    case DriveUnknown::kIz:
      return {start / factor, factor * start};
    case DriveUnknown::kA:
      return {0.02 * wheelbase, 0.98 * wheelbase};
    case DriveUnknown::kMu:
      return {0.02, 5.0};
    case DriveUnknown::kShape:
      return {1.0, 1.99};
    case DriveUnknown::kCurvature:
      return {-10.0, 1.0};
    case DriveUnknown::kRollGradient:
      return {0.0, 0.1};
    case DriveUnknown::kRollFrequency:
      return {0.4 * start, 2.5 * start};
    case DriveUnknown::kRollDamping:
      return {0.05, 1.2};
    case DriveUnknown::kRollArm:
      return {-wheelbase, wheelbase};
    case DriveUnknown::kLoadTransfer:
      return {0.0, 2.0};
    case DriveUnknown::kLoadTransferLoss:
      return {0.0, 1.0};
    case DriveUnknown::kLoadTransferBalance:
      return {-1.0, 1.0};
    case DriveUnknown::kDownforceF:
    case DriveUnknown::kDownforceR:
      return {-2e-4, 1e-2};
    case DriveUnknown::kLoadSensitivity:
      return {-1.0, 3.0};
    case DriveUnknown::kFrontForceShare:
      return {0.0, 1.0};
    case DriveUnknown::kRelaxationLength:
      return {kShortestRelaxation * wheelbase, wheelbase};
    case DriveUnknown::kSteerScale:
    case DriveUnknown::kAccelYScale:
      return {-0.9, kInfinity};
    case DriveUnknown::kSteerDelay:
    case DriveUnknown::kYawRateDelay:
    case DriveUnknown::kAccelYDelay:
    case DriveUnknown::kCourseDelay:
      return {-kLongestDelay_s, kLongestDelay_s};
    default:
      return {-kInfinity, kInfinity};
  }
}

/// What is not a structure's, and not known exactly.
void free_budget(DriveModelOptions& options) {
  for (const DrivePrior& budget : kDriveBudget)
    if (std::ranges::find(kRolls, budget.unknown) == kRolls.end())
      options.free[budget.unknown] = options.prior[budget.unknown] > 0.0;
}

}  // namespace

DriveModelOptions::DriveModelOptions() {
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kSteerBias,
                               DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias})
    free[u] = true;
  start.fill(0.0);
  for (const DriveUnknown u : kByGeometry) start[u] = kNaN;
  start[DriveUnknown::kMu] = 1.0;
  start[DriveUnknown::kShape] = 1.3;
  prior.fill(kInfinity);
  prior[DriveUnknown::kSteerBias] = kDegree;
  prior[DriveUnknown::kYawRateBias] = kDegree;
  prior[DriveUnknown::kAccelYBias] = 0.5;
  prior[DriveUnknown::kSteerScale] = 0.1;
  prior[DriveUnknown::kAccelYScale] = 0.03;
  for (const DriveUnknown u :
       {DriveUnknown::kSteerDelay, DriveUnknown::kYawRateDelay, DriveUnknown::kAccelYDelay, DriveUnknown::kCourseDelay})
    prior[u] = 0.1;
  prior[DriveUnknown::kSideslipBias] = kDegree;
  for (const DriveUnknown u : kRolls) prior[u] = kNaN;
  for (const DrivePrior& budget : kDriveBudget) prior[budget.unknown] = budget.sigma;
  free_budget(*this);
  prior[DriveUnknown::kDownforceF] = prior[DriveUnknown::kDownforceR] = kDownforceSigma;
  // Stiffness grows with load by 0.4 to 1 of what it would in proportion (Pacejka 2006, chapter 1).
  start[DriveUnknown::kLoadSensitivity] = 0.0;
  prior[DriveUnknown::kLoadSensitivity] = 0.7;
  // Brakes have 0.5 to 0.8 of it in front, engines all or nothing; one share stands for both.
  start[DriveUnknown::kFrontForceShare] = 0.5;
  prior[DriveUnknown::kFrontForceShare] = 0.3;
  prior[DriveUnknown::kRollBias] = prior[DriveUnknown::kRollRateBias] = kDegree;
  prior[DriveUnknown::kShape] = 0.2;
  prior[DriveUnknown::kCurvature] = 0.5;
}

bool has_unknown(const DriveTyre& tyre, DriveUnknown u) {
  return std::visit(
      [u]<typename Tyre>(const TyreLaw<Tyre>&) {
        if (u == DriveUnknown::kMu) return Tyre::kNeedsFriction;
        return TyreWithShape<Tyre> && (u == DriveUnknown::kShape || u == DriveUnknown::kCurvature);
      },
      tyre);
}

namespace {

DriveTyre tyre_named(std::string_view name) {
  DriveTyre found;
  AllTyresByNumbers::for_each([&]<typename Tyre>() {
    if (name == Tyre::kStudyName) found = TyreLaw<Tyre>();
  });
  return found;
}

void read_estimate(const StudyTable& table, const std::string& key, DriveModelOptions& options) {
  const std::vector<std::string> names(kDriveUnknownNames.begin(), kDriveUnknownNames.end());
  options.free.fill(false);
  free_budget(options);
  for (const std::string& name : table.texts(key)) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      table.fail(
          key, fmt::format("'{}' is not an unknown of the drive model{}", name, suggestion(name, names, names.size())));
    const auto unknown = static_cast<DriveUnknown>(at - names.begin());
    if (std::ranges::find(kRolls, unknown) != kRolls.end())
      table.fail(key, fmt::format("names {}, which identify.structure frees or not", name));
    if (std::ranges::find(kOfCourse, unknown) != kOfCourse.end())
      table.fail(
          key, fmt::format("names {}, which is estimated wherever course and heading give the lateral velocity", name));
    if (std::ranges::find(kOfEffects, unknown) != kOfEffects.end())
      table.fail(key, fmt::format("names {}, which identify.effects frees or not", name));
    if (!has_unknown(options.tyre, unknown) &&
        (unknown == DriveUnknown::kMu || unknown == DriveUnknown::kShape || unknown == DriveUnknown::kCurvature))
      table.fail(key, fmt::format("names {}, which {} tyres do not have (tyre = \"magic formula\")", name,
                                  table.text_or("tyre", "linear")));
    options.free[unknown] = true;
  }
}

void read_priors(const StudyTable& priors, DriveModelOptions& options) {
  for (const DriveUnknown u : kAllDriveUnknowns) {
    const std::string_view name = kDriveUnknownNames[u];
    if (!priors.has(name)) continue;
    const bool none = priors.is_text(name) && priors.text(name) == "none";
    if (none || !is_in_budget(u)) {
      options.prior[u] = none ? kInfinity : priors.positive(name, kDriveUnknownUnits[u]);
      continue;
    }
    options.prior[u] = priors.number(name, kDriveUnknownUnits[u]);
    if (options.prior[u] < 0.0) priors.fail(name, "must be >= 0; 0: known exactly");
    options.free[u] = options.free[u] && options.prior[u] > 0.0;
  }
}

}  // namespace

const KeyTable<DriveModelOptions>& DriveModelOptions::keys() {
  using O = DriveModelOptions;
  std::vector<std::string> tyres;
  AllTyresByNumbers::for_each([&]<typename Tyre>() { tyres.emplace_back(Tyre::kStudyName); });
  static const auto table =
      KeyTable<O>("identify")
          .other({"tyre", "", quoted_list(tyres, "`"), "\"linear\"", "law of the tyres"},
                 [tyres](const StudyTable& t, const std::string& key, O& o) {
                   o.tyre = tyre_named(t.choice_or(key, tyres, ""));
                   for (const DriveUnknown u : {DriveUnknown::kMu, DriveUnknown::kShape})
                     if (has_unknown(o.tyre, u)) o.free[u] = true;
                 })
          .other({"estimate", "", "names of unknowns",
                  "C_f, C_r, I_z, the three biases, and mu and C of tyres that have them",
                  "what is free beside what structure and effects free and what `veridyn priors` lists; the rest stays "
                  "at its start",
                  true},
                 read_estimate)
          .number("smoothing", &O::smoothing_Hz, "Hz", kNotNegative,
                  "cut-off of the kernel through which inputs and outputs alike go before they are compared, in place "
                  "of the filter that takes the steering's noise off; 0: none")
          .otherwise("the steering's own Wiener filter, where its noise is above 0.1 % of it, and no other")
          .other({"start", "SI", "by the names of unknowns", "by the vehicle's geometry",
                  "where the search begins; also the mean of the prior", true},
                 [](const StudyTable& t, const std::string& key, O& o) {
                   const StudyTable starts = t.table(key);
                   for (const DriveUnknown u : kAllDriveUnknowns)
                     o.start[u] = starts.number_or(kDriveUnknownNames[u], kDriveUnknownUnits[u], o.start[u]);
                 })
          .other(
              {"prior", "SI", "by the names of unknowns, or `\"none\"`",
               "steer_bias 1 deg, yaw_rate_bias 1 deg/s, accel_y_bias 0.5 m/s^2, steer_scale 0.1, accel_y_scale 0.03, "
               "sideslip_bias 1 deg, yaw_rate_delay and course_delay 0.1 s, C 0.2, E 0.5, what `veridyn priors` "
               "lists; others by the geometry",
               "standard deviation of what is known beforehand; of what `veridyn priors` lists 0: known exactly", true},
              [](const StudyTable& t, const std::string& key, O& o) { read_priors(t.table(key), o); });
  return table;
}

DriveModelOptions with_geometry(DriveModelOptions options, const VehicleParameters<double>& vehicle,
                                double roll_gradient) {
  for (const DriveUnknown u : kByGeometry) {
    const Knowledge known = by_geometry(u, vehicle, roll_gradient);
    if (!std::isfinite(options.start[u])) options.start[u] = known.mean;
    if (std::isnan(options.prior[u])) options.prior[u] = known.sigma;
  }
  return options;
}

estimation::ModelParameter model_parameter(DriveUnknown unknown, const DriveModelOptions& options, double wheelbase) {
  estimation::ModelParameter p;
  p.name = std::string(kDriveUnknownNames[unknown]);
  p.unit = std::string(kDriveUnknownUnits[unknown]);
  p.start = options.start[unknown];
  p.fixed = !options.free[unknown];
  p.prior_sigma = p.fixed ? kInfinity : options.prior[unknown];
  // Bounds must hold at the start, whatever was given.
  const auto [low, high] = bounds_of(unknown, p.start, wheelbase, options.search_factor);
  p.low = std::min(low, p.start);
  p.high = std::max(high, p.start);
  return p;
}

DriveModelOptions with_course(DriveModelOptions options, bool by_course) {
  for (const DriveUnknown u : kOfCourse) options.free[u] = by_course;
  return options;
}

DriveModelOptions with_structure(DriveModelOptions options, DriveStructure structure) {
  options.structure = structure;
  if (structure == DriveStructure::kScaledAccel) options.free[DriveUnknown::kAccelYScale] = true;
  for (const DriveUnknown u : kRolls) options.free[u] = frees(structure, u) && options.prior[u] != 0.0;
  if (saturates(structure) && options.tyre == kDriveTyre<LinearTyre>) {
    const bool has_shape = structure == DriveStructure::kMagicFormula;
    options.tyre = has_shape ? kDriveTyre<SimpleMagicFormulaTyre> : kDriveTyre<FialaTyre>;
    options.free[DriveUnknown::kMu] = true;
    options.free[DriveUnknown::kShape] = options.free[DriveUnknown::kCurvature] = has_shape;
    // Dry road and gravel: 0.6 to 1.2.
    if (!std::isfinite(options.prior[DriveUnknown::kMu])) options.prior[DriveUnknown::kMu] = 0.3;
  }
  return options;
}

DriveModelOptions without_budget(DriveModelOptions options) {
  for (const DrivePrior& budget : kDriveBudget) options.free[budget.unknown] = false;
  return options;
}

DriveModelOptions with_effects(DriveModelOptions options, const DriveEffects& effects) {
  options.effects = effects;
  options.free[DriveUnknown::kDownforceF] = options.free[DriveUnknown::kDownforceR] = effects[DriveEffect::kDownforce];
  options.free[DriveUnknown::kLoadSensitivity] = options.free[DriveUnknown::kFrontForceShare] =
      effects[DriveEffect::kPedals];
  return options;
}

}  // namespace veridyn::vehicle
