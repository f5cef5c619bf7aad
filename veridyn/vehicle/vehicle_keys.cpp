#include "veridyn/vehicle/vehicle_keys.hpp"

#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {

std::vector<StudyKeys> study_keys() {
  return all_of(DriveSignalOptions::keys(), DriveSegmentOptions::keys(), VehicleIdentifyOptions::keys(),
                DriveValidateOptions::keys(), DriveTrackOptions::keys());
}

}  // namespace veridyn::vehicle
