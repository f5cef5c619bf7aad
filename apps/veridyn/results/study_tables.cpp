#include "apps/veridyn/results/study_tables.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/scale_study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::app {

void finish_flight_study(const StudyTable& root) {
  static_cast<void>(root.text_or("title", ""));
  static_cast<void>(root.integer_or("seed", 1));
  if (root.has("data")) {
    const StudyTable data = root.table("data");
    recording::check_study_data(data, aircraft::standard_channels());
    static_cast<void>(aircraft::FlightDataKeys::keys().read(data));
  }
  static_cast<void>(aircraft::DelayAlignment::keys().read(root.table_or_empty("delays")));
  static_cast<void>(aircraft::ReconstructOptions::keys().read(root.table_or_empty("reconstruct")));
  static_cast<void>(aircraft::SignalOptions::keys().read(root.table_or_empty("signals")));
  static_cast<void>(aircraft::SegmentOptions::keys().read(root.table_or_empty("segments")));
  static_cast<void>(aircraft::IdentifyOptions::keys().read(root.table_or_empty("identify")));
  static_cast<void>(aircraft::ValidationOptions::keys().read(root.table_or_empty("validate")));
  static_cast<void>(aircraft::TrackOptions::keys().read(root.table_or_empty("track")));
  static_cast<void>(aircraft::UncertaintyOptions::keys().read(root.table_or_empty("uncertainty")));
  static_cast<void>(aircraft::FlyingQualities::keys().read(root.table_or_empty("flying_qualities")));
  root.accept("sensitivity");
  root.finish();
}

void finish_drive_study(const StudyTable& root, const Progress& progress, DriveTables read) {
  static_cast<void>(root.text_or("title", ""));
  static_cast<void>(root.integer_or("seed", 1));
  static_cast<void>(vehicle::read_vehicle(root.table("subject"), vehicle::VehicleNeeds::kGeometry));
  if (root.has("data")) {
    const StudyTable data = root.table("data");
    recording::check_study_data(data, vehicle::standard_drive_channels());
    static_cast<void>(data.text_or("frame", ""));
    for (const StudyTable& run : data.tables("run")) static_cast<void>(run.text_or("frame", ""));
  }
  static_cast<void>(vehicle::DriveSignalOptions::keys().read(root.table_or_empty("signals")));
  static_cast<void>(vehicle::DriveSegmentOptions::keys().read(root.table_or_empty("segments")));
  static_cast<void>(vehicle::VehicleIdentifyOptions::keys().read(root.table_or_empty("identify")));
  static_cast<void>(vehicle::DriveTrackOptions::keys().read(root.table_or_empty("track")));
  static_cast<void>(vehicle::DriveValidateOptions::keys().read(root.table_or_empty("validate")));
  const auto check = [&](const auto& reader, std::initializer_list<const char*> tables) {
    try {
      static_cast<void>(reader(root));
    } catch (const InputError&) {
      if (!names_recording(root)) throw;
      for (const char* table : tables) root.accept(table);
    }
  };
  const auto simulation = [&](const StudyTable& t) { return vehicle::read_simulation_study(t, progress); };
  const auto scale = [&](const StudyTable& t) { return vehicle::read_scale_study(t, progress); };
  const bool drives = root.has("drive") || root.has("road") || root.has("sensors");
  if (read == DriveTables::kNone && drives) check(simulation, {"drive", "road", "sensors"});
  if (read != DriveTables::kScale && root.has("scale")) check(scale, {"drive", "road", "sensors", "scale"});
  root.accept("sensitivity");
  root.finish();
}

bool names_recording(const StudyTable& root) {
  if (!root.has("data")) return false;
  const StudyTable data = root.table("data");
  return data.has("file") || data.has("files") || data.has("runs");
}

}  // namespace veridyn::app
