#include "veridyn/muscle/identification/task_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::passed_or;
using estimation::Purpose;

/// Normalised chi-square: beyond chance it is with care, from this on the model is wrong.
constexpr double kWrongModel = 1.5;
/// Correlation of neighbouring residuals beyond which they are motion that the model does not have.
constexpr double kSystematic = 0.3;
/// NRMSE of unseen tasks that is good enough whatever the noise, and the factor over noise and fit that is chance.
constexpr double kGoodNrmse = 0.01, kLikeTrained = 3.0;
constexpr double kReserveShare = 0.05;
/// Root mean square of the parameters' changes: of persons within 5 % it is 4 to 7 %, of those within 20 % above 10 %.
constexpr double kFar = 0.08;

double trained_rmse(const std::vector<TaskOutcome>& tasks) {
  double sum = 0.0, count = 0.0;
  for (const TaskOutcome& t : tasks) {
    if (t.hold_out || !std::isfinite(t.after.rmse)) continue;
    sum += t.after.rmse * t.after.rmse;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : kNaN;
}

double trained_range(const std::vector<TaskOutcome>& tasks) {
  double range = 0.0;
  for (const TaskOutcome& t : tasks)
    if (!t.hold_out) range = std::max(range, t.before.range);
  return range;
}

Evidence check_residual(const TaskFindings& f) {
  Evidence row{.name = "residual against the noise",
               .value = f.estimate.chi_square,
               .limit = 1.0 + 4.0 * std::sqrt(2.0 / f.estimate.freedom),
               .scale = "normalised chi-square",
               .bears_on = Purpose::kParameters};
  if (!f.noise_known) {
    row.outcome = Outcome::kNotVerified;
    row.text = "the noise of the measurement is not given, so the size of the residual says nothing of the model";
    row.advice = "give each [[output]] the noise of its measurement";
    return row;
  }
  const double times = std::sqrt(std::max(0.0, row.value));
  if (row.value <= row.limit) {
    row.text = fmt::format(
        "the residual of the tasks is {:.2f} times the noise that is stated: the model explains the "
        "motion to the noise",
        times);
    if (row.value < 0.5) {
      row.outcome = Outcome::kCare;
      row.text = fmt::format(
          "the residual of the tasks is only {:.2f} times the noise that is stated: intervals are "
          "wider than the measurement",
          times);
      row.advice = "state the noise of the measurement as it is";
    }
    return row;
  }
  row.outcome = row.value > kWrongModel ? Outcome::kFailed : Outcome::kCare;
  if (f.along_angles) {
    row.text = fmt::format(
        "the residual of the tasks is {:.3g} times what the noise of moments and EMG explains: something that makes "
        "these moments is not in the model (another muscle, passive tissue, a contact), or the EMG is not of these "
        "muscles",
        times);
    row.advice =
        "check which electrode is which muscle, units and clocks of the files; if moments or EMG are noisier than "
        "stated, say so in [[output]] and [emg]";
    return row;
  }
  row.text = fmt::format(
      "the residual of the tasks is {:.3g} times the noise that is stated: something that moves this "
      "person is not in the model (muscle class, load, geometry, another joint), or the controls "
      "are not those of the recording",
      times);
  row.advice =
      "check loads, units and the clock of the controls; try another muscle class; if the noise is larger than "
      "stated, say so in [[output]]";
  return row;
}

Evidence check_correlation(const TaskFindings& f) {
  const double share = trained_rmse(f.tasks) / std::max(1e-300, trained_range(f.tasks));
  const bool numerical = share < kIntegrationShare;
  const bool systematic = f.estimate.lag1 > kSystematic && !numerical;
  Evidence row{.name = "correlation of the residual",
               .value = f.estimate.lag1,
               .limit = kSystematic,
               .scale = "autocorrelation at one sample",
               .bears_on = Purpose::kParameters};
  row.outcome = passed_or(!systematic, f.noise_known ? Outcome::kCare : Outcome::kFailed);
  row.text = systematic ? fmt::format(
                              "neighbouring residuals are alike (correlation {:.2f}): they are motion that the "
                              "model does not have, noise that is not white, or the search ended in a local minimum",
                              f.estimate.lag1)
                        : fmt::format("residuals are like noise (correlation of neighbours {:.2f})", f.estimate.lag1);
  if (systematic && f.estimate.noise_correlation.size() > 0) {
    row.text = fmt::format(
        "neighbouring residuals are alike (correlation {:.2f}): values and intervals are those of noise that is "
        "correlated from sample to sample ({:.2f}) and of the stated size, but motion that the model does not have "
        "would "
        "look alike",
        f.estimate.lag1, f.estimate.noise_correlation.maxCoeff());
    row.advice = "record the coordinates at rest: noise is as correlated there, what a model lacks is not seen";
  }
  if (numerical && f.estimate.lag1 > kSystematic) {
    row.outcome = Outcome::kCare;
    row.text = fmt::format(
        "the residual is {:.1e} of the motion and alike from sample to sample: that of the integration "
        "and of the search's end, not of a measurement; intervals made of it are too small, and a finer tasks.accuracy "
        "leaves less",
        share);
  }
  return row;
}

std::vector<Evidence> check_bounds(const TaskFindings& f) {
  std::vector<Evidence> rows;
  for (std::size_t i = 0; i < f.estimate.verdicts.size(); ++i) {
    if (f.estimate.verdicts[i] != TaskVerdict::kAtBound) continue;
    const estimation::Parameter& p = f.estimate.best.parameters[i];
    rows.push_back({.name = "parameter at its bound",
                    .about = p.name,
                    .outcome = Outcome::kCare,
                    .value = p.value,
                    .limit = p.value,
                    .scale = p.unit,
                    .text = fmt::format("{} ended at its bound {:.5g} {}: neither value nor interval are the data's",
                                        p.name, p.value, p.unit),
                    .bears_on = Purpose::kParameters,
                    .advice = "widen its bounds, or look for what is wrong in the model or the recording"});
  }
  return rows;
}

Evidence check_searches(const TaskFindings& f) {
  std::size_t finished = 0, agreeing = 0;
  for (const TaskSearch& s : f.estimate.searches) {
    finished += std::isfinite(s.cost) ? 1 : 0;
    agreeing += std::isfinite(s.cost) && s.agrees ? 1 : 0;
  }
  Evidence row{.name = "searches agree",
               .value = static_cast<double>(agreeing),
               .limit = static_cast<double>(finished),
               .scale = "searches",
               .bears_on = Purpose::kParameters};
  if (finished < 2) {
    row.outcome = Outcome::kNotVerified;
    row.text = "one search finished, so that another minimum was not looked for";
    row.advice = "identify.route = \"gradient\" with identify.starts = 3";
  } else if (f.estimate.ambiguous) {
    row.outcome = Outcome::kCare;
    row.text = "another search ends at other values with as good a fit: the data have more than one explanation";
    row.advice = "more tasks, or a prior for what is known; values of the best fit are reported";
  } else {
    row.text = agreeing == finished
                   ? fmt::format("{} searches from different values end at the same ones", finished)
                   : fmt::format("the best of {} searches is reported; the others fit worse", finished);
  }
  return row;
}

Evidence check_determined(const TaskFindings& f) {
  std::vector<std::string> identified, open;
  for (std::size_t i = 0; i < f.estimate.verdicts.size(); ++i) {
    const TaskVerdict v = f.estimate.verdicts[i];
    if (v == TaskVerdict::kFixed) continue;
    (v == TaskVerdict::kIdentified ? identified : open).push_back(f.estimate.best.parameters[i].name);
  }
  Evidence row{.name = kDetermined,
               .value = static_cast<double>(identified.size()),
               .limit = static_cast<double>(identified.size() + open.size()),
               .scale = "parameters",
               .bears_on = Purpose::kParameters};
  row.outcome = identified.empty() ? Outcome::kFailed : open.empty() ? Outcome::kPassed : Outcome::kCare;
  row.text = fmt::format("the tasks determine {} of {} parameters", identified.size(), identified.size() + open.size());
  if (!open.empty()) row.text += fmt::format("; not {}", fmt::join(open, ", "));
  if (!f.estimate.null_directions.empty())
    row.text += fmt::format("; least is known of the combination {}", f.estimate.null_directions.front());
  if (!open.empty())
    row.advice =
        "more tasks, in other poses and with other loads; estimate fewer parameters, or one factor for several "
        "(factor = true); give a prior where something is known";
  return row;
}

/// Whether the estimate is near enough to where it began for intervals on a line about it.
Evidence check_distance(const TaskFindings& f) {
  const auto& verdicts = f.estimate.verdicts;
  const bool open = std::any_of(verdicts.begin(), verdicts.end(), [](TaskVerdict v) {
    return v != TaskVerdict::kIdentified && v != TaskVerdict::kFixed;
  });
  const double distance = f.estimate.distance;
  const bool far = distance > kFar && open;
  Evidence row{.name = kDistance,
               .outcome = passed_or(!far, Outcome::kFailed),
               .value = distance,
               .limit = kFar,
               .scale = "root mean square of the parameters' changes",
               .text = fmt::format("parameters are {:.2g} % from the standard model's in the mean", 100.0 * distance),
               .bears_on = Purpose::kParameters};
  if (far) {
    row.text +=
        ", and the tasks do not determine all of them: valleys bend over such a distance and have other minima, and "
        "of simulated persons like this only two thirds of the identified parameters were inside their intervals";
    row.advice = "more tasks until all parameters are identified; identify.profiles or identify.posterior; more starts";
  }
  return row;
}

Evidence check_tasks(const TaskFindings& f) {
  std::size_t trained = 0, failed = 0;
  std::vector<std::string> still;
  for (const TaskOutcome& t : f.tasks) {
    trained += t.hold_out ? 0 : 1;
    failed += t.estimated.size() == 0 ? 1 : 0;
    if (!t.before.moves) still.push_back(t.name);
  }
  Evidence row{.name = "tasks",
               .value = static_cast<double>(trained),
               .limit = 2.0,
               .scale = "tasks",
               .bears_on = Purpose::kData};
  row.text = fmt::format("{} tasks were estimated from", trained);
  if (trained < 2) {
    row.bears_on = Purpose::kParameters;
    row.outcome = Outcome::kCare;
    row.text = "one task does not distinguish muscles that pull alike: what it leaves open is held by the priors";
    row.advice = "perform more tasks: other shoulder angles, other ranges, flexion and extension";
  }
  if (!still.empty()) {
    row.outcome = Outcome::kCare;
    row.text += fmt::format("; hardly moving, by less than a degree, and without an NRMSE: {}", fmt::join(still, ", "));
  }
  if (failed > 0) {
    row.outcome = Outcome::kCare;
    row.bears_on = Purpose::kData | Purpose::kPrediction;
    row.text += fmt::format("; {} of {} simulations cannot finish", failed, f.tasks.size());
  }
  if (!f.unused.empty()) {
    row.outcome = Outcome::kCare;
    row.text += fmt::format("; left out: {}", fmt::join(f.unused, "; "));
  }
  return row;
}

Evidence check_wraps(const TaskFindings& f) {
  Evidence row{.name = "wraps of muscles",
               .outcome = passed_or(f.wrap_warnings.empty(), Outcome::kCare),
               .value = static_cast<double>(f.wrap_warnings.size()),
               .limit = 0.0,
               .scale = "muscles and tasks",
               .text = "no task passes a pose where a muscle's path changes side or comes off a cylinder",
               .bears_on = Purpose::kParameters};
  if (!f.wrap_warnings.empty()) {
    row.text = fmt::format(
        "tasks pass poses where a muscle's path changes side or comes off a cylinder, and arms there are doubtful: {}",
        f.wrap_warnings.front());
    if (f.wrap_warnings.size() > 1) row.text += fmt::format(" (and {} more)", f.wrap_warnings.size() - 1);
    row.advice = "take other tasks in their place";
  }
  return row;
}

Evidence check_reserves(const TaskFindings& f) {
  const TaskOutcome* most = nullptr;
  for (const TaskOutcome& t : f.tasks)
    if (!t.hold_out && (most == nullptr || t.reserve_share > most->reserve_share)) most = &t;
  const double share = most != nullptr ? most->reserve_share : 0.0;
  Evidence row{.name = "torque that reserves carry",
               .outcome = passed_or(share <= kReserveShare, Outcome::kCare),
               .value = share,
               .limit = kReserveShare,
               .scale = "share of the muscles' largest moment",
               .text = fmt::format("reserves carry up to {:.1f} % of what the muscles do", 100.0 * share),
               .bears_on = Purpose::kParameters};
  if (!row.passed()) {
    row.text += fmt::format(" ({}): that part is taken as known", most->name);
    row.advice = "lower tasks.reserve_force, or take tasks that the muscles can perform alone";
  }
  return row;
}

Evidence taken_as_given(bool along_angles) {
  if (along_angles) {
    return {.name = "what is taken as given",
            .outcome = Outcome::kNotVerified,
            .value = kNaN,
            .limit = kNaN,
            .text =
                "angles, muscle paths and which electrode is of which muscle are taken as they are stated, and moments "
                "as those of these muscles alone: an error in them that forces can make up for goes into the "
                "parameters unseen, and is not in their intervals",
            .bears_on = Purpose::kParameters,
            .advice = "hold out motions of another kind, with other loads and speeds"};
  }
  return {.name = "what is taken as given",
          .outcome = Outcome::kNotVerified,
          .value = kNaN,
          .limit = kNaN,
          .text =
              "loads, segment masses, muscle paths and the controls are taken as they are stated: an error in them "
              "that forces can make up for goes into the parameters unseen, and is not in their intervals",
          .bears_on = Purpose::kParameters,
          .advice = "weigh the load; compare with an estimate at a load 5 % larger"};
}

}  // namespace

Evidence judge_hold_out(const std::vector<TaskOutcome>& tasks, double noise, double trained) {
  Evidence row{.name = "hold-out", .value = kNaN, .limit = kGoodNrmse, .scale = "NRMSE"};
  double worst = -1.0, standard = 0.0, excess = 0.0;
  std::size_t count = 0, better = 0, failed = 0;
  std::string name;
  const double chance = kLikeTrained * std::max(std::isfinite(trained) ? trained : 0.0, noise);
  for (const TaskOutcome& t : tasks) {
    if (!t.hold_out || !t.before.moves) continue;
    ++count;
    failed += std::isfinite(t.after.nrmse) ? 0 : 1;
    better += t.after.rmse < t.before.rmse || !std::isfinite(t.before.rmse) ? 1 : 0;
    excess = std::max(excess, t.after.rmse / std::max(chance, kGoodNrmse * t.before.range));
    if (t.after.nrmse > worst) {
      worst = t.after.nrmse;
      standard = t.before.nrmse;
      name = t.name;
    }
  }
  if (count == 0) {
    row.outcome = Outcome::kMissing;
    row.text = "no task was held out, so prediction is not judged";
    row.bears_on = Purpose::kPrediction;
    row.advice = "tasks.hold_out = [...] or hold_out = true in a [[task]]";
    return row;
  }
  row.value = worst;
  row.bears_on = Purpose::kPrediction;
  const std::string unseen = fmt::format(
      "the NRMSE of unseen tasks is at most {:.2g} ({}; the standard model's {:.2g})", worst, name, standard);
  if (failed > 0) {
    row.outcome = Outcome::kFailed;
    row.text = fmt::format("{} of {} unseen tasks cannot be simulated with the estimate", failed, count);
  } else if (excess <= 1.0) {
    row.text = unseen;
  } else if (better == count) {
    row.outcome = Outcome::kCare;
    row.text = unseen + ": better than the standard model, but more than noise and fit explain";
    row.advice = "add tasks like these to the estimate";
  } else {
    row.outcome = Outcome::kFailed;
    row.text = fmt::format("{}: the standard model predicts {} of {} unseen tasks as well or better", unseen,
                           count - better, count);
    row.bears_on = Purpose::kParameters | Purpose::kPrediction;
    row.advice = "more tasks; what the tasks leave open decides the unseen ones";
  }
  return row;
}

std::vector<Evidence> judge_tasks(const TaskFindings& f) {
  std::vector<Evidence> rows{check_tasks(f)};
  rows.push_back(check_residual(f));
  rows.push_back(check_correlation(f));
  rows.push_back(check_determined(f));
  for (Evidence& row : check_bounds(f)) rows.push_back(std::move(row));
  rows.push_back(check_searches(f));
  if (!f.along_angles) rows.push_back(check_distance(f));
  rows.push_back(check_wraps(f));
  rows.push_back(check_reserves(f));
  rows.push_back(judge_hold_out(f.tasks, f.noise, trained_rmse(f.tasks)));
  rows.push_back(taken_as_given(f.along_angles));
  return rows;
}

}  // namespace veridyn::muscle
