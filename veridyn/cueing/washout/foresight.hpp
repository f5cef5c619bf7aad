#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing {

/// The future in steps that grow by a tenth each: the next moments matter most, and a platform that tilts slowly needs
/// to know what comes in some seconds.
inline constexpr std::size_t kForeseenSteps = 24;
/// The first one [s].
inline constexpr double kFirstForeseenStep = 0.05;
/// Where the steps begin, and where the last one ends [s].
inline constexpr std::array<double, kForeseenSteps + 1> kForeseenTimes = [] {
  std::array<double, kForeseenSteps + 1> times = {};
  double step = kFirstForeseenStep;
  for (std::size_t k = 0; k < kForeseenSteps; ++k, step *= 1.1) times[k + 1] = times[k] + step;
  return times;
}();
/// The middle of a step [s].
[[nodiscard]] constexpr double foreseen_middle(std::size_t k) {
  return 0.5 * (kForeseenTimes[k] + kForeseenTimes[k + 1]);
}

/// Specific forces at the driver's head as something else than the present sample knows them, frd [m/s^2]. What it
/// knows of the present is there too: by how much that is wrong is foreseen to die away.
struct Foreseen {
  Eigen::Vector3d now = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, kForeseenSteps> then = {};  ///< in the middles of the steps
};

/// What a vehicle will do next, for algorithms that plan ahead. A plain state: after construction nothing is allocated
/// or thrown.
class Foresight {
 public:
  virtual ~Foresight() = default;
  virtual void reset() = 0;
  /// Looks ahead from a sample. @param sample at the driver's head, frame frd, its values finite
  /// @param step since the last look [s]
  /// @return whether anything is foreseen; if not, `foreseen` is as it was
  virtual bool look(const recording::MotionSample& sample, double step, Foreseen& foreseen) = 0;
  [[nodiscard]] virtual std::unique_ptr<Foresight> clone() const = 0;
  /// What is foreseen from: "the lap".
  [[nodiscard]] virtual std::string from() const = 0;

 protected:
  Foresight() = default;
  Foresight(const Foresight&) = default;
  Foresight& operator=(const Foresight&) = default;
};

/// How far forces that were foreseen half a second ahead missed those that came, alongside a present force that was
/// expected to stay.
class ForesightAccount {
 public:
  void reset() { *this = {}; }
  /// @param force now, along an axis [m/s^2]; @param expected `kAhead` from now, by the foresight; @param foreseen
  /// whether there was any
  void add(double force, double expected, bool foreseen, double step);
  /// "the lap foresaw 97 % of the time; forces 0.52 s ahead were missed by 1.2 m/s^2 RMS, held ones by 1.9"; nothing
  /// before the first second. @param from see `Foresight::from`
  [[nodiscard]] std::string text(const std::string& from) const;
  /// Root of the mean squares [m/s^2]; 0 where nothing was foreseen.
  [[nodiscard]] double missed() const;
  [[nodiscard]] double missed_held() const;
  /// Share of the time in which anything was foreseen.
  [[nodiscard]] double share() const { return time_ > 0.0 ? foreseen_time_ / time_ : 0.0; }

  /// Step of the future that is looked at, and how far its middle is away [s].
  static constexpr std::size_t kStep = 7;
  static constexpr double kAhead = foreseen_middle(kStep);

 private:
  struct Expected {
    double due = 0.0, force = 0.0, held = 0.0;
  };
  static constexpr std::size_t kKept = 128;
  static constexpr double kBetween = 0.01;  // [s]
  std::array<Expected, kKept> kept_ = {};
  std::size_t first_ = 0, count_ = 0;
  double time_ = 0.0, foreseen_time_ = 0.0, last_kept_ = -1.0;
  double squares_ = 0.0, held_squares_ = 0.0;
  long compared_ = 0;
};

}  // namespace veridyn::cueing
