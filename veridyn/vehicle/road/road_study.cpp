#include "veridyn/vehicle/road/road_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/road/crg_reader.hpp"
#include "veridyn/vehicle/road/iso8608_road.hpp"
#include "veridyn/vehicle/road/obstacle_road.hpp"
#include "veridyn/vehicle/road/profile_road.hpp"

namespace veridyn::vehicle {
namespace {

/// Of an obstacle; a step may rise at once.
const KeyTable<Obstacle>& obstacle_keys() {
  using O = Obstacle;
  static const auto table =
      KeyTable<O>("road", "With `kind = \"step\"`, `\"ramp\"`, `\"bump\"` or `\"plank\"`:")
          .number("at", &O::at, "m", kAnyNumber, "where it begins")
          .number("height", &O::height, "m", kAnyNumber, "how high it is; a hole where it is negative")
          .required()
          .number("length", &O::length, "m", kNotNegative, "along the road; of a step that over which it rises")
          .otherwise("required, but for a step: 0, at once")
          .choice("side", &O::side,
                  {{"both", Obstacle::Side::kBoth}, {"left", Obstacle::Side::kLeft}, {"right", Obstacle::Side::kRight}},
                  "of the vehicle");
  return table;
}

const KeyTable<Iso8608Options>& random_keys() {
  using O = Iso8608Options;
  static const auto table =
      KeyTable<O>("road", "With `kind = \"iso8608\"`:")
          .other({"class", "", "`\"A\"` to `\"H\"`", "\"C\"", "roughness by its class"},
                 [](const StudyTable& t, const std::string& key, O& o) {
                   const std::vector<std::string> classes{"A", "B", "C", "D", "E", "F", "G", "H"};
                   o.roughness = iso8608_roughness(t.choice_or(key, classes, "").front());
                 })
          .number("roughness", &O::roughness, "m^3", kPositive, "in its place: the density at 0.1 cycles/m")
          .otherwise("by `class`")
          .number("waviness", &O::waviness, "1", kPositive, "exponent of the density")
          .number("length", &O::length, "m", kPositive, "before the road repeats")
          .number("coherence_length", &O::coherence_length, "m", kAnyNumber,
                  "waves much longer are the same on both sides; 0: all are")
          .number("fade_in", &O::fade_in, "m", kAnyNumber, "over which the road grows from a level one")
          .count("seed", &O::seed, 0, kLargestSeed, "of the random phases")
          .otherwise("the study's `seed`")
          .check([](const StudyTable& t, O& o) {
            if (t.has("class") && t.has("roughness"))
              t.fail("roughness", "is given as well as `class`: give one of them");
            try {
              o.validate();
            } catch (const InputError& error) {
              t.fail("kind", error.what());
            }
          });
  return table;
}

struct RoadFile {
  std::string kind = "flat";
  std::filesystem::path file = {};
};

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> names{"flat", "step", "ramp", "bump", "plank", "iso8608", "file"};
  return names;
}

KeyTable<RoadFile> file_keys() {
  return KeyTable<RoadFile>("road", "The road under a four-wheel model.")
      .other({"kind", "", quoted_list(kinds(), "`"), "\"flat\"", "of road"},
             [](const StudyTable& t, const std::string& key, RoadFile& road) {
               road.kind = t.choice_or(key, kinds(), "");
             })
      .file("file", &RoadFile::file,
            "with `kind = \"file\"`: distance[m], left[m], right[m] (or height[m]) as CSV, or OpenCRG (.crg)");
}

std::shared_ptr<const Road> read_obstacle(const StudyTable& road, Obstacle::Shape shape) {
  Obstacle obstacle{.shape = shape, .at = 10.0};
  obstacle_keys().read(road, obstacle);
  if (shape != Obstacle::Shape::kStep && !(obstacle.length > 0.0))
    road.fail("length", road.has("length") ? "must be > 0" : "is missing");
  return std::make_shared<ObstacleRoad>(obstacle);
}

std::shared_ptr<const Road> read_random(const StudyTable& road, std::uint64_t seed) {
  Iso8608Options options;
  options.seed = seed;
  random_keys().read(road, options);
  return std::make_shared<Iso8608Road>(options);
}

}  // namespace

std::vector<StudyKeys> road_keys() { return all_of(file_keys(), obstacle_keys(), random_keys()); }

std::shared_ptr<const Road> read_road(const StudyTable& road, std::uint64_t seed) {
  const std::string kind = road.choice_or("kind", kinds(), "flat");
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
