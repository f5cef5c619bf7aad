#pragma once

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "veridyn/aircraft/reconstruction/filter_engine.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

/// What both engines of filters are tested with.
namespace veridyn::aircraft::testing {

/// Level flight to the north at 20 m/s in air at rest, everything known to the same variance.
inline internal::Start level_start() {
  internal::Start start;
  start.x.velocity = Eigen::Vector3d(20.0, 0.0, 0.0);
  start.variance.setConstant(0.01);
  return start;
}

/// Level flight: the accelerometer shows that nothing falls.
inline AirDataInput level_input() {
  AirDataInput u;
  u.specific_force = Eigen::Vector3d(0.0, 0.0, -kGravity);
  return u;
}

/// Samples that a run of the engine's filter sees of three seconds, by the streams and by the run.
struct SeenSamples {
  std::size_t recorded = 0, seen = 0;
};
inline SeenSamples seen_samples(const internal::FilterEngine& engine, const internal::FlightStreams& streams,
                                const ReconstructOptions& options, const ModelBasedMotion& motion) {
  const internal::Segment segment = internal::find_segments(streams, 1.0).at(0);
  const std::vector<double> stamps{segment.end};
  const internal::RunSetting setting{.streams = &streams, .options = &options, .motion = motion, .output_t = &stamps};
  SeenSamples samples;
  for (const internal::Sensor which : enumerators<internal::Sensor, internal::kSensors>()) {
    const bool starts_the_run = which <= internal::kVelDown;
    for (const double t : streams.sensors[which].t) {
      const bool later = starts_the_run ? t > segment.begin : t >= segment.begin;
      samples.recorded += later && t <= segment.end ? 1 : 0;
    }
  }
  const auto run = engine.innovation_run(setting, segment, internal::monitors_with(options.gate));
  while (run->advance()) samples.seen += run->innovations().size();
  return samples;
}

}  // namespace veridyn::aircraft::testing
