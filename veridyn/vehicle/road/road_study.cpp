#include "veridyn/vehicle/road/road_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/road/crg_reader.hpp"
#include "veridyn/vehicle/road/iso8608_road.hpp"
#include "veridyn/vehicle/road/obstacle_road.hpp"
#include "veridyn/vehicle/road/profile_road.hpp"

namespace veridyn::vehicle {
namespace {

std::shared_ptr<const Road> read_obstacle(const StudyTable& road, Obstacle::Shape shape) {
  Obstacle obstacle;
  obstacle.shape = shape;
  obstacle.at = road.number_or("at", "m", 10.0);
  obstacle.height = road.number("height", "m");
  const bool step = shape == Obstacle::Shape::kStep;
  obstacle.length = step ? road.number_or("length", "m", 0.0) : road.positive("length", "m");
  if (!(obstacle.length >= 0.0)) road.fail("length", fmt::format("= {} must be >= 0", obstacle.length));
  const std::array<std::string, 3> sides{"both", "left", "right"};
  const std::string side = road.choice_or("side", sides, "both");
  if (side == "left") obstacle.side = Obstacle::Side::kLeft;
  if (side == "right") obstacle.side = Obstacle::Side::kRight;
  return std::make_shared<ObstacleRoad>(obstacle);
}

std::shared_ptr<const Road> read_random(const StudyTable& road, std::uint64_t seed) {
  Iso8608Options options;
  if (road.has("class") && road.has("roughness"))
    road.fail("roughness", "is given as well as `class`: give one of them");
  if (road.has("roughness")) {
    options.roughness = road.positive("roughness", "m^3");
  } else {
    const std::array<std::string, 8> classes{"A", "B", "C", "D", "E", "F", "G", "H"};
    options.roughness = iso8608_roughness(road.choice_or("class", classes, "C").front());
  }
  options.waviness = road.positive_or("waviness", "1", options.waviness);
  options.length = road.positive_or("length", "m", options.length);
  options.coherence_length = road.number_or("coherence_length", "m", options.coherence_length);
  options.fade_in = road.number_or("fade_in", "m", options.fade_in);
  const long long given = road.integer_or("seed", 0);
  if (given < 0) road.fail("seed", fmt::format("= {} must be >= 0", given));
  options.seed = road.has("seed") ? static_cast<std::uint64_t>(given) : seed;
  try {
    options.validate();
  } catch (const InputError& error) {
    road.fail("kind", error.what());
  }
  return std::make_shared<Iso8608Road>(options);
}

}  // namespace

std::shared_ptr<const Road> read_road(const StudyTable& road, std::uint64_t seed) {
  const std::array<std::string, 7> kinds{"flat", "step", "ramp", "bump", "plank", "iso8608", "file"};
  const std::string kind = road.choice_or("kind", kinds, "flat");
  if (kind == "step") return read_obstacle(road, Obstacle::Shape::kStep);
  if (kind == "ramp") return read_obstacle(road, Obstacle::Shape::kRamp);
  if (kind == "bump") return read_obstacle(road, Obstacle::Shape::kBump);
  if (kind == "plank") return read_obstacle(road, Obstacle::Shape::kPlank);
  if (kind == "iso8608") return read_random(road, seed);
  if (kind == "flat") return std::make_shared<FlatRoad>();
  const std::filesystem::path file = road.file("file");
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".crg") return std::make_shared<CrgRoad>(read_crg(file));
  if (extension == ".csv") return std::make_shared<ProfileRoad>(read_profile_road(file));
  road.fail("file", fmt::format("= '{}': a road is a table (.csv) or OpenCRG (.crg)", file.string()));
}

}  // namespace veridyn::vehicle
