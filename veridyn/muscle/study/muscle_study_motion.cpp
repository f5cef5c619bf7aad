// The motion that a muscle study follows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

/// By coordinate.
std::vector<std::vector<Ramp>> read_ramps(const StudyTable& motion, const MuscleStudy& study) {
  const Model& model = study.system->model();
  const StudyTable pose = motion.table_or_empty("start");
  std::vector<std::vector<Ramp>> ramps(model.coordinates.size());
  for (const StudyTable& table : motion.tables("ramp")) {
    const std::string name = table.text("coordinate");
    const std::size_t c = coordinate_of(table, "coordinate", name, model);
    const Coordinate& coordinate = model.coordinates[c];
    check_not_coupled(table, "coordinate", c, study);
    if (study.motion.coordinate[c]) table.fail("coordinate", fmt::format("'{}' has its motion from motion.file", name));
    if (study.method == MuscleMethod::kComputedMuscleControl &&
        study.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kDriven) {
      table.fail("coordinate", fmt::format("'{}' is locked and cannot follow a ramp; motion.start sets it", name));
    }
    const Ramp* before = ramps[c].empty() ? nullptr : &ramps[c].back();
    const RampOrigin origin{.before = before,
                            .rest = study.start.q(c),
                            .rest_is_given = pose.has(name),
                            .rest_key = "motion.start",
                            .begin = study.begin};
    ramps[c].push_back(read_ramp(table, coordinate, origin));
  }
  return ramps;
}

}  // namespace

Ramp read_ramp(const StudyTable& table, const Coordinate& coordinate, const RampOrigin& origin) {
  const Ramp* before = origin.before;
  Ramp ramp{.start = before != nullptr ? before->start + before->duration : origin.begin};
  ramp_keys().read(table, ramp);
  ramp.from = before != nullptr ? before->to : origin.rest;
  if (table.has("from")) {
    const double from = coordinate_value(table, "from", coordinate);
    if ((before != nullptr || origin.rest_is_given) && std::abs(from - ramp.from) > 1e-9) {
      const std::string where = before != nullptr ? "after the ramp before" : fmt::format("by {}", origin.rest_key);
      table.fail("from", fmt::format("{:.6g} {} jumps: {} it is at {:.6g}", from, coordinate.unit(), where, ramp.from));
    }
    ramp.from = from;
  }
  ramp.to = coordinate_value(table, "to", coordinate);
  if (before != nullptr && !(ramp.start >= before->start + before->duration - 1e-12)) {
    table.fail("start", fmt::format("{:g} s is before the end of the ramp before, {:g} s", ramp.start,
                                    before->start + before->duration));
  }
  if (before != nullptr) ramp.start = std::max(ramp.start, before->start + before->duration);
  return ramp;
}

DesiredMotion read_desired_motion(const StudyTable& motion, const MuscleStudy& study) {
  const Model& model = study.system->model();
  DesiredMotion desired{.motion = study.motion, .coordinates = {}};
  const std::vector<std::vector<Ramp>> ramps = read_ramps(motion, study);
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    std::optional<numerics::PiecewisePolynomial>& own = desired.motion.coordinate[c];
    if (!ramps[c].empty()) own = ramp_spline(ramps[c]);
    if (study.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kCoupled) continue;
    if (own) {
      desired.coordinates.push_back(model.coordinates[c].name);
    } else {
      own = resting_spline(study.start.q(c));
    }
  }
  if (desired.coordinates.empty()) {
    motion.fail("", fmt::format("method = \"{}\" needs a motion: file = \"x.mot\" or [[motion.ramp]]",
                                method_name(study.method)));
  }
  desired.motion.missing.clear();
  desired.motion.begin = std::min(desired.motion.begin, study.begin);
  desired.motion.end = std::max(desired.motion.end, study.end);
  return desired;
}

}  // namespace veridyn::muscle::internal
