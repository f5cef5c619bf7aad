#include "tests/aircraft/campaign/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft::testing {
namespace {

using estimation::Parameter;
using estimation::ParameterStatus;
using numerics::RandomStream;

/// A built-in aircraft with other coefficients. Beyond stall it goes on as its terms say.
Subject drawn_subject(std::uint64_t number) {
  const std::vector<std::string> names = builtin_subject_names();
  RandomStream random(number, "calibration subject");
  Subject s = builtin_subject(names[number % names.size()]);
  s.model.stall.reset();
  for (auto& coefficient : s.model.coefficients) {
    if (!coefficient) continue;
    for (double& value : coefficient->values) value *= random.uniform(0.8, 1.2);
  }
  return s;
}

void draw_downwash(Subject& s, RandomStream& random) {
  const double share = random.uniform(0.2, 0.45), arm = random.uniform(2.0, 4.0);
  const auto q = [&](Coefficient c) {
    const CoefficientModel* model = s.model.find(c);
    return model != nullptr ? model->value_of("q_n").value_or(0.0) : 0.0;
  };
  s.downwash = {.CL_alphadot = share * q(Coefficient::kCL),
                .Cm_alphadot = share * q(Coefficient::kCm),
                .tail_arm = arm * s.chord};
}

void draw_actuators(Subject& s, bool lag, bool play, RandomStream& random) {
  for (Actuator* a : {&s.elevator, &s.aileron, &s.rudder}) {
    const double time_constant = random.uniform(0.02, 0.08), limit = random.uniform(3.0, 6.0),
                 free_play = random.uniform(0.2, 0.6) * kDegree;
    if (lag) a->time_constant = time_constant, a->rate_limit = limit;
    if (play) a->free_play = free_play;
  }
}

/// Of `[sensors]`.
std::string drawn_sensors(const auto& has, RandomStream& random) {
  std::string text;
  for (const char* vane : {"alpha_vane", "beta_vane"}) {
    const double frequency = kFullTurn * random.uniform(4.0, 10.0), damping = random.uniform(0.3, 0.7),
                 delay = random.uniform(0.0, 0.03), scale = 0.03 * random.normal(),
                 zero = 0.5 * kDegree * random.normal();
    text += fmt::format("[sensors.{}]\n", vane);
    if (has(Effect::kVaneLag))
      text += fmt::format("frequency = {}\ndamping = {}\ndelay = {}\n", frequency, damping, delay);
    if (has(Effect::kVaneScale)) text += fmt::format("scale = {}\nbias = {}\n", scale, zero);
    if (has(Effect::kJitter)) text += "jitter = 0.002\n";
  }
  const double scale = 0.02 * random.normal(), zero = 5.0 * random.normal(), delay = random.uniform(0.05, 0.25);
  text += "[sensors.pitot]\n";
  if (has(Effect::kPitot)) text += fmt::format("scale = {}\nbias = {}\n", scale, zero);
  if (has(Effect::kJitter)) text += "jitter = 0.002\n";
  text += "[sensors.gps_velocity]\n";
  if (has(Effect::kGpsDelay)) text += fmt::format("delay = {}\n", delay);
  if (has(Effect::kJitter)) {
    text += "jitter = 0.002\n";
    for (const char* other : {"accelerometer", "gyro", "ahrs", "servos"})
      text += fmt::format("[sensors.{}]\njitter = 0.002\n", other);
  }
  return text;
}

std::string manoeuvres(RandomStream& random) {
  std::string text;
  double start = 10.0;
  for (int round = 0; round < 2; ++round) {
    for (const char* kind : {"3211", "doublet"}) {
      for (const char* surface : {"elevator", "aileron", "rudder"}) {
        text += fmt::format("[[flight.manoeuvre]]\nkind = \"{}\"\nstart = {}\npulse = {}\nsurfaces = [\"{}\"]\n", kind,
                            start, random.uniform(0.35, 0.8), surface);
        start += 11.0;
      }
    }
  }
  return text;
}

/// Of the terms of a coefficient.
std::string class_of(const std::string& parameter) {
  const auto ends = [&](std::initializer_list<const char*> endings) {
    return std::ranges::any_of(endings, [&](const char* e) { return parameter.ends_with(e); });
  };
  if (ends({"_0"})) return "constants";
  if (ends({"_alpha", "_beta"})) return "alpha, beta";
  if (ends({"_p", "_q", "_r"})) return "p, q, r";
  if (ends({"_de", "_da", "_dr"})) return "controls";
  return "others";
}
constexpr std::array kClasses{"constants", "alpha, beta", "p, q, r", "controls", "others"};

std::string percent(std::size_t some, std::size_t all) {
  return all == 0 ? "-" : fmt::format("{:.0f} %", 100.0 * static_cast<double>(some) / static_cast<double>(all));
}

}  // namespace

std::optional<FlightStudy> drawn_flight(Effect effect, std::string_view air, std::uint64_t number) {
  const auto has = [effect](Effect e) { return effect == e || effect == Effect::kAll; };
  Subject truth = drawn_subject(number);
  RandomStream random(number, "calibration");
  if (has(Effect::kDownwash)) draw_downwash(truth, random);
  draw_actuators(truth, has(Effect::kActuators), has(Effect::kFreePlay), random);
  if (has(Effect::kImuPlace))
    for (double& x : truth.imu_position) x = 0.05 * random.normal();
  std::string text = fmt::format(
      "seed = {}\n{}\n[flight]\nduration = 150\naltitude = 300\nwind = [{}, {}, 0]\n"
      "turbulence = \"{}\"\n",
      5000 + number, write_subject_toml(truth), 4.0 * random.normal(), 4.0 * random.normal(), air);
  if (has(Effect::kGustGradients)) text += "gust_gradients = true\n";
  if (has(Effect::kActuators)) text += "log_commands = true\n";
  if (has(Effect::kLostRows)) text += "lost_rows = 0.2\n";
  text += manoeuvres(random) + drawn_sensors(has, random);
  Progress silent;
  try {
    FlightStudy study = read_study(Study::parse(text, "drawn.toml"), silent);
    // Who identifies knows mass, geometry and structure.
    study.subject.downwash = {};
    study.subject.imu_position = {};
    for (Actuator* a : {&study.subject.elevator, &study.subject.aileron, &study.subject.rudder})
      *a = {.lower = a->lower, .upper = a->upper};
    for (auto& coefficient : study.subject.model.coefficients)
      if (coefficient) std::ranges::fill(coefficient->values, kNaN);
    return study;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void Calibration::add(const Identified& flight) {
  ++flights_;
  if (flight.refused) {
    refusals_.push_back(flight.message);
    return;
  }
  const bool data_yes = flight.analysis.estimate.judgement.data.grade == estimation::Grade::kYes;
  data_yes_ += data_yes ? 1 : 0;
  of_flights_.emplace_back();
  for (const estimation::ParameterGroup& group : flight.analysis.groups) {
    for (const Parameter& p : group.parameters) {
      if (p.status != ParameterStatus::kIdentified && p.status != ParameterStatus::kInsignificant &&
          p.status != ParameterStatus::kWeak)
        continue;
      const auto truth = flight.analysis.truth.find(p.name);
      if (truth == flight.analysis.truth.end()) continue;
      const bool held = all_.add(p, truth->second);
      lines_.push_back(fmt::format("{},{},{},{:.5g},{:.3g},{:.5g},{}", flights_ + lost_, p.name,
                                   estimation::to_string(p.status), p.value, 0.5 * (p.high95 - p.low95), truth->second,
                                   held ? 1 : 0));
      classes_[class_of(p.name)].add(held);
      of_flights_.back().add(held);
      if (data_yes && group.judgement.parameters.grade == estimation::Grade::kYes) graded_yes_.add(held);
    }
  }
}

double Calibration::coverage_sigma() const {
  double sum = 0.0;
  for (const Count& flight : of_flights_)
    sum += std::pow(static_cast<double>(flight.held) - coverage() * static_cast<double>(flight.intervals), 2.0);
  return std::sqrt(sum) / static_cast<double>(intervals());
}

double Calibration::confidently_wrong() const {
  return static_cast<double>(all_.wrong()) / static_cast<double>(all_.identified());
}

double Calibration::width_over_error() const { return all_.median_half_width() / all_.median_error(); }

std::string Calibration::heading() {
  std::string text =
      "| effect | flights (lost, refused) | data yes | intervals | hold the truth | of those graded yes |";
  std::string line = "|---|---|---|---|---|---|";
  for (const char* name : kClasses) text += fmt::format(" {} |", name), line += "---|";
  return text + " identified, 10 % off and outside | ranks, chi-square of 9 | half width over error |\n" + line +
         "---|---|---|\n";
}

std::string Calibration::row(std::string_view name) const {
  std::string text =
      fmt::format("| {} | {} ({}, {}) | {} | {} | {:.0f} +- {:.0f} % | {} of {} |", name, flights_, lost_,
                  refusals_.size(), percent(data_yes_, flights_), intervals(), 100.0 * coverage(),
                  100.0 * coverage_sigma(), percent(graded_yes_.held, graded_yes_.intervals), graded_yes_.intervals);
  for (const char* one : kClasses) {
    const auto found = classes_.find(one);
    text += fmt::format(" {} |", found == classes_.end() ? "-" : percent(found->second.held, found->second.intervals));
  }
  return text + fmt::format(" {} of {} | {:.0f} | {:.2f} |\n", all_.wrong(), all_.identified(), all_.rank_chi_square(),
                            width_over_error());
}

}  // namespace veridyn::aircraft::testing
