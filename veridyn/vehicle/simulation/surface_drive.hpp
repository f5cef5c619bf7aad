#pragma once

#include <memory>

#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/road/road_surface.hpp"
#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

namespace veridyn::vehicle {

/// The stepped vehicle on a surface of any inclination, `stepped_vehicle`'s equations in the plane that touches the
/// surface under the centre of gravity. In parts of at most 0.25 ms:
///
/// - gravity acts in the axes of that plane, and every mass feels what the plane's turning asks of it: with omega its
///   rate and v the vehicle's velocity, -omega x v;
/// - roll, pitch, heave and wheels are relative to the plane: what turns it faster turns them back;
/// - wheels stand where the surface, with its relief, is above or below the plane.
///
/// `state()` has x, y of the point under the centre of gravity and the yaw as the map has them, the latter unwound; all
/// else in the plane's axes. `motion` is what sensors at the place feel: attitude against the world, gravity in, rates
/// with those of the plane.
///
/// Good as far as small angles against the plane go (about 15 deg), so where the surface bends little within a
/// wheelbase. Left out is what the plane's turning adds to the speed of the contact points.
/// @throws InputError as `stepped_vehicle`; for a vehicle without longitudinal dynamics or with a grade of its own; for
/// a null surface
[[nodiscard]] std::unique_ptr<SteppedVehicle> surface_vehicle(const Vehicle& vehicle, const FourWheelOptions& options,
                                                              std::shared_ptr<const RoadSurface> surface,
                                                              double usual_speed = 20.0);

}  // namespace veridyn::vehicle
