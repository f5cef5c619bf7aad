// Rain sets in during a drive: the stiffness of a car's tyres is followed on line, and the change raises an alarm.
//
// The estimate at each moment knows nothing of what comes later, so the same runs beside a car as it drives: hand
// TrackedDrive::advance what has been recorded so far.
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

#include "picture.hpp"
#include "veridyn/vehicle.hpp"

int main() try {
  using namespace veridyn;
  constexpr double kRain = 60.0, kGrip = 0.6;  // from then on the tyres keep this share of their stiffness
  const Study study = Study::parse(R"(
    seed = 3
    [subject]
    kind = "vehicle"
    builtin = "reference"
    [drive]
    model = "bicycle"
    manoeuvre = "random steer"
    amplitude = "2 deg"
    low = 0.1
    high = 2.0
    length = 120
    speed = "20 m/s"
    [track]
    learning = 0      # this car's body does not lean; else it is learned from the drive's beginning
    [[drive.change]]
    time = 60
    grip = 0.6
    [sensors]
    set = "reference"
  )",
                                   "example 10");
  Progress silent;
  const vehicle::SimulationStudy simulation = vehicle::read_simulation_study(study.root(), silent);
  const vehicle::SimulationRun run = vehicle::run_simulation_study(simulation, silent);
  const vehicle::VehicleStudy drive = vehicle::read_study(study, run.measured.value(), silent);

  const vehicle::DriveTracking tracking = vehicle::track(drive, silent);
  const vehicle::DriveTracker& tracker = *tracking.drive.tracker();
  const double dry = simulation.vehicle.parameters.C_f;
  const vehicle::DriveTrackHistory& history = tracker.history(vehicle::TrackedAxle::kFront);
  std::vector<double> time, value, low, high, truth;
  for (std::size_t k = 0; k < history.time.size(); ++k) {
    if (!std::isfinite(history.sigma[k])) continue;  // not usable yet
    time.push_back(history.time[k]);
    value.push_back(1e-3 * history.value[k]);
    low.push_back(1e-3 * (history.value[k] - 1.96 * history.sigma[k]));
    high.push_back(1e-3 * (history.value[k] + 1.96 * history.sigma[k]));
    truth.push_back(1e-3 * dry * (history.time[k] < kRain ? 1.0 : kGrip));
  }
  picture::write("10_track_a_car.csv", {{"time[s]", time},
                                        {"C_f[kN/rad]", value},
                                        {"low[kN/rad]", low},
                                        {"high[kN/rad]", high},
                                        {"truth[kN/rad]", truth}});

  bool alarm = false;
  for (const vehicle::DriveChange& c : tracker.changes()) {
    std::printf("%6.1f s: %s changed, it began at about %.1f s\n", c.change.detected_s,
                std::string(vehicle::kTrackedAxleNames[c.axle]).c_str(), c.change.began_s);
    if (c.change.detected_s < kRain) return 1;  // nothing had changed
    alarm = alarm || c.change.detected_s < kRain + 15.0;
  }
  std::printf("C_f at the end: %.1f kN/rad +- %.1f, true %.1f\n", value.back(), high.back() - value.back(),
              truth.back());
  return alarm && truth.back() > low.back() && truth.back() < high.back() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
