// Which domain a study is of, and what each command does for it.
#include "apps/veridyn/run/domains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/subject_files.hpp"
#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

/// A command that several processes of a launcher run together.
struct Shared {
  int (*run)(const StudyRun&);
};

/// What a command does for a domain: `run`, or nothing, and what is possible instead.
struct Cell {
  constexpr Cell(int (*action)(const StudyRun&)) : run(action) {}        // NOLINT(google-explicit-constructor)
  constexpr Cell(Shared action) : run(action.run), shares_work(true) {}  // NOLINT(google-explicit-constructor)
  constexpr Cell(const char* possible) : instead(possible) {}            // NOLINT(google-explicit-constructor)
  int (*run)(const StudyRun&) = nullptr;
  bool shares_work = false;
  const char* instead = "";
};

struct Row {
  std::string_view command;
  EnumArray<Domain, Cell, kDomains> cells;
};

constexpr const char* kIdentifiesIt = "`veridyn identify` analyses it";
constexpr const char* kIdentifiesDrive = "`veridyn identify` prepares the signals of a drive itself";
constexpr const char* kMovesMuscles = "`veridyn simulate` runs it";

constexpr const char* kCuesIt = "`veridyn cue` drives the platform";
constexpr const char* kNamesPlatform = "`veridyn init cueing` writes a study that puts a drive on one";

constexpr std::array kRows = {
    // aircraft, vehicle, muscle, swing test, calibration, motion platform
    Row{"simulate", {simulate_aircraft, simulate_vehicle, simulate_muscle, kIdentifiesIt, kIdentifiesIt, kCuesIt}},
    Row{"reconstruct", {reconstruct_aircraft, kIdentifiesDrive, kMovesMuscles, kIdentifiesIt, kIdentifiesIt, kCuesIt}},
    Row{"identify",
        {identify_aircraft, identify_vehicle, Shared{identify_muscles}, identify_swing_test, identify_calibration,
         kCuesIt}},
    Row{"validate",
        {validate_aircraft, validate_vehicle, validate_muscles,
         "`veridyn identify` says in its report how well each swing is described",
         "`veridyn identify` writes the residuals of each point", kCuesIt}},
    Row{"track", {track_aircraft, track_vehicle, kMovesMuscles, kIdentifiesIt, kIdentifiesIt, kCuesIt}},
    Row{"sensitivity",
        {Shared{sensitivity_aircraft}, Shared{sensitivity_vehicle}, Shared{sensitivity_muscle}, kIdentifiesIt,
         kIdentifiesIt, kCuesIt}},
    Row{"export",
        {export_aircraft, export_vehicle, "`veridyn simulate` writes the model to model.osim",
         "`veridyn identify` writes the inertia to subject.toml", "`veridyn identify` writes calibration.toml",
         kCuesIt}},
    Row{"scale",
        {"the model of an aircraft is dimensionless already: `veridyn export` writes it", scale_vehicle, kMovesMuscles,
         kIdentifiesIt, kIdentifiesIt, kCuesIt}},
    Row{"cue", {kNamesPlatform, kNamesPlatform, kMovesMuscles, kIdentifiesIt, kIdentifiesIt, cue_platform}},
};

constexpr auto kCommands = [] {
  std::array<std::string_view, kRows.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kRows[i].command;
  return names;
}();

struct DomainNames {
  const char* one;   ///< "a study of an aircraft"
  const char* many;  ///< "identify is for aircraft"
};
constexpr EnumArray<Domain, DomainNames, kDomains> kNames = {
    DomainNames{"an aircraft", "aircraft"},
    DomainNames{"a vehicle", "vehicles"},
    DomainNames{"a musculoskeletal model", "musculoskeletal models"},
    DomainNames{"a swing test", "swing tests"},
    DomainNames{"an air-data calibration", "air-data calibrations"},
    DomainNames{"a motion platform", "motion platforms"}};

/// "aircraft", "aircraft and vehicles", "aircraft, vehicles and swing tests".
std::string domains_with(const Row& row) {
  std::vector<std::string> names;
  for (const Domain domain : enumerators<Domain, kDomains>()) {
    if (row.cells[domain].run != nullptr) names.emplace_back(kNames[domain].many);
  }
  std::string text = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace

Domain domain_of(const Study& study) {
  const StudyTable& root = study.root();
  // Not `has`: a key that `has` looked for counts as known, and these are known in some domains only.
  const std::vector<std::string> tables = root.keys();
  const auto named = [&](const char* key) { return std::find(tables.begin(), tables.end(), key) != tables.end(); };
  if (named("swing_test")) return Domain::kSwingTest;
  if (named("calibration")) return Domain::kCalibration;
  if (named("cue")) return Domain::kCueing;
  if (vehicle::is_vehicle_study(root)) return Domain::kVehicle;
  if (muscle::is_muscle_study(root)) return Domain::kMuscle;
  if (root.is_table("subject")) {
    const StudyTable subject = root.table("subject");
    const std::vector<std::string> kinds = {"vehicle"};
    if (subject.is_text("kind"))
      subject.fail("kind", fmt::format("there is no kind '{}'{}; studies of aircraft have none", subject.text("kind"),
                                       suggestion(subject.text("kind"), kinds)));
    if (named("motion"))
      subject.fail("model", "is missing: a study with [motion] is of a musculoskeletal model, such as model = \"arm\"");
  }
  return Domain::kAircraft;
}

RunRecord StudyRun::record(std::uint64_t seed, std::vector<std::filesystem::path> inputs) const {
  inputs.insert(inputs.end(), subject_files.begin(), subject_files.end());
  inputs.push_back(path);
  if (arguments.given("--estimate-file")) inputs.emplace_back(arguments.text("--estimate-file"));
  return {command, study.name(), study.to_toml(), seed, std::move(inputs), text_to_write};
}

StudyRun parse_study(std::string command, const std::filesystem::path& path, std::string_view text,
                     const Arguments& arguments) {
  std::vector<std::string> overrides = arguments.common.overrides;
  if (arguments.common.seed) overrides.push_back(fmt::format("seed={}", *arguments.common.seed));
  StudyRun run{std::move(command), path, Study::parse(text, path.string(), path.parent_path(), overrides), arguments};
  run.subject_files = subject_files(text, path.string(), path.parent_path(), overrides);
  return run;
}

int run_on_study(std::string_view command, const Arguments& arguments) {
  const Row& row = *std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return r.command == command; });
  const std::string& path = arguments.text("STUDY");
  const StudyRun run = parse_study(std::string(command), path, read_file(path), arguments);
  const Domain domain = domain_of(run.study);
  const Cell& cell = row.cells[domain];
  if (cell.run != nullptr) {
    if (const std::size_t processes = arguments.common.ranks.size(); processes > 1 && !cell.shares_work)
      throw InputError(
          std::string(command),
          fmt::format("runs in one process for this study, {} were started; --threads takes the processors "
                      "of one machine",
                      processes));
    const int exit_code = cell.run(run);
    for (const std::string& note : run.study.notes()) print_line(arguments.common, "note: " + note);
    return exit_code;
  }
  throw InputError(run.study.name(), fmt::format("{} is for {}; this study is of {}; {}", command, domains_with(row),
                                                 kNames[domain].one, cell.instead));
}

std::span<const std::string_view> study_commands() { return kCommands; }

}  // namespace veridyn::app
