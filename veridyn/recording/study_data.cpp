#include "veridyn/recording/study_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/io/tables/csv_folder.hpp"

namespace veridyn::recording {
namespace {

void merge(Recording& whole, const Recording& part, const std::string& prefix) {
  for (Channel channel : part.channels()) {
    if (!prefix.empty()) channel.name = prefix + "." + channel.name;
    whole.add(std::move(channel));
  }
  whole.events.insert(whole.events.end(), part.events.begin(), part.events.end());
  whole.parameters.insert(part.parameters.begin(), part.parameters.end());
  whole.information.insert(part.information.begin(), part.information.end());
  for (const std::string& warning : part.warnings) {
    whole.warnings.push_back(prefix.empty() ? warning : fmt::format("{}: {}", prefix, warning));
  }
  if (part.frame != Frame::kUnspecified) whole.frame = part.frame;
}

/// Where the stamps of a table are.
const KeyTable<io::TableOptions>& time_keys() {
  using O = io::TableOptions;
  static const auto table =
      KeyTable<O>(
          "time",
          "For tables that do not say where their stamps are; where only some do not, by table name: `GPS = { column = "
          "\"T\", unit = \"ms\" }`.")
          .text("column", &O::time_column, "column that holds the time stamps")
          .otherwise("found by its name")
          .text("unit", &O::time_unit, "of the stamps")
          .otherwise("of the header, else by how far rows are apart")
          .number("rate", &O::rate, "Hz", kPositive, "of the rows of a table that has no stamps")
          .otherwise("none")
          .check([](const StudyTable& t, O&) {
            if (t.has("rate") && t.has("column"))
              t.fail("rate", "is for tables without stamps; `column` names their column");
          });
  return table;
}

/// Reads the keys of all tables; a name of a table may be "rate" too.
void read_time(const StudyTable& time, io::TableOptions& options) {
  for (const char* key : {"column", "unit", "rate"})
    if (time.has(key) && time.is_table(key)) return;
  time_keys().read(time, options);
}

/// `packet`: a name, or a table that describes one.
void read_packet(const StudyTable& data, const std::string& key, RecordingKeys& keys) {
  if (data.is_table(key)) {
    keys.packet = io::read_packet_layout(data.table(key));
    return;
  }
  std::vector<std::string> names;
  for (const io::PacketLayout& layout : io::known_packets()) names.push_back(layout.name);
  keys.packet = io::known_packet(data.choice_or(key, names, ""));
}

}  // namespace

Recording without_missing(const Recording& recording) {
  Recording result = recording;
  for (const Channel& channel : recording.channels()) {
    const auto missing =
        std::count_if(channel.value.begin(), channel.value.end(), [](double v) { return !std::isfinite(v); });
    if (missing == 0 || static_cast<std::size_t>(missing) == channel.size()) continue;
    Channel kept = channel;
    kept.value.clear();
    std::vector<double> stamps;
    for (std::size_t i = 0; i < channel.size(); ++i) {
      if (!std::isfinite(channel.value[i])) continue;
      stamps.push_back(channel.times()[i]);
      kept.value.push_back(channel.value[i]);
    }
    kept.time = make_time_base(std::move(stamps));
    result.set(std::move(kept));
  }
  return result;
}

Recording cut(const Recording& recording, TimeSpan span) {
  Recording result;
  result.source = recording.source;
  result.frame = recording.frame;
  result.parameters = recording.parameters;
  result.information = recording.information;
  result.warnings = recording.warnings;
  std::copy_if(recording.events.begin(), recording.events.end(), std::back_inserter(result.events),
               [&](const Event& event) { return span.contains(event.time); });
  // Channels of one message share their stamps before and after.
  std::map<const std::vector<double>*, TimeBase> bases;
  bool any = false;
  for (const Channel& channel : recording.channels()) {
    const auto times = channel.times();
    const auto first = std::lower_bound(times.begin(), times.end(), span.begin) - times.begin();
    const auto last = std::upper_bound(times.begin(), times.end(), span.end) - times.begin();
    TimeBase& base = bases[channel.time.get()];
    if (!base) base = make_time_base(std::vector<double>(times.begin() + first, times.begin() + std::max(first, last)));
    Channel part = channel;
    part.time = base;
    part.value.assign(channel.value.begin() + first, channel.value.begin() + std::max(first, last));
    any = any || !part.empty();
    result.add(std::move(part));
  }
  if (!any) {
    const TimeSpan whole = recording.span();
    throw InputError(recording.source, fmt::format("holds nothing from {} s to {} s; it spans {:.3f} s to {:.3f} s",
                                                   span.begin, span.end, whole.begin, whole.end));
  }
  return result;
}

const KeyTable<RecordingKeys>& RecordingKeys::keys() {
  using K = RecordingKeys;
  const auto csv = [](auto member) {
    return [member](K & k) -> auto& { return k.csv.*member; };
  };
  using T = io::TableOptions;
  static const auto table =
      KeyTable<K>("data")
          .other({"file", "", "a file", "", "one log of any known format, or a folder of arrays", true},
                 [](const StudyTable& t, const std::string& key, K& k) { k.files = t.files(key); })
          .files("files", &K::files, "or the tables of one recording on one clock")
          .number("from", &K::from, "s", kAnyNumber, "only this part, on the log's clock")
          .number("to", &K::to, "s", kAnyNumber, "and up to here")
          .count("part", csv(&T::part), 1, 1'000'000, "of a file that holds several recordings")
          .otherwise("all, or the longest of a table whose clock restarts")
          .texts("columns", csv(&T::columns), "names, `name` or `name[unit]`, of the columns of a table without header")
          .text("variable", csv(&T::variable), "of a MATLAB file, the matrix whose columns are the channels")
          .otherwise("SIDPAC's `fdata`, or by content")
          .count("skip_lines", csv(&T::skip_lines), 0, 1'000'000, "at the top of a table, which are not looked at")
          .choice("delimiter", csv(&T::delimiter),
                  {{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"blank", ' '}, {"bar", '|'}},
                  "between the cells of a table")
          .otherwise("as its rows show")
          .choice("decimal", csv(&T::decimal), {{"point", '.'}, {"comma", ','}}, "of the numbers of a table")
          .otherwise("as its rows show")
          .other({"packet", "", "a name, or a table that describes one", "by the content",
                  "the file holds packets of telemetry, one after the other", true},
                 read_packet)
          .within("packet", io::packet_layout_keys(), [](const StudyTable&, K&) {})
          .within("time", time_keys(),
                  [](const StudyTable& t, K& k) {
                    if (t.has("time")) k.time = t.table("time");
                  })
          .check([](const StudyTable& t, K& k) {
            if (!(k.from < k.to)) t.fail("to", fmt::format("= {} s must be later than from = {} s", k.to, k.from));
          });
  return table;
}

namespace {

/// How to read one file, with the keys that `own` has and else those of `shared`.
io::ReadOptions read_options(const std::filesystem::path& path, const StudyTable& own, const StudyTable& shared) {
  RecordingKeys keys;
  for (const StudyTable* table : {&shared, &own}) RecordingKeys::keys().read(*table, keys);
  const std::string name = io::table_name(path);
  read_time(keys.time.has(name) ? keys.time.table(name) : keys.time, keys.csv);
  return {.csv = keys.csv, .packet = keys.packet};
}

/// One file, read as these say.
Recording read_file(const std::filesystem::path& path, const StudyTable& own, const StudyTable& shared, int threads) {
  io::ReadOptions options = read_options(path, own, shared);
  options.csv.threads = threads;
  return io::read_recording(path, options);
}

/// What a `[[data.run]]` has beside the keys of a recording.
struct RunKeys {
  bool held_out = false;
};

const KeyTable<RunKeys>& run_keys() {
  static const auto table =
      KeyTable<RunKeys>("run", "A recording that needs keys of its own, in place of those of `[data]`.")
          .flag("holdout", &RunKeys::held_out, "never used by identification");
  return table;
}

/// Reads the keys of one recording, or of all, without opening a file.
void check_recording_keys(const StudyTable& data, const RecordingKeys& keys,
                          std::span<const std::filesystem::path> files, std::span<const StandardChannel> standard) {
  io::TableOptions options;
  read_time(keys.time, options);
  for (const std::filesystem::path& path : files) {
    const std::string name = io::table_name(path);
    if (keys.time.has(name)) read_time(keys.time.table(name), options);
  }
  check_channel_map(data.table_or_empty("map"), standard);
}

/// The recording that `file` or `files` of a table name, with the keys of `shared` that the table lacks.
Recording read_one(const StudyTable& data, const StudyTable& shared, int threads) {
  if (data.has("file") == data.has("files")) {
    data.fail(data.has("file") ? "files" : "file",
              "is missing: give `file`, or `files` for the tables of one flight (not both)");
  }
  const std::vector<std::filesystem::path> paths = data.files(data.has("file") ? "file" : "files");
  if (paths.empty()) data.fail("files", "is empty");
  Recording whole;
  std::vector<std::string> names;
  for (const std::filesystem::path& path : paths) names.push_back(path.filename().string());
  const std::string prefix = io::log_prefix(paths);
  whole.source = paths.size() == 1 ? paths.front().string() : fmt::format("{}", fmt::join(names, ", "));
  for (const std::filesystem::path& path : paths) {
    Recording part = read_file(path, data, shared, threads);
    if (paths.size() == 1) {
      part.source = whole.source;
      whole = std::move(part);
    } else {
      merge(whole, part, io::table_name(path, prefix));
    }
  }
  const bool bounded = data.has("from") || data.has("to");
  whole = without_missing(whole);
  if (!bounded) return whole;
  const RecordingKeys keys = RecordingKeys::keys().read(data);
  return cut(whole, {keys.from, keys.to});
}

/// The files of a table, and what they are called together: "flight1.csv", "IMU.csv, GPS.csv".
StudyRecording named_files(std::vector<std::filesystem::path> files) {
  std::vector<std::string> names;
  for (const std::filesystem::path& file : files) names.push_back(file.filename().string());
  StudyRecording run;
  run.name = fmt::format("{}", fmt::join(names, ", "));
  run.files = std::move(files);
  return run;
}

/// What `runs`, `[[data.run]]` and `holdout_runs` name, nothing read yet.
std::vector<StudyRecording> named_runs(const StudyTable& data) {
  for (const char* key : {"file", "files", "from", "to"}) {
    if (!data.has(key)) continue;
    data.fail(key, "is of one recording, but there are `runs`: write [[data.run]] with it for the recording it is of");
  }
  std::vector<StudyRecording> runs;
  const auto add_all = [&](const char* key, bool held_out) {
    if (!data.has(key)) return;
    const std::vector<std::filesystem::path> paths = data.files(key);
    if (paths.empty()) data.fail(key, "is empty");
    for (const std::filesystem::path& path : paths) {
      runs.push_back(named_files({path}));
      runs.back().held_out = held_out;
    }
  };
  add_all("runs", false);
  for (const StudyTable& table : data.tables("run")) {
    if (table.has("file") == table.has("files"))
      table.fail(table.has("file") ? "files" : "file", "is missing: give `file`, or `files` of one run (not both)");
    runs.push_back(named_files(table.files(table.has("file") ? "file" : "files")));
    runs.back().own = table;
    runs.back().held_out = run_keys().read(table).held_out;
  }
  add_all("holdout_runs", true);
  return runs;
}

/// Names that differ: with the part of the file that a run is of, or the folder, where file names alone do not.
void distinguish(std::vector<StudyRecording>& runs, const StudyTable& data) {
  const auto count = [&](const std::string& name) { return std::ranges::count(runs, name, &StudyRecording::name); };
  std::vector<std::string> longer;
  for (const StudyRecording& run : runs) {
    std::string name = run.name;
    if (count(name) > 1 && (run.own.has("from") || run.own.has("part"))) {
      if (run.own.has("part")) name += fmt::format(" part {}", run.own.integer("part"));
      if (run.own.has("from")) name += fmt::format(" from {:g} s", run.own.number("from", "s"));
    } else if (count(name) > 1) {
      name = (run.files.front().parent_path().filename() / run.files.front().filename()).string();
    }
    longer.push_back(std::move(name));
  }
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i].name = longer[i];
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (runs[i].name == runs[j].name)
        data.fail(data.has("runs") ? "runs" : "run", fmt::format("names {} twice", runs[i].name));
  }
}

}  // namespace

const StudyTable& table_with(std::string_view key, const StudyTable& own, const StudyTable& shared) {
  return own.has(key) ? own : shared;
}

const KeyTable<DataKeys>& DataKeys::keys() {
  using K = DataKeys;
  static const auto table = KeyTable<K>("data", "The recording, or several of the same thing.")
                                .with(RecordingKeys::keys())
                                .files("runs", &K::runs, "several recordings, each read with the keys of this table")
                                .files("holdout_runs", &K::holdout_runs, "likewise, never used by identification")
                                .tables("run", run_keys(), [](const StudyTable&, K&) {})
                                .table("map", &K::map, ChannelMap::keys());
  return table;
}

bool names_runs(const StudyTable& data) { return data.has("runs") || data.has("holdout_runs") || data.has("run"); }

io::ReadOptions read_study_options(const StudyTable& data, const std::filesystem::path& path) {
  return read_options(path, data, data);
}

Recording read_study_file(const StudyTable& data, const std::filesystem::path& path) {
  return read_file(path, data, data, 1);
}

Recording read_study_data(const StudyTable& data, int threads) { return read_one(data, data, threads); }

void check_study_data(const StudyTable& data, std::span<const StandardChannel> standard) {
  const DataKeys keys = DataKeys::keys().read(data);
  std::vector<std::filesystem::path> files = keys.files;
  for (const auto* more : {&keys.runs, &keys.holdout_runs}) files.insert(files.end(), more->begin(), more->end());
  check_recording_keys(data, keys, files, standard);
  for (const StudyTable& run : data.tables("run")) {
    const RecordingKeys own = RecordingKeys::keys().read(run);
    check_recording_keys(run, own, own.files, standard);
    static_cast<void>(run_keys().read(run));
  }
}

std::vector<StudyRecording> read_study_recordings(const StudyTable& data, int threads) {
  if (!names_runs(data)) {
    StudyRecording only;
    only.recording = read_study_data(data, threads);
    only.files = data.files(data.has("file") ? "file" : "files");
    std::vector<StudyRecording> one;
    one.push_back(std::move(only));
    return one;
  }
  std::vector<StudyRecording> runs = named_runs(data);
  if (std::ranges::all_of(runs, &StudyRecording::held_out))
    data.fail(data.has("runs")  ? "runs"
              : data.has("run") ? "run"
                                : "holdout_runs",
              "leaves no recording to identify from: every one is held out");
  distinguish(runs, data);
  for (StudyRecording& run : runs) {
    if (run.own.has("file") || run.own.has("files")) {
      run.recording = read_one(run.own, data, threads);
    } else {
      run.recording = without_missing(read_file(run.files.front(), data, data, threads));
      run.recording.source = run.files.front().string();
    }
  }
  if (runs.size() == 1) runs.front().name.clear();
  return runs;
}

}  // namespace veridyn::recording
