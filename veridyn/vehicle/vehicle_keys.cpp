#include "veridyn/vehicle/vehicle_keys.hpp"

#include "veridyn/vehicle/manoeuvre/manoeuvre_keys.hpp"
#include "veridyn/vehicle/model/subject_keys.hpp"
#include "veridyn/vehicle/road/road_study.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"
#include "veridyn/vehicle/simulation/drive_sensors.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {

std::vector<StudyKeys> study_keys() {
  std::vector<StudyKeys> all;
  for (std::vector<StudyKeys> more :
       {subject_keys(), all_of(DriveKeys::keys()), manoeuvre_keys(), road_keys(), drive_sensor_keys(),
        all_of(ScaleRequest::keys(), DriveSignalOptions::keys(), DriveSegmentOptions::keys(),
               VehicleIdentifyOptions::keys(), DriveValidateOptions::keys(), DriveTrackOptions::keys())})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace veridyn::vehicle
