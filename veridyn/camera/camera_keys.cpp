#include "veridyn/camera/camera_keys.hpp"

#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"
#include "veridyn/camera/rendering/virtual_camera.hpp"
#include "veridyn/camera/tracking/camera_device.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/camera/tracking/silhouette.hpp"

namespace veridyn::camera {

std::vector<StudyKeys> study_keys() {
  return all_of(TrackerOptions::keys(), SilhouetteOptions::keys(), CameraDeviceOptions::keys(), FusionOptions::keys(),
                VirtualCameraOptions::keys());
}

}  // namespace veridyn::camera
