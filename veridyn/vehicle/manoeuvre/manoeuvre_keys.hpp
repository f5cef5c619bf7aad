#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/manoeuvre/driver_model.hpp"

namespace veridyn::vehicle {

// The keys of `[drive]` for each manoeuvre; angles are those of the road wheels, in SI as everywhere.

struct StepSteerKeys {
  double amplitude = 2.0 * kDegree, start = 1.0, rise_time = 0.1;
  [[nodiscard]] static const KeyTable<StepSteerKeys>& keys();
};
struct SineKeys {
  double amplitude = 2.0 * kDegree, start = 1.0, frequency = 0.5;
  [[nodiscard]] static const KeyTable<SineKeys>& keys();
};
struct ContinuousSineKeys : SineKeys {
  int periods = 3;
  [[nodiscard]] static const KeyTable<ContinuousSineKeys>& keys();
};
struct SineWithDwellKeys {
  double amplitude = 2.0 * kDegree, start = 1.0, frequency = 0.7, dwell = 0.5;
  [[nodiscard]] static const KeyTable<SineWithDwellKeys>& keys();
};
struct RampSteerKeys {
  double amplitude = 5.0 * kDegree, start = 1.0, rate = kDegree, hold = 2.0;
  [[nodiscard]] static const KeyTable<RampSteerKeys>& keys();
};
struct FishhookKeys {
  double amplitude = 2.0 * kDegree, start = 1.0, rate = 0.75, dwell = 0.25;
  [[nodiscard]] static const KeyTable<FishhookKeys>& keys();
};
/// Of a sweep too.
struct RandomSteerKeys {
  double amplitude = 2.0 * kDegree, start = 1.0, low = 0.1, high = 4.0, length = 60.0;
  std::optional<std::uint64_t> seed = {};  ///< not of a sweep
  [[nodiscard]] static const KeyTable<RandomSteerKeys>& sweep_keys();
  [[nodiscard]] static const KeyTable<RandomSteerKeys>& keys();
};
struct CircleKeys {
  bool constant_radius = false;
  double amplitude = 2.0 * kDegree, start = 1.0, rate = 0.2 * kDegree;  ///< at constant speed
  double radius = kNaN, end_speed = kNaN, length = 120.0;               ///< of constant radius
  PreviewDriverOptions driver = {};
  [[nodiscard]] static const KeyTable<CircleKeys>& keys();
};
/// Of a double lane change and of obstacle avoidance too.
struct ConesKeys {
  double vehicle_width = 0.0;  ///< 0: 7/6 of the track
  double course_scale = 1.0;   ///< not of a slalom
  int cones = 8;               ///< of a slalom, as what follows
  double spacing = 18.0, clearance = 0.5;
  double front_overhang = 0.0, rear_overhang = 0.0;
  PreviewDriverOptions driver = {};
  [[nodiscard]] static const KeyTable<ConesKeys>& course_keys();
  [[nodiscard]] static const KeyTable<ConesKeys>& slalom_keys();
};
struct BrakingInATurnKeys {
  double radius = 100.0, deceleration = 4.0, brake_time = 15.0;
  PreviewDriverOptions driver = {};
  [[nodiscard]] static const KeyTable<BrakingInATurnKeys>& keys();
};
struct FollowPathKeys {
  std::optional<std::filesystem::path> file = {};
  double radius = kNaN;
  int side = 1;  ///< of a circle: 1 left, -1 right
  PreviewDriverOptions driver = {};
  [[nodiscard]] static const KeyTable<FollowPathKeys>& keys();
};
struct SignalKeys {
  std::optional<std::filesystem::path> file = {};
  std::vector<double> time = {}, steer = {};
  [[nodiscard]] static const KeyTable<SignalKeys>& keys();
};

/// What drives and brakes, whatever steers.
struct TorqueKeys {
  bool hold_speed = false;
  std::optional<double> target_speed = {};
  std::vector<double> torque_time = {}, drive_torque = {}, brake_torque = {};
  [[nodiscard]] static const KeyTable<TorqueKeys>& keys();
};

/// All of them, each with the manoeuvres that it is of.
[[nodiscard]] std::vector<StudyKeys> manoeuvre_keys();

}  // namespace veridyn::vehicle
