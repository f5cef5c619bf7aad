#include "veridyn/live/page/platform_json.hpp"

#include <nlohmann/json.hpp>

namespace veridyn::live {

std::string platform_json(const cueing::Platform& platform) {
  const auto place = [](const Eigen::Vector3d& p) { return nlohmann::json({p.x(), p.y(), p.z()}); };
  nlohmann::json j = {
      {"feet", nlohmann::json::array()}, {"heads", nlohmann::json::array()}, {"rider", place(platform.rider)}};
  if (platform.legs) {
    for (const Eigen::Vector3d& foot : platform.legs->feet) j["feet"].push_back(place(foot));
    for (const Eigen::Vector3d& head : platform.legs->heads) j["heads"].push_back(place(head));
    j["leg"] = {{"lowest", platform.legs->leg.lowest}, {"highest", platform.legs->leg.highest}};
  }
  return j.dump();
}

}  // namespace veridyn::live
