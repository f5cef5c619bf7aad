#include "veridyn/aircraft/reconstruction/guarded_replay.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using internal::ModelInUse;

/// The subject with some value for all parameters of CL, CD and CY, so that streams are loaded for all of its terms.
Subject with_any_values(Subject subject) {
  for (const Coefficient c : {Coefficient::kCL, Coefficient::kCD, Coefficient::kCY})
    if (CoefficientModel* model = subject.model.find(c)) model->values.assign(model->size(), 0.0);
  return subject;
}

}  // namespace

Recording replay_guarded(const Recording& mapped, const ReconstructOptions& options, const Subject& subject,
                         std::span<const TimedModel> models, const DrydenSettings& turbulence, Progress& progress) {
  if (options.estimates_air_data_errors()) {
    throw InputError(mapped.source,
                     "track.filter = \"guarded\" cannot estimate errors of vanes and pitot tube, which needs the whole "
                     "flight: leave them out of reconstruct.estimate");
  }
  internal::ModelStreams with_model = internal::load_model_streams(
      mapped, with_any_values(subject), internal::load_streams(mapped, options), "track.filter = \"guarded\"");
  const internal::FlightStreams& streams = with_model.streams;
  std::vector<ModelInUse> in_use;
  for (const TimedModel& m : models) {
    ModelInUse next{.from_s = m.from_s, .subject = nullptr, .error = m.error};
    if (m.aero) {
      Subject known = with_model.force_model;
      known.model = *m.aero;
      next.subject = std::make_shared<const Subject>(std::move(known));
    }
    in_use.push_back(std::move(next));
  }
  const std::vector<internal::Segment> segments = internal::find_segments(streams, options.max_gap);
  internal::OutputStamps stamps = internal::output_stamps(streams, segments, options.rate_Hz);
  const internal::SolveTask task{.streams = &streams,
                                 .options = &options,
                                 .segments = segments,
                                 .stamps = &stamps.time,
                                 .first_stamp = stamps.first,
                                 .spectrum = turbulence,
                                 .recording = &mapped};
  internal::GuardedPass pass = internal::run_guarded(task, Eigen::Matrix<double, 5, 1>::Zero(), in_use,
                                                     internal::estimated_columns(options, streams, true), progress);
  Recording out;
  out.source = mapped.source;
  out.frame = Frame::kFrd;
  if (pass.count == 0) return out;
  stamps.time.resize(pass.count);
  const TimeBase time = make_time_base(std::move(stamps.time));
  pass.filtered->move_into(out, time, pass.count);
  internal::add_guard_channels(pass.trace, time, pass.count, out);
  return out;
}

}  // namespace veridyn::aircraft
