#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/live/telemetry/packet_intake.hpp"

namespace veridyn::live {

/// The drive of a car as its sensors reported it, as our CSV in frame flu with the standard names of drives, so that
/// `veridyn identify` and `veridyn track` read it: time, steer (of the road wheels), speed (rear wheels), accel_x|y|z
/// (gravity in), gyro_x|y|z. Time is that of the car's clock from its first report; where the car began again it goes
/// on by the time that passed on ours.
class DriveTable {
 public:
  void add(const Telemetry& telemetry);
  [[nodiscard]] std::size_t rows() const { return rows_; }

  /// The first lines, to be written once.
  [[nodiscard]] static std::string header();
  /// Whole lines of what was added since the last call.
  [[nodiscard]] std::string take_lines();

 private:
  std::string lines_;
  std::size_t rows_ = 0;
  double offset_ = 0.0;  ///< of the table's time against the car's [s]
  double last_time_ = 0.0;
  Nanoseconds last_arrival_ = 0;
};

}  // namespace veridyn::live
