// Tasks of a study with [emg]: recordings, or what would be recorded of a simulated person.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/muscle_values.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/study/task_recordings.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle::internal {
namespace {

using estimation::RowMatrix;

/// Of a simulated recording's EMG, and how long it goes on around the motion.
constexpr double kEmgRate_Hz = 100.0, kAround_s = 0.4;

numerics::FirKernel envelope_filter(const EmgSettings& emg) {
  const double pass = std::min(emg.error.bandwidth_Hz, 0.25 * kEmgRate_Hz);
  return numerics::low_pass({.rate_Hz = kEmgRate_Hz, .pass_Hz = pass, .stop_Hz = 2.0 * pass});
}

/// White noise that went through the filter of an envelope, with standard deviation 1.
std::vector<double> envelope_noise(std::size_t count, const numerics::FirKernel& kernel,
                                   numerics::RandomStream& random) {
  const std::size_t margin = kernel.half_width() + 1;
  std::vector<double> white(count + 2 * margin);
  for (double& w : white) w = random.normal() / std::sqrt(kernel.noise_gain());
  const std::vector<double> smooth = numerics::filter(white, kernel);
  return {smooth.begin() + signed_index(margin), smooth.begin() + signed_index(margin + count)};
}

/// Noise that changes over a part of a second up to a second, with standard deviation 1: white noise under a Gaussian.
std::vector<double> slow_noise(std::size_t count, numerics::RandomStream& random) {
  const double correlation = kEmgRate_Hz * (0.3 + 0.7 * random.uniform());
  const auto half = static_cast<long>(std::ceil(3.0 * correlation));
  std::vector<double> kernel, noise(count, 0.0);
  for (long i = -half; i <= half; ++i) kernel.push_back(std::exp(-std::pow(static_cast<double>(i) / correlation, 2)));
  double squares = 0.0;
  for (const double k : kernel) squares += k * k;
  std::vector<double> white(count + kernel.size() - 1);
  for (double& w : white) w = random.normal() / std::sqrt(squares);
  for (std::size_t k = 0; k < count; ++k) noise[k] = std::inner_product(kernel.begin(), kernel.end(), &white[k], 0.0);
  return noise;
}

/// An error of an envelope with standard deviation 1: in equal parts as quick as the envelope lets it, and slow.
std::vector<double> envelope_error(std::size_t count, const numerics::FirKernel& kernel,
                                   numerics::RandomStream& random) {
  std::vector<double> error = envelope_noise(count, kernel, random);
  const std::vector<double> slow = slow_noise(count, random);
  for (std::size_t k = 0; k < count; ++k) error[k] = std::sqrt(0.5) * (error[k] + slow[k]);
  return error;
}

/// What the EMG stands for, by signal: the controls that the person's own muscles need, in units of their gains and
/// ahead by their delays; the mean over the muscles of a signal.
std::vector<ControlSignals> true_envelopes(const PreparedTask& task, const EmgSettings& emg,
                                           const MuscleValues& hidden) {
  const numerics::FirKernel kernel = envelope_filter(emg);
  std::vector<double> time;
  for (double t = task.task.begin - kAround_s; t < task.task.end + kAround_s; t += 1.0 / kEmgRate_Hz) time.push_back(t);
  std::vector<ControlSignals> signals;
  const std::size_t muscles = hidden.gain.size();
  std::vector<double> u(muscles);
  for (std::size_t s = 0; s < emg.signals.size(); ++s) {
    std::vector<double> e(time.size(), 0.0);
    const auto sharing =
        static_cast<double>(std::count(emg.signal_of.begin(), emg.signal_of.end(), static_cast<int>(s)));
    for (std::size_t k = 0; k < time.size(); ++k) {
      for (std::size_t m = 0; m < muscles; ++m) {
        if (emg.signal_of[m] != static_cast<int>(s)) continue;
        task.controls.excitation.evaluate(time[k] + hidden.delay[m], u.data());
        e[k] += u[m] / (hidden.gain[m] * sharing);
      }
    }
    e = numerics::filter(e, kernel);
    constexpr double kLeastExcitation = 0.01;
    for (double& value : e) value = std::clamp(value, kLeastExcitation, 1.0);
    signals.emplace_back(time, std::move(e), 1, Interpolation::kLinear);
  }
  return signals;
}

/// By muscle, as the forward simulation takes them.
ControlSignals by_muscle(const std::vector<ControlSignals>& signals, const EmgSettings& emg) {
  const std::span<const double> time = signals.front().times();
  std::vector<double> values;
  for (std::size_t k = 0; k < time.size(); ++k) {
    constexpr double kLeastExcitation = 0.01;
    for (const int s : emg.signal_of) values.push_back(s < 0 ? kLeastExcitation : signals[s].row(k)[0]);
  }
  return {{time.begin(), time.end()}, std::move(values), emg.signal_of.size(), Interpolation::kLinear};
}

/// The recorded envelopes: with their errors, and within 0 .. 1 as every recording.
std::vector<ControlSignals> recorded_envelopes(const TaskStudy& study, const std::string& task,
                                               const std::vector<ControlSignals>& truth) {
  EmgError error = study.emg->error;
  if (study.person->emg_noise) error.relative = *study.person->emg_noise;
  const numerics::FirKernel kernel = envelope_filter(*study.emg);
  std::vector<ControlSignals> recorded;
  for (std::size_t s = 0; s < truth.size(); ++s) {
    numerics::RandomStream random(study.seed, fmt::format("EMG {} of {}", study.emg->signals[s], task));
    const std::span<const double> time = truth[s].times();
    const std::vector<double> relative = envelope_error(time.size(), kernel, random),
                              absolute = envelope_error(time.size(), kernel, random);
    std::vector<double> values;
    for (std::size_t k = 0; k < time.size(); ++k) {
      const double e = truth[s].row(k)[0];
      values.push_back(std::clamp(e * (1.0 + error.relative * relative[k]) + error.absolute * absolute[k], 0.0, 1.0));
    }
    recorded.emplace_back(std::vector<double>(time.begin(), time.end()), std::move(values), 1, Interpolation::kLinear);
  }
  return recorded;
}

/// Angles of the motion that the person made, with noise; the rest of the coordinates where they were held.
Motion recorded_angles(const TaskStudy& study, const PreparedTask& task, const RowMatrix& q,
                       const std::vector<int>& coordinates) {
  numerics::RandomStream random(study.seed, "angles of " + task.task.name);
  SignalTable table{.source = task.task.name, .names = {}, .time = task.time, .values = {}};
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    table.names.push_back(study.subject.system->model().coordinates[coordinates[i]].name);
    std::vector<double> values;
    RecordingNoise noise(study.person->noise_correlation_s);
    for (Eigen::Index k = 0; k < q.rows(); ++k)
      values.push_back(q(k, i) + study.person->noise * noise.next(task.time[k], random));
    table.values.push_back(std::move(values));
  }
  return make_motion(table, study.subject.system->model(), {.low_pass_Hz = study.emg->low_pass_Hz});
}

/// A task's recording along its angles.
TaskRecording along_angles(const TaskStudy& study, const std::string& name, bool hold_out, const Motion& angles,
                           const Eigen::VectorXd& rest, double begin, std::vector<double> time, RowMatrix measured,
                           const std::vector<ControlSignals>& emg) {
  TaskRecording out{.name = name, .hold_out = hold_out, .time = time, .measured = std::move(measured)};
  out.q = analyse_motion(*study.subject.system, angles, rest, time).q;
  EmgSegment segment = along_motion(*study.subject.system, angles, rest, begin, std::move(time), study.outputs);
  segment.name = name;
  for (const ControlSignals& signal : emg) segment.emg.push_back({signal, {}});
  out.along = std::move(segment);
  return out;
}

/// One task of the simulated person; nothing where it cannot perform it.
std::optional<TaskRecording> recorded_of_person(const TaskStudy& study, const PreparedTask& task,
                                                const Eigen::VectorXd& hidden, const MuscleValues& values) {
  const std::vector<ControlSignals> truth = true_envelopes(task, *study.emg, values);
  const auto system = person_system(study, task.task);
  MotionSegment segment = segment_of(task);
  segment.system = system.get();
  segment.controls.excitation = by_muscle(truth, *study.emg);
  std::vector<MuscleOutput> outputs;
  std::vector<int> coordinates(system->reduction().free().begin(), system->reduction().free().end());
  for (const int c : coordinates) outputs.push_back({MuscleOutputKind::kValue, c, 0.0});
  outputs.insert(outputs.end(), study.outputs.begin(), study.outputs.end());
  const MuscleParametricModel person(*study.subject.system, study.unknowns, {segment},
                                     {.accuracy = study.accuracy, .outputs = outputs});
  const RowMatrix all = simulate_tasks(person, hidden, 1).front();
  if (all.size() == 0) return std::nullopt;
  const Motion angles = recorded_angles(study, task, all.leftCols(coordinates.size()), coordinates);
  numerics::RandomStream random(study.seed, "noise of " + task.task.name);
  std::vector<double> time;
  RowMatrix measured(all.rows(), study.outputs.size());
  Eigen::Index rows = 0;
  for (Eigen::Index k = 0; k < all.rows(); ++k) {
    if (task.time[k] < task.task.begin + study.emg->settle_s) continue;
    time.push_back(task.time[k]);
    for (std::size_t j = 0; j < study.outputs.size(); ++j)
      measured(rows, j) = all(k, coordinates.size() + j) + study.outputs[j].noise_sd * random.normal();
    ++rows;
  }
  measured.conservativeResize(rows, Eigen::NoChange);
  if (rows == 0) return std::nullopt;
  return along_angles(study, task.task.name, task.task.hold_out, angles, task.start.q, task.task.begin, std::move(time),
                      std::move(measured), recorded_envelopes(study, task.task.name, truth));
}

TaskRecordings of_person(const TaskStudy& study, Progress& progress) {
  TaskRecordings out;
  const Eigen::VectorXd hidden = hidden_values(study);
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) out.truth[study.unknowns[i].name] = hidden(i);
  const MuscleValues values = values_at(study.subject.system->muscles(), study.unknowns, hidden);
  SystemChanges changes{.muscles = muscle_parameters(study.subject.system->model())};
  for (std::size_t m = 0; m < changes.muscles.size(); ++m) changes.muscles[m].musculotendon = values.muscles[m];
  const MusculoskeletalSystem own(*study.subject.system, changes);
  progress.stage(fmt::format("a person performs {} tasks", study.tasks.size()));
  for (const PreparedTask& task : prepare_tasks(own, study.tasks, progress)) {
    if (progress.interrupted()) return out;
    if (!task.usable()) {
      out.unused.push_back(fmt::format("{}: {}", task.task.name, task.trouble));
      continue;
    }
    std::optional<TaskRecording> recorded = recorded_of_person(study, task, hidden, values);
    if (recorded)
      out.tasks.push_back(std::move(*recorded));
    else
      out.unused.push_back(fmt::format("{}: the simulated person cannot perform it", task.task.name));
  }
  return out;
}

}  // namespace

TaskRecordings emg_task_recordings(const TaskStudy& study, Progress& progress) {
  if (study.person) return of_person(study, progress);
  TaskRecordings out;
  for (const Task& task : study.tasks) {
    const EmgRecording& r = *task.recording;
    out.tasks.push_back(
        along_angles(study, task.name, task.hold_out, r.angles, r.rest, r.begin, r.time, r.measured, r.emg));
  }
  return out;
}

}  // namespace veridyn::muscle::internal
