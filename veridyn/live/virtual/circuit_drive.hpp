#pragma once

#include <memory>
#include <vector>

#include "veridyn/live/virtual/motion_packet.hpp"
#include "veridyn/vehicle/road/circuit.hpp"
#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

namespace veridyn::live {

/// How a virtual car is driven around a circuit, from `[live.circuit]`, whose other keys are those of
/// `vehicle::read_circuit`.
struct CircuitDriveOptions {
  double speed = 1.8;      ///< [m/s]
  long laps = 2;           ///< until it is put back to the start
  bool clockwise = false;  ///< the other way round, ramps and banks too

  [[nodiscard]] static const KeyTable<CircuitDriveOptions>& keys();
};

/// A driver who keeps to a circuit's middle line: steers towards a point ahead of the car (pure pursuit: Coulter 1992,
/// CMU-RI-TR-92-01) and holds the speed, uphill and downhill.
class CircuitDriver {
 public:
  /// @param wheelbase [m] @param mass [kg] @param wheel_radius [m]
  CircuitDriver(std::shared_ptr<const vehicle::Circuit> circuit, const CircuitDriveOptions& options, double wheelbase,
                double mass, double wheel_radius);

  /// What to do for the next `dt` [s].
  [[nodiscard]] vehicle::Controls controls(const vehicle::DriveState& state, double dt);
  /// Where a car begins, at rest on the middle line, in the direction of the drive.
  [[nodiscard]] vehicle::DriveState at_start(vehicle::DriveState upright) const;

 private:
  std::shared_ptr<const vehicle::Circuit> circuit_;
  CircuitDriveOptions options_;
  double wheelbase_, mass_, wheel_radius_;
  double integral_ = 0.0;  ///< [m]
};

/// The vehicle driven from rest around the circuit, 200 motions a second, at a place on it.
/// @param place of the sensor from the centre of gravity, flu [m]
/// @throws InputError where the vehicle cannot be driven on it (`vehicle::surface_vehicle`), and where it does not stay
/// on the road or does not get around
[[nodiscard]] std::vector<PacketedMotion> circuit_drive(const vehicle::Vehicle& vehicle,
                                                        const std::shared_ptr<const vehicle::Circuit>& circuit,
                                                        const CircuitDriveOptions& options,
                                                        const Eigen::Vector3d& place);

}  // namespace veridyn::live
