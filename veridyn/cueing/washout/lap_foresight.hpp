#pragma once

#include <memory>
#include <vector>

#include "veridyn/cueing/washout/foresight.hpp"

namespace veridyn::cueing {

/// A lap that was driven before, at even times.
struct Lap {
  std::vector<Eigen::Vector2d> position;  ///< world's level axes of frd [m]
  std::vector<Eigen::Vector3d> force;     ///< specific force at the driver's head, frd, smoothed over 0.4 s [m/s^2]
};

/// Forces from a lap of the same track: those that were there then, at the places that lie ahead now. Driven faster or
/// slower, they come sooner or later, and the ones to the side grow with the square of the speed. The place on the lap
/// is the nearest one, near where it was last; when the vehicle is more than 15 m off, or goes the other way, nothing
/// is foreseen until it is found again.
class LapForesight final : public Foresight {
 public:
  /// @param lap its positions known. @throws InputError("lap", ...) without positions, or where it is shorter than 50
  /// m.
  explicit LapForesight(const std::vector<recording::MotionSample>& lap);

  void reset() override;
  bool look(const recording::MotionSample& sample, double step, Foreseen& foreseen) override;
  [[nodiscard]] std::unique_ptr<Foresight> clone() const override { return std::make_unique<LapForesight>(*this); }
  [[nodiscard]] std::string from() const override { return "the lap"; }
  /// Where on the lap [s]; nothing known: below zero.
  [[nodiscard]] double at() const { return at_; }

 private:
  /// When the lap was nearest, between these of its samples [s]; below zero: it never was near.
  [[nodiscard]] double nearest(const Eigen::Vector2d& position, std::size_t begin, std::size_t end) const;
  [[nodiscard]] Eigen::Vector3d force(double at) const;
  void follow(const recording::MotionSample& sample, double step);

  std::shared_ptr<const Lap> lap_;
  double at_ = -1.0;   ///< [s] from the lap's beginning
  double pace_ = 1.0;  ///< of the drive over that of the lap
  Eigen::Vector2d last_ = Eigen::Vector2d::Zero(), direction_ = Eigen::Vector2d::Zero();
  bool has_last_ = false;
  double since_search_ = 0.0;  ///< [s]
};

}  // namespace veridyn::cueing
