#pragma once

/// Where a car on a track is, from a camera above it and the car's inertial sensors.
///
///     camera::read_calibration_points("p.csv")    // read: points of the track and where the picture shows them
///     camera::fit_camera(points)                  // the map from track to picture, with its error
///     camera::to_toml(calibration)                // export; read_calibration back
///     camera::CarTracker                          // the car's pose, picture by picture
///     camera::fuse(inertial, poses, options)      // with gyro and accelerometer: inclination and acceleration apart
///     camera::OverheadRenderer                    // pictures of a simulated car, to try all this
///
/// Component `camera`, of a library that was built with OpenCV.

#include "veridyn/camera/calibration/calibration_checks.hpp"
#include "veridyn/camera/calibration/calibration_file.hpp"
#include "veridyn/camera/calibration/calibration_points.hpp"
#include "veridyn/camera/calibration/fit_camera.hpp"
#include "veridyn/camera/fusion/fused_drive.hpp"
#include "veridyn/camera/rendering/overhead_scene.hpp"
#include "veridyn/camera/rendering/virtual_camera.hpp"
#include "veridyn/camera/tracking/camera_device.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/camera/tracking/silhouette.hpp"
#include "veridyn/camera/tracking/video_frames.hpp"
#include "veridyn/io.hpp"
