#include "veridyn/vehicle/vehicle_keys.hpp"

#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre_keys.hpp"
#include "veridyn/vehicle/model/subject_keys.hpp"
#include "veridyn/vehicle/road/road_study.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"
#include "veridyn/vehicle/simulation/drive_sensors.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {

namespace {

const KeyTable<recording::DataKeys>& data_keys() {
  static const auto table =
      KeyTable<recording::DataKeys>("data", "The log of a drive, or of several drives of one vehicle.")
          .with(recording::DataKeys::keys())
          .elsewhere({"frame", "", "`\"flu\"`, `\"frd\"`", "what the log says, else `flu`",
                      "axes of the log: x forward, y left, z up, or y right, z down; of a run too", true});
  return table;
}

}  // namespace

std::vector<StudyKeys> study_keys() {
  std::vector<StudyKeys> all;
  for (std::vector<StudyKeys> more :
       {subject_keys(), all_of(DriveKeys::keys()), manoeuvre_keys(), road_keys(), drive_sensor_keys(),
        all_of(ScaleRequest::keys(), data_keys(), DriveSignalOptions::keys(), DriveSegmentOptions::keys(),
               VehicleIdentifyOptions::keys(), DriveValidateOptions::keys(), DriveTrackOptions::keys())})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace veridyn::vehicle
