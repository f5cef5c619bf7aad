#include "veridyn/aircraft/aircraft_keys.hpp"

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/flight_sensitivity.hpp"
#include "veridyn/aircraft/flying_qualities/levels.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/sensors/swing_test.hpp"

namespace veridyn::aircraft {

std::vector<StudyKeys> study_keys() {
  return all_of(subject_keys(), FlightDataKeys::keys(), DelayAlignment::keys(), ReconstructOptions::keys(),
                SignalOptions::keys(), SegmentOptions::keys(), IdentifyOptions::keys(), ValidationOptions::keys(),
                TrackOptions::keys(), UncertaintyOptions::keys(), FlyingQualities::keys(), SimulationOptions::keys(),
                sensor_keys(), known_sensor_keys(), FlightSensitivityOptions::keys());
}

std::vector<StudyKeys> swing_test_keys() { return all_of(SwingTest::keys()); }

std::vector<StudyKeys> calibration_keys() { return all_of(CalibrationStudy::keys()); }

}  // namespace veridyn::aircraft
