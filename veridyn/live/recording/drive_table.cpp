#include "veridyn/live/recording/drive_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace veridyn::live {

void DriveTable::add(const Telemetry& t) {
  const recording::MotionSample& s = t.sample;
  if (rows_ == 0) {
    offset_ = -s.time;
  } else if (t.restarted || s.time + offset_ <= last_time_) {
    offset_ = last_time_ + std::max(seconds(t.arrival - last_arrival_), 1e-3) - s.time;
  }
  last_time_ = s.time + offset_;
  last_arrival_ = t.arrival;
  ++rows_;
  const auto to = std::back_inserter(lines_);
  fmt::format_to(to, "{:.6f},", last_time_);
  if (s.steer_from != recording::Origin::kAbsent) fmt::format_to(to, "{:.6g}", s.inputs.steer);
  fmt::format_to(to, ",{:.6g}", s.speed);
  for (const double value : s.force) fmt::format_to(to, ",{:.6g}", value);
  for (const double value : s.rate) fmt::format_to(to, ",{:.6g}", value);
  lines_ += '\n';
}

std::string DriveTable::header() {
  return "# frame: flu\n"
         "time[s],steer[rad],speed[m/s],accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2],gyro_x[rad/s],gyro_y[rad/s],"
         "gyro_z[rad/s]\n";
}

std::string DriveTable::take_lines() { return std::exchange(lines_, {}); }

}  // namespace veridyn::live
