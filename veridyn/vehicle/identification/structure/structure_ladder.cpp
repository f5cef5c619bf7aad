#include "veridyn/vehicle/identification/structure/structure_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/structure/drive_effects.hpp"
#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"
#include "veridyn/vehicle/identification/validation/vehicle_prediction.hpp"

namespace veridyn::vehicle {
namespace {

/// Probability below which a structure leaves no doubt.
constexpr double kExcluded = 1e-3;

/// What priors and the posterior's width say of a fit: minus half of the priors' chi-square, and the logarithm of the
/// ratio of the volumes that the unknowns have after and before the data.
double log_prior_volume(const VehicleProblem& problem, const OutputErrorResult& fit) {
  const DriveModelOptions model = with_geometry(problem.options.model, problem.start, problem.signals.roll_gradient);
  std::vector<Eigen::Index> known;
  double sum = 0.0;
  for (const DriveUnknown u : kAllDriveUnknowns) {
    const auto i = static_cast<Eigen::Index>(u);
    const double variance = fit.raw.covariance(i, i);
    if (!model.free[u] || !(variance > 0.0) || !std::isfinite(variance)) continue;
    known.push_back(i);
    if (!std::isfinite(model.prior[u])) continue;
    sum -= std::log(model.prior[u]) + 0.5 * std::pow((fit.raw.theta(i) - model.start[u]) / model.prior[u], 2);
  }
  if (known.empty()) return sum;
  const Eigen::MatrixXd L = numerics::Cholesky(fit.raw.covariance(known, known)).L();
  return sum + L.diagonal().array().log().sum();
}

/// Whether a fit ended where its structure is a simpler one. Where roll's frequency or damping end at their bounds in
/// few steps the fit to the end may not; if it does, that is judged.
bool ends_at_simpler(DriveStructure structure, const OutputErrorResult& fit) {
  const std::array added{DriveUnknown::kRollGradient,
                         saturates(structure) ? DriveUnknown::kMu : DriveUnknown::kRelaxationLength};
  return std::ranges::any_of(added, [&](DriveUnknown u) {
    return fit.raw.parameters[static_cast<std::size_t>(u)].status == estimation::ParameterStatus::kAtBound;
  });
}

/// How a fit does, on its own data and on the hold-out.
TriedStructure tried(const VehicleProblem& problem, const OutputErrorResult& fit, Progress& progress) {
  TriedStructure out{.structure = problem.options.model.structure,
                     .effects = problem.options.model.effects,
                     .usable = fit.raw.usable(),
                     .message = fit.raw.message};
  if (!out.usable) return out;
  out.negative_log_likelihood = fit.raw.negative_log_likelihood;
  out.log_prior_volume = log_prior_volume(problem, fit);
  out.inflation = fit.raw.autocorrelation;
  out.at_bound = ends_at_simpler(out.structure, fit);
  for (std::size_t i = 0; i < kBasicUnknowns.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(kBasicUnknowns[i]);
    out.value[i] = fit.raw.theta(row);
    out.sigma[i] = std::sqrt(fit.raw.total_covariance()(row, row));
  }
  if (problem.segments.holdout.empty() || progress.interrupted()) return out;
  const DriveValidation there = predict_drive(problem.signals, problem.segments.holdout, problem.start,
                                              problem.options.model, {fit.raw.theta, {}}, progress);
  if (const estimation::PredictedQuantity* yaw_rate = there.find("yaw_rate")) out.holdout_rmse = yaw_rate->fit.rmse;
  out.holdout_misfit = 0.0;
  for (const estimation::OutputFit& output : fit.raw.outputs)
    if (const estimation::PredictedQuantity* q = there.find(output.name)) out.holdout_misfit += std::log(q->fit.rmse);
  return out;
}

/// Whether a fit leaves no more than rounding does: there is nothing to tell structures by.
bool is_exact(const OutputErrorResult& fit) {
  constexpr double kRounding = 1e-3;  // of an output's standard deviation
  return fit.raw.usable() && std::ranges::all_of(fit.raw.outputs, [](const estimation::OutputFit& output) {
           return 1.0 - output.fit.r2 <= kRounding * kRounding;
         });
}

VehicleProblem with_options(const VehicleProblem& problem, const VehicleIdentifyOptions& options) {
  return {problem.signals, problem.segments, problem.start, problem.signal_options, options, problem.recording};
}

/// How late the steering is, where it is estimated.
std::optional<DelayByModel> delay_of(const VehicleProblem& problem, const OutputErrorResult& fit) {
  if (!fit.raw.usable() || !problem.options.model.free[DriveUnknown::kSteerDelay]) return std::nullopt;
  const estimation::Parameter& p = fit.raw.parameters[static_cast<std::size_t>(DriveUnknown::kSteerDelay)];
  return DelayByModel{p.value, p.sigma};
}

/// The options for a structure. Saturation has no relaxation length where tyres without one are likelier.
VehicleIdentifyOptions with_structure(VehicleIdentifyOptions options, DriveStructure structure, bool relaxes,
                                      const DriveEffects& effects) {
  options.model = with_effects(with_structure(options.model, structure), effects);
  if (!saturates(structure) || relaxes) return options;
  options.model.free[DriveUnknown::kRelaxationLength] = false;
  options.model.start[DriveUnknown::kRelaxationLength] = 0.0;
  return options;
}

/// View of a problem that climbs from structure to structure.
class Climb {
 public:
  Climb(const VehicleProblem& problem, const EquationErrorEstimates* equation_error, Progress& progress)
      : problem_(problem),
        equation_error_(equation_error),
        progress_(progress),
        contradicts_(problem.recording != nullptr && contradicts_itself(*problem.recording)) {}

  StructureLadder run() {
    if (problem_.options.structure) {
      const DriveStructure structure = *problem_.options.structure;
      if (structure != DriveStructure::kBicycle) begin_with_known_sensors(structure, effects_given());
      fit(structure, effects_given());
    } else {
      climb_to_roll();
      if (takes_roll()) climb_beyond_roll(effects_given());
      if (!problem_.options.effects) add_effects();
      if (progress_.interrupted()) leave_out("not all structures were tried");
      doubt();
    }
    finish();
    return std::move(ladder_);
  }

  /// A recording that contradicts itself says nothing of the structure.
  [[nodiscard]] bool contradicts() const { return contradicts_; }

 private:
  [[nodiscard]] DriveEffects effects_given() const { return problem_.options.effects.value_or(DriveEffects{}); }
  [[nodiscard]] VehicleProblem given(std::size_t rung) const { return with_options(problem_, options_[rung]); }
  [[nodiscard]] const TriedStructure& taken() const { return ladder_.tried[choose_structure(ladder_.tried)]; }
  [[nodiscard]] bool takes_roll() const {
    return !ladder_.empty() && has_roll(taken().structure) && !contradicts() && !progress_.interrupted();
  }

  /// Fits one more structure, from where the search is.
  void fit(DriveStructure structure, const DriveEffects& effects, bool relaxes = true) {
    progress_.stage(fmt::format("output error, structure: {}", name_of(structure, effects)));
    const std::size_t rung = fits_.size();
    options_.push_back(with_structure(problem_.options, structure, relaxes, effects));
    fits_.push_back(
        estimate_by_output_error(given(rung), equation_error_, search_start_, SearchEffort::kToCompare, progress_));
    ladder_.tried.push_back(tried(given(rung), fits_[rung], progress_));
    if (fits_[rung].raw.usable()) search_start_ = fits_[rung].raw.theta;
  }

  void climb_to_roll() {
    for (const DriveStructure structure :
         {DriveStructure::kBicycle, DriveStructure::kScaledAccel, DriveStructure::kRoll}) {
      if (progress_.interrupted()) return;
      if (structure == DriveStructure::kScaledAccel && !problem_.signals[DriveSignal::kAccelY].available()) continue;
      if (structure != DriveStructure::kBicycle) begin_with_known_sensors(structure, effects_given());
      fit(structure, effects_given());
      if (contradicts() || is_exact(fits_.back())) return;
    }
  }

  /// The next search begins where the structure ends without the budget's unknowns: far from the minimum they take up
  /// what the body does, and a search with them may stay there.
  void begin_with_known_sensors(DriveStructure structure, const DriveEffects& effects) {
    progress_.stage(fmt::format("output error, start of structure: {}", name_of(structure, effects)));
    VehicleIdentifyOptions known = with_structure(problem_.options, structure, true, effects);
    known.model = without_budget(known.model);
    const OutputErrorResult first = estimate_by_output_error(with_options(problem_, known), equation_error_,
                                                             known_start_, SearchEffort::kToCompare, progress_);
    if (first.raw.usable()) known_start_ = first.raw.theta;
    search_start_ = known_start_;
  }

  /// What tyres do beside rolling.
  void climb_beyond_roll(const DriveEffects& effects) {
    const std::size_t roll = ladder_.tried.size() - 1;
    bool relaxes = true;
    for (const DriveStructure structure :
         {DriveStructure::kRelaxation, DriveStructure::kSaturation, DriveStructure::kMagicFormula}) {
      if (progress_.interrupted()) return;
      if (structure == DriveStructure::kRelaxation)
        begin_with_known_sensors(structure, effects);
      else
        search_start_ = fits_[relaxes ? roll + 1 : roll].raw.theta;
      fit(structure, effects, relaxes);
      if (structure == DriveStructure::kRelaxation) relaxes = taken().structure == DriveStructure::kRelaxation;
    }
  }

  /// What road, air and pedals add to the structure taken; and where they do, the structure once more with them. What
  /// they explain may have passed for more of a structure than there is, or have hidden some of it.
  void add_effects() {
    if (ladder_.empty() || contradicts() || progress_.interrupted() || is_exact(fits_.back())) return;
    const DriveEffects distinguishable = distinguishable_effects(problem_);
    const std::size_t without = choose_structure(ladder_.tried);
    std::size_t chosen = without;
    for (bool more = true; more && !progress_.interrupted();) {
      const std::size_t before = chosen;
      for (const DriveEffect effect : kAllDriveEffects) {
        DriveEffects effects = ladder_.tried[before].effects;
        if (!distinguishable[effect] || effects[effect] || progress_.interrupted()) continue;
        effects[effect] = true;
        search_start_ = fits_[before].raw.theta;
        fit(ladder_.tried[before].structure, effects, options_[before].model.free[DriveUnknown::kRelaxationLength]);
      }
      chosen = choose_structure(ladder_.tried);
      more = chosen != before;
    }
    if (chosen != without && !progress_.interrupted()) climb_with_effects(chosen);
  }

  /// The rung taken so far gives way to all structures with its effects, one of which it is. Interrupted, it stays.
  void climb_with_effects(std::size_t chosen) {
    const auto taken_off = [&](auto& rungs) {
      auto rung = std::move(rungs[chosen]);
      rungs.erase(rungs.begin() + signed_index(chosen));
      return rung;
    };
    TriedStructure tried_before = taken_off(ladder_.tried);
    OutputErrorResult fit_before = taken_off(fits_);
    VehicleIdentifyOptions options_before = taken_off(options_);
    search_start_ = fit_before.raw.theta;
    climb_again(tried_before.effects);
    if (!progress_.interrupted()) return;
    ladder_.tried.push_back(std::move(tried_before));
    fits_.push_back(std::move(fit_before));
    options_.push_back(std::move(options_before));
  }

  /// From the simplest upward, which is the order of the choice.
  void climb_again(const DriveEffects& effects) {
    for (const DriveStructure structure : {DriveStructure::kBicycle, DriveStructure::kRoll}) {
      if (progress_.interrupted()) return;
      fit(structure, effects);
    }
    if (has_roll(taken().structure) && !progress_.interrupted()) climb_beyond_roll(effects);
  }

  /// What the others leave in doubt.
  void doubt() {
    const std::size_t chosen = choose_structure(ladder_.tried);
    for (std::size_t other = 0; other < fits_.size(); ++other) {
      if (other == chosen) continue;
      const double probability = probability_against(ladder_.tried[other], ladder_.tried[chosen]);
      if (probability > kExcluded) {
        ladder_.doubts.push_back(structure_doubt(ladder_.tried[other].structure, probability, fits_[other].estimate,
                                                 fits_[chosen].estimate));
        ladder_.doubts.back().effects = ladder_.tried[other].effects;
      }
    }
  }

  void finish() {
    ladder_.chosen = choose_structure(ladder_.tried);
    if (ladder_.empty()) return;
    // Of an interrupted search where it stood, where none ended.
    for (std::size_t rung = 0; !fits_[ladder_.chosen].raw.has_estimate() && rung < fits_.size(); ++rung)
      if (fits_[rung].raw.has_estimate()) ladder_.chosen = rung;
    ladder_.model = options_[ladder_.chosen].model;
    ladder_.fit = std::move(fits_[ladder_.chosen]);
    if (!progress_.interrupted()) {
      progress_.stage("output error");
      if (ladder_.fit.raw.usable()) {
        OutputErrorResult to_the_end = estimate_by_output_error(
            given(ladder_.chosen), equation_error_, ladder_.fit.raw.theta, SearchEffort::kToTheEnd, progress_);
        if (to_the_end.raw.has_estimate() || !progress_.interrupted()) ladder_.fit = std::move(to_the_end);
      }
    }
    if (progress_.interrupted()) {
      // A structure that was not tried may move the values by more than their intervals.
      ladder_.unfinished.converged =
          ladder_.unfinished.empty() && ladder_.fit.raw.termination == estimation::OutputErrorTermination::kConverged;
      leave_out("its parameters were not refined to the end");
      return;
    }
    ladder_.unfinished.converged = true;
    ladder_.delay = delay_of(given(ladder_.chosen), ladder_.fit);
  }

  void leave_out(const char* what) { ladder_.unfinished.left_out.emplace_back(what); }

  const VehicleProblem& problem_;
  const EquationErrorEstimates* equation_error_;
  Progress& progress_;
  bool contradicts_;
  StructureLadder ladder_;
  std::vector<OutputErrorResult> fits_;
  std::vector<VehicleIdentifyOptions> options_;
  Eigen::VectorXd search_start_, known_start_;
};

std::string reason_of(const StructureLadder& ladder, bool contradicts) {
  const TriedStructure& taken = ladder.tried[ladder.chosen];
  std::string reason = fmt::format("structure: {}", name_of(taken.structure, taken.effects));
  if (!ladder.unfinished.empty() && !taken.usable) {
    reason += ", whose search was interrupted";
  } else if (ladder.chosen > 0) {
    const TriedStructure& before = ladder.tried.front();
    reason += fmt::format(", which makes the drive likelier than {} does by a log-likelihood of {:.0f}",
                          name_of(before.structure, before.effects),
                          before.negative_log_likelihood - taken.negative_log_likelihood);
  } else if (!ladder.unfinished.empty()) {
    reason += ": none richer makes the drive likelier, of those tried before the interruption";
  } else if (ladder.tried.size() > 1) {
    reason += ": none richer makes the drive likelier";
  } else {
    reason += contradicts ? ": the recording contradicts itself, and nothing richer was fitted to it"
                          : ": it leaves no more than rounding does";
  }
  return reason;
}

}  // namespace

StructureLadder climb_structures(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                                 Progress& progress) {
  Climb climb(problem, equation_error, progress);
  StructureLadder ladder = climb.run();
  constexpr int kMostWidened = 3;
  VehicleIdentifyOptions options = problem.options;
  std::vector<BudgetConflict> widened;
  while (std::ssize(widened) < kMostWidened && !climb.contradicts() && ladder.fit.raw.usable()) {
    const std::optional<BudgetConflict> conflict = strongest(budget_conflicts(ladder.model, ladder.fit.raw));
    if (!conflict || progress.interrupted()) break;
    options.model = with_widened_prior(options.model, *conflict);
    progress.stage(fmt::format("once more, with a wider prior of {}", kDriveUnknownNames[conflict->unknown]));
    StructureLadder again = Climb(with_options(problem, options), equation_error, progress).run();
    if (progress.interrupted()) {
      ladder.unfinished.left_out.emplace_back("a prior that the drive contradicts was not widened");
      break;
    }
    if (!again.fit.raw.usable()) break;
    ladder = std::move(again);
    widened.push_back(*conflict);
  }
  ladder.conflicts = conflicts_now(std::move(widened), ladder.model, ladder.fit.raw);
  if (!problem.options.structure && !ladder.empty()) ladder.reason = reason_of(ladder, climb.contradicts());
  return ladder;
}

}  // namespace veridyn::vehicle
