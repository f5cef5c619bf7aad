#include "veridyn/muscle/identification/muscle_outputs.hpp"

#include <fmt/format.h>

#include <array>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::muscle {
namespace {

struct OutputWord {
  const char* suffix;
  MuscleOutputKind kind;
  bool of_muscle;
};
constexpr std::array<OutputWord, 4> kWords{{{"speed", MuscleOutputKind::kSpeed, false},
                                            {"moment", MuscleOutputKind::kMoment, false},
                                            {"fiber_length", MuscleOutputKind::kFiberLength, true},
                                            {"tendon_force", MuscleOutputKind::kTendonForce, true}}};

}  // namespace

MuscleOutput parse_output(const Model& model, std::string_view text, std::string_view place) {
  if (const int c = model.coordinate(std::string(text)); c >= 0) return {MuscleOutputKind::kValue, c, 0.0};
  const std::size_t dot = text.rfind('.');
  if (dot == std::string_view::npos)
    throw InputError(place, fmt::format("'{}': {}", text, model.no_coordinate(std::string(text))));
  const std::string owner(text.substr(0, dot)), suffix(text.substr(dot + 1));
  std::vector<std::string> suffixes;
  for (const OutputWord& word : kWords) {
    suffixes.emplace_back(word.suffix);
    if (suffix != word.suffix) continue;
    const int index = word.of_muscle ? model.muscle(owner) : model.coordinate(owner);
    if (index >= 0) return {word.kind, index, 0.0};
    throw InputError(
        place, fmt::format("'{}': {}", text, word.of_muscle ? model.no_muscle(owner) : model.no_coordinate(owner)));
  }
  throw InputError(place, fmt::format("'{}': there is no output '{}'{}", text, suffix, suggestion(suffix, suffixes)));
}

std::string output_name(const Model& model, const MuscleOutput& output) {
  for (const OutputWord& word : kWords) {
    if (word.kind != output.kind) continue;
    const std::string owner =
        word.of_muscle ? std::string(model.muscles[output.index].name()) : model.coordinates[output.index].name;
    return fmt::format("{}.{}", owner, word.suffix);
  }
  return model.coordinates[output.index].name;
}

std::string output_unit(const Model& model, const MuscleOutput& output) {
  switch (output.kind) {
    case MuscleOutputKind::kSpeed:
      return model.coordinates[output.index].unit() + "/s";
    case MuscleOutputKind::kMoment:
      return model.coordinates[output.index].unit() == "m" ? "N" : "N m";
    case MuscleOutputKind::kFiberLength:
      return "m";
    case MuscleOutputKind::kTendonForce:
      return "N";
    case MuscleOutputKind::kValue:
      break;
  }
  return model.coordinates[output.index].unit();
}

}  // namespace veridyn::muscle
