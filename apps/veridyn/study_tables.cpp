#include "apps/veridyn/study_tables.hpp"

#include <string>
#include <vector>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/vehicle/scale_study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::app {

void check_flight_tables(const StudyTable& root) {
  static_cast<void>(root.text_or("title", ""));
  static_cast<void>(root.integer_or("seed", 1));
  static_cast<void>(root.has("data"));
  static_cast<void>(aircraft::DelayAlignment::read(root.table_or_empty("delays")));
  static_cast<void>(aircraft::ReconstructOptions::read(root.table_or_empty("reconstruct")));
  static_cast<void>(aircraft::SignalOptions::read(root.table_or_empty("signals")));
  static_cast<void>(aircraft::SegmentOptions::read(root.table_or_empty("segments")));
  static_cast<void>(aircraft::IdentifyOptions::read(root.table_or_empty("identify")));
  static_cast<void>(aircraft::ValidationOptions::read(root.table_or_empty("validate")));
  static_cast<void>(aircraft::TrackOptions::read(root.table_or_empty("track")));
  static_cast<void>(aircraft::UncertaintyOptions::read(root.table_or_empty("uncertainty")));
}

void check_drive_tables(const StudyTable& root) {
  static_cast<void>(root.has("data"));
  static_cast<void>(vehicle::DriveSignalOptions::read(root.table_or_empty("signals")));
  static_cast<void>(vehicle::DriveSegmentOptions::read(root.table_or_empty("segments")));
  static_cast<void>(vehicle::VehicleIdentifyOptions::read(root.table_or_empty("identify")));
  static_cast<void>(vehicle::DriveTrackOptions::read(root.table_or_empty("track")));
  const std::vector<std::string> spans{"all", "holdout"};
  static_cast<void>(root.table_or_empty("validate").choice_or("segments", spans, "all"));
  if (root.has("scale")) static_cast<void>(vehicle::read_scale_study(root));
}

}  // namespace veridyn::app
