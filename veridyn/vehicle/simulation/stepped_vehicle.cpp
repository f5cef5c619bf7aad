#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

#include <cmath>
#include <utility>
#include <variant>

namespace veridyn::vehicle {
namespace {

template <typename Tyre>
class SteppedOnTyres final : public SteppedVehicle {
 public:
  explicit SteppedOnTyres(SteppedDrive<Tyre> drive) : drive_(std::move(drive)) {}
  void reset(double speed) override { drive_.reset(speed); }
  void reset(const DriveState& state) override { drive_.reset(state); }
  void reset(const DriveState& state, const Eigen::Vector3d& field, const Eigen::Vector2d& turning) override {
    drive_.reset(state, field, turning);
  }
  void step(const Controls& controls, double dt) noexcept override { drive_.step(controls, dt); }
  [[nodiscard]] const DriveState& state() const override { return drive_.state(); }
  [[nodiscard]] recording::MotionSample motion(const Eigen::Vector3d& place) const override {
    return drive_.motion(place);
  }
  [[nodiscard]] WorldMotion world() const override {
    const FourWheelState<double>& s = drive_.state().vehicle;
    const double c = std::cos(s(kYaw)), sine = std::sin(s(kYaw));
    return {.position = {s(kX), s(kY), s(kHeave)},
            .velocity = {s(kU) * c - s(kV) * sine, s(kU) * sine + s(kV) * c, s(kHeaveRate)}};
  }
  [[nodiscard]] const WheelArray<double>& loads() const override { return drive_.rates().Fz; }
  [[nodiscard]] std::unique_ptr<SteppedVehicle> clone() const override {
    return std::make_unique<SteppedOnTyres>(*this);
  }

 private:
  SteppedDrive<Tyre> drive_;
};

}  // namespace

std::unique_ptr<SteppedVehicle> stepped_vehicle(const Vehicle& vehicle, const FourWheelOptions& options,
                                                std::shared_ptr<const Road> road, double usual_speed) {
  return std::visit(
      [&]<typename Tyre>(const AxleTyres<Tyre>& tyres) -> std::unique_ptr<SteppedVehicle> {
        const FourWheelModel<double, Tyre> model(vehicle.parameters, mounted(tyres), options);
        return std::make_unique<SteppedOnTyres<Tyre>>(SteppedDrive<Tyre>(model, std::move(road), usual_speed));
      },
      vehicle.tyres);
}

}  // namespace veridyn::vehicle
