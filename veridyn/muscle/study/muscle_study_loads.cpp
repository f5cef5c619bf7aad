// Forces of the surroundings in a muscle study: force plates, contact that was simulated before.
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "veridyn/muscle/osim/external_loads_file.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

/// The name of columns, or three numbers into `constant`; true for numbers.
bool read_columns(const StudyTable& table, const std::string& key, const char* unit, std::string& columns,
                  Eigen::Vector3d& constant) {
  if (table.is_text(key)) {
    columns = table.text(key);
    if (columns.empty()) table.fail(key, "names no columns");
    return false;
  }
  const std::vector<double> numbers = table.numbers(key, unit);
  if (numbers.size() != 3) table.fail(key, fmt::format("has {} numbers, expected x, y, z", numbers.size()));
  constant = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  return true;
}

/// A load as `[[motion.external_load]]` has it, without its data.
ExternalLoadSource read_source(const StudyTable& table) {
  ExternalLoadSource source = external_load_keys().read(table);
  source.place = table.place("");
  if (source.name.empty()) source.name = source.body;
  if (!table.has("force") && !table.has("torque")) table.fail("force", "is missing, and so is a torque");
  const bool columns = !source.force.empty() || !source.moment.empty() || !source.point.empty();
  if (columns != table.has("file"))
    table.fail("file",
               columns ? "is missing: force, point and torque name its columns" : "holds no column that is used");
  return source;
}

/// @throws InputError at `place` when the data do not cover the study's time.
void check_cover(const StudyTable& table, const char* key, const SignalTable& data, const MuscleStudy& study) {
  const double slack = 1e-9 * (1.0 + std::abs(study.end));
  if (data.time.front() > study.begin + slack || data.time.back() < study.end - slack)
    table.fail(key, fmt::format("{} has {:g} .. {:g} s, the motion needs {:g} .. {:g} s", data.source,
                                data.time.front(), data.time.back(), study.begin, study.end));
}

}  // namespace

const KeyTable<ExternalLoadSource>& external_load_keys() {
  using S = ExternalLoadSource;
  static const char* const kColumns = "what the names of three columns begin with, or three numbers";
  static const auto table =
      KeyTable<S>("motion.external_load", "A force of the surroundings; it acts at `point` of `body`.")
          .repeated()
          .text("body", &S::body, "on which it acts")
          .required()
          .elsewhere({"file", "", "a file", "none", "that holds the columns", true})
          .other({"force", "N", kColumns, "none", "what the surroundings do to the body", true},
                 [](const StudyTable& t, const std::string& key, S& s) {
                   read_columns(t, key, "N", s.force, s.constant_force);
                 })
          .other({"torque", "N m", kColumns, "none", "besides; one of the two must be there", true},
                 [](const StudyTable& t, const std::string& key, S& s) {
                   read_columns(t, key, "N m", s.moment, s.constant_moment);
                 })
          .other({"point", "m", kColumns, "the body's origin", "where the force acts", true},
                 [](const StudyTable& t, const std::string& key, S& s) {
                   s.has_constant_point = read_columns(t, key, "m", s.point, s.constant_point);
                 })
          .text("force_frame", &S::force_frame, "body in whose axes force and torque are")
          .text("point_frame", &S::point_frame, "body in whose frame the point is")
          .text("name", &S::name, "for the results")
          .otherwise("the body");
  return table;
}

ReadFromFiles<std::shared_ptr<const ExternalLoads>> read_external_loads(const StudyTable& motion,
                                                                        const MotionTable& keys,
                                                                        const MuscleStudy& study) {
  ReadFromFiles<std::shared_ptr<const ExternalLoads>> read;
  ExternalLoads loads;
  const Model& model = study.system->model();
  const double low_pass_Hz = keys.external_low_pass_Hz.value_or(0.0);
  if (keys.external_loads) {
    const std::filesystem::path& path = *keys.external_loads;
    ExternalLoadsFile file = muscle::read_external_loads(path);
    read.inputs.push_back(path);
    read.warnings = std::move(file.warnings);
    const char* key = "external_loads";
    if (keys.external_loads_data) {
      key = "external_loads_data";
      file.data = *keys.external_loads_data;
    }
    if (file.data.empty())
      motion.fail(key, fmt::format("{} names no datafile; external_loads_data = \"x.mot\" does", path.string()));
    const SignalTable data = read_signals(file.data);
    read.inputs.push_back(file.data);
    check_cover(motion, key, data, study);
    add_external_loads(file.sources, &data, model, low_pass_Hz, loads);
  } else if (keys.external_loads_data) {
    motion.fail("external_loads_data", "has no meaning without external_loads");
  }
  for (const StudyTable& table : motion.tables("external_load")) {
    const ExternalLoadSource source = read_source(table);
    std::optional<SignalTable> data;
    if (table.has("file")) {
      read.inputs.push_back(table.file("file"));
      data = read_signals(read.inputs.back());
      check_cover(table, "file", *data, study);
    }
    add_external_loads({&source, 1}, data ? &*data : nullptr, model, low_pass_Hz, loads);
  }
  if (loads.empty() && keys.external_low_pass_Hz && !keys.external_loads)
    motion.fail("external_low_pass", "has no meaning without external loads");
  if (!loads.empty()) read.value = std::make_shared<const ExternalLoads>(std::move(loads));
  return read;
}

}  // namespace veridyn::muscle::internal
