#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/support/interval_count.hpp"
#include "veridyn/core/enum_array.hpp"

/// Simulation-based calibration (Talts et al. 2018): aircraft, air, manoeuvres and errors of sensors are drawn from
/// stated priors, flown and identified with default options; intervals of 95 % hold the truth in 95 of 100, and its
/// ranks in the distributions that calibrated intervals stand for are uniform.
namespace veridyn::aircraft::testing {

/// What an aircraft or its log has beyond the model that is identified. The study is told of none of it.
enum class Effect {
  kNone,
  kGustGradients,
  kDownwash,   ///< Cm_alphadot and CL_alphadot 0.2 to 0.45 of the terms of q, a tail 2 to 4 chords behind
  kVaneLag,    ///< 4 to 10 Hz, damping ratio 0.3 to 0.7, and 0 to 30 ms late
  kVaneScale,  ///< 3 %, zero 0.5 deg (standard deviations)
  kPitot,      ///< scale 2 %, zero 5 Pa (standard deviations)
  kGpsDelay,   ///< 0.05 to 0.25 s
  kActuators,  ///< commands are logged; lag of 20 to 80 ms, 3 to 6 rad/s
  kFreePlay,   ///< 0.2 to 0.6 deg
  kJitter,     ///< 2 ms of every sensor's stamps
  kLostRows,   ///< 20 %
  kImuPlace,   ///< 5 cm along each axis (standard deviation)
  kAll
};
inline constexpr std::size_t kEffects = 13;  ///< values of Effect
inline constexpr EnumArray<Effect, std::string_view, kEffects> kEffectNames{
    {"none", "gust gradients", "downwash lag", "vanes lag", "vanes' scale and zero", "pitot's scale and zero",
     "GPS late", "servos lag, commands logged", "free play", "jitter of stamps", "20 % of rows lost",
     "accelerometer's place", "all of it"}};

/// Calm, light and moderate, at low altitude.
inline constexpr std::array<std::string_view, 3> kAir{"none", "low_light", "low_moderate"};

/// Flight `number` of its kind: 150 s with 3-2-1-1 and doublets of each surface, twice, by a built-in aircraft whose
/// coefficients are changed by up to 20 % each. None where the pilot loses it.
[[nodiscard]] std::optional<FlightStudy> drawn_flight(Effect effect, std::string_view air, std::uint64_t number);

/// What became of the intervals of many flights.
class Calibration {
 public:
  /// Parameters with an interval that is meant as such: identified, insignificant or weak.
  void add(const Identified& flight);
  /// A flight that could not be flown.
  void add_lost() { ++lost_; }

  [[nodiscard]] std::size_t flights() const { return flights_; }
  [[nodiscard]] const std::vector<std::string>& refusals() const { return refusals_; }
  [[nodiscard]] std::size_t intervals() const { return all_.intervals(); }
  /// Share of intervals that hold the truth.
  [[nodiscard]] double coverage() const { return all_.coverage(); }
  /// Its standard error: flights are independent, the parameters of one are not.
  [[nodiscard]] double coverage_sigma() const;
  /// Share of identified parameters that are more than 10 % off and outside of their interval.
  [[nodiscard]] double confidently_wrong() const;
  /// Median of half widths over median of errors, both as shares of the truth: 2.9 for normal errors.
  [[nodiscard]] double width_over_error() const;
  /// "| name | flights | ... |", with the heading that belongs to it.
  [[nodiscard]] std::string row(std::string_view name) const;
  [[nodiscard]] static std::string heading();
  /// A line for each interval: flight, parameter, status, value, half width, truth, whether it holds.
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  struct Count {
    std::size_t intervals = 0, held = 0;
    void add(bool holds) {
      ++intervals;
      held += holds ? 1 : 0;
    }
  };
  std::size_t flights_ = 0, lost_ = 0, data_yes_ = 0;
  std::vector<std::string> refusals_, lines_;
  std::map<std::string, Count> classes_;
  Count graded_yes_;  ///< data and the group's parameters
  std::vector<Count> of_flights_;
  test::IntervalCount all_;
};

}  // namespace veridyn::aircraft::testing
