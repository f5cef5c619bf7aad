#include "veridyn/live/page/status_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "veridyn/io/results/json_text.hpp"

namespace veridyn::live {

using nlohmann::json;

namespace {

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
json number(const std::optional<Nanoseconds>& time) { return time ? json(seconds(*time)) : json(nullptr); }

std::string_view name_of(CarState state) {
  switch (state) {
    case CarState::kHolding:
      return "holding";
    case CarState::kDriving:
      return "driving";
    case CarState::kBraking:
      break;
  }
  return "braking by itself";
}

json car_json(const CarStatus& car, const LatencyHistogram& pedal_to_command) {
  const LinkQuality& link = car.link;
  return {{"connected", link.connected},
          {"state", car.state ? std::string(name_of(*car.state)) : "not heard of"},
          {"battery", car.state ? number(car.battery) : json(nullptr)},
          {"restarts", car.restarts},
          {"commands", link.commands_sent},
          {"command_loss", link.command_loss()},
          {"reports", link.reports_received},
          {"report_loss", link.report_loss()},
          {"damaged", link.frames_damaged},
          {"since_report", number(link.since_report)},
          {"round_trip_p50", number(link.round_trip_median)},
          {"round_trip_p99", number(link.round_trip_p99)},
          {"pedal_to_command_p99", number(pedal_to_command.quantile(0.99))},
          {"steering", car.command.steering},
          {"drive_force", car.command.drive_force},
          {"brake", car.command.brake}};
}

}  // namespace

std::string status_json(const RigStatus& status, const LiveStudy& study, const FeltNow& felt,
                        cueing::WashoutDesign& design, double time, const std::string& message) {
  json j;
  j["title"] = study.cueing.title;
  j["time"] = time;
  j["state"] = std::string(name_of(status.step.state));
  j["readiness"] = described(status.readiness, status.answers);
  j["share"] = status.step.share;
  j["message"] = message;
  for (std::size_t i = 0; i < cueing::kPlatformAxes; ++i) {
    const auto which = static_cast<cueing::PlatformAxis>(i);
    const cueing::AxisLimits& l = study.cueing.platform.limits.axes[i];
    if (!l.moves()) continue;
    const cueing::AxisState ordered = axis(status.step.cueing.ordered, which);
    j["axes"].push_back(
        {{"name", std::string(name_of(which))},
         {"turns", turns(which)},
         {"lowest", l.lowest},
         {"highest", l.highest},
         {"ordered", ordered.position},
         {"to_limit", std::min(ordered.position - l.lowest, l.highest - ordered.position)},
         {"range_used", ordered.position < 0.0 ? ordered.position / l.lowest : ordered.position / l.highest},
         {"rate_used", std::abs(ordered.rate) / l.rate},
         {"reached", study.options.answers ? static_cast<double>(status.answers.reached[i])
                                           : axis(status.step.cueing.reached, which).position},
         {"limited", static_cast<bool>(status.step.cueing.limited[i])}});
  }
  if (status.step.motion) {
    // In the vehicle, and on the platform: what the rider's accelerometer shows, forward, right, down.
    const recording::MotionSample v = recording::in_frame(status.step.motion->sample, Frame::kFrd);
    const recording::MotionSample r = rider_motion(status.step.cueing.reached, study.cueing.platform.rider);
    j["vehicle"] = {v.force.x(), v.force.y(), v.force.z()};
    j["rider"] = {r.force.x(), r.force.y(), r.force.z()};
    j["speed"] = v.speed;
  }
  for (std::size_t i = 0; felt.now() && i < cueing::kCues; ++i) {
    const auto cue = static_cast<cueing::Cue>(i);
    j["felt"].push_back({{"name", std::string(name_of(cue))},
                         {"turns", cue >= cueing::Cue::kRoll},
                         {"vehicle", felt.now()->vehicle[cue]},
                         {"rider", felt.now()->rider[cue]},
                         {"threshold", felt.threshold()[cue]}});
  }
  for (std::size_t i = 0; i < kPacketStatuses; ++i)
    j["packets"].push_back(
        {{"name", std::string(name_of(static_cast<PacketStatus>(i)))}, {"count", status.packets[i]}});
  const LatencyHistogram& h = status.times.receive_to_send;
  json bins = json::array();
  for (std::size_t i = 0; i + 1 < LatencyHistogram::kBins; ++i) {
    if (h.bins()[i] > 0) bins.push_back({LatencyHistogram::upper_edge(i), h.bins()[i]});
  }
  j["latency"] = {{"bins", bins},
                  {"p50", h.quantile(0.5)},
                  {"p99", h.quantile(0.99)},
                  {"wait_p99", status.times.wait.quantile(0.99)},
                  {"work_p99", status.times.work.quantile(0.99)}};
  j["extrapolated"] = {{"steps", status.extrapolated.steps}, {"of", status.extrapolated.of}};
  j["orders"] = status.times.steps;
  j["left_out"] = status.times.left_out;
  if (status.car) j["car"] = car_json(*status.car, status.times.pedal_to_command);
  std::size_t index = 0;
  for (const cueing::Knob& knob : design.knobs()) {
    for (std::size_t k = 0; k < knob.values.size(); ++k) {
      j["knobs"].push_back({{"index", index++},
                            {"name", knob.values.size() > 1 ? knob.name + " " + std::to_string(k + 1) : knob.name},
                            {"unit", knob.unit},
                            {"value", knob.values[k]},
                            {"feel", knob.feel}});
    }
  }
  return io::json_text(j);
}

}  // namespace veridyn::live
