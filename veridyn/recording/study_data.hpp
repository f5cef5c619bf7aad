#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/recording/channel_map.hpp"

namespace veridyn::recording {

/// What a study says of one recording: its files, the part of them, and how they are written. Keys of `[data]` and
/// `[[data.run]]`.
struct RecordingKeys {
  std::vector<std::filesystem::path> files;  ///< one log, or the tables of one recording on one clock
  double from = -kInfinity, to = kInfinity;  ///< on the log's clock [s]
  io::TableOptions csv;
  StudyTable time = StudyTable();  ///< where the stamps of tables are, of all or by their names
  std::optional<io::PacketLayout> packet;

  [[nodiscard]] static const KeyTable<RecordingKeys>& keys();
};

/// All of `[data]`, with what names several recordings.
struct DataKeys : RecordingKeys {
  std::vector<std::filesystem::path> runs, holdout_runs;  ///< besides those of `[[data.run]]`
  ChannelMap map;

  [[nodiscard]] static const KeyTable<DataKeys>& keys();
};

/// The recording that a study's `[data]` names.
///
/// With several files the channels of each carry its name as a prefix, `IMU.AccX`; the instance that ulog2csv appends
/// is dropped, so that `vehicle_attitude_0.csv` gives `vehicle_attitude.q[0]` as the log itself would. Keys of other
/// modules in `[data]` are left for them.
/// `threads`: io::TableOptions.
/// @throws InputError for unreadable files, or a part of the recording that holds nothing.
[[nodiscard]] Recording read_study_data(const StudyTable& data, int threads = 1);

/// One of the recordings of a study, with the table that says what is its own.
struct StudyRecording {
  std::string name;  ///< of its file, distinct among those of the study; empty where it is the only one
  Recording recording;
  std::vector<std::filesystem::path> files;
  StudyTable own;         ///< `[[data.run]]`, or empty: keys that it lacks are those of `[data]`
  bool held_out = false;  ///< never used by identification
};

/// All recordings that `[data]` names: one, as `read_study_data` reads it, or several of the same thing,
/// in the order `runs`, `[[data.run]]`, `holdout_runs`.
/// @throws InputError as `read_study_data`, naming the file; for a recording that is named twice, and where no
/// recording is left to identify from
[[nodiscard]] std::vector<StudyRecording> read_study_recordings(const StudyTable& data, int threads = 1);

/// Whether `[data]` names recordings by `runs`, `holdout_runs` or `[[data.run]]`.
[[nodiscard]] bool names_runs(const StudyTable& data);

/// `own` where it has the key, else `shared`.
[[nodiscard]] const StudyTable& table_with(std::string_view key, const StudyTable& own, const StudyTable& shared);

/// Reads the same keys, and those of `[data.map]`, without opening a file: for commands that have no use for the
/// recording, so that they refuse a misspelt key too. @throws InputError for values of the wrong kind.
void check_study_data(const StudyTable& data, std::span<const StandardChannel> standard);

/// How `[data]` says that a file is to be read. @throws InputError for values of the wrong kind.
[[nodiscard]] io::ReadOptions read_study_options(const StudyTable& data, const std::filesystem::path& path);

/// One file, read as `[data.time]` says; for domains whose `[data]` names files under other keys.
[[nodiscard]] Recording read_study_file(const StudyTable& data, const std::filesystem::path& path);

/// Tables hold one row for each stamp of any channel; a cell that is empty is no sample. Channels get the stamps that
/// they have, so that their rate and gaps are theirs.
[[nodiscard]] Recording without_missing(const Recording& recording);

/// The samples with stamps in [from, to]. @throws InputError when no channel has one.
[[nodiscard]] Recording cut(const Recording& recording, TimeSpan span);

}  // namespace veridyn::recording
