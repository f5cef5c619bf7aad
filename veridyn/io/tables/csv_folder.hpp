#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io {

/// The topic of one of the tables of a log, by its file's name without `prefix`: "vehicle_attitude_0.csv" is
/// "vehicle_attitude", "sensor_baro_1.csv" is "sensor_baro[1]"; others as they are.
[[nodiscard]] std::string table_name(const std::filesystem::path& path, const std::string& prefix = {});

/// The name of the log that PX4's ulog2csv puts ahead of the topic in the name of each table ("flight7_" of
/// "flight7_vehicle_attitude_0.csv"); empty where the tables are named otherwise.
[[nodiscard]] std::string log_prefix(std::span<const std::filesystem::path> paths);

/// Whether a folder holds files `*.csv`.
[[nodiscard]] bool is_csv_folder(const std::filesystem::path& folder);

/// The tables of a folder as the topics of one log, each with its own stamps, as ulog2csv and others export logs. Those
/// that are no recording (without stamps) are left out with a note. Where their clocks restart the same part of all is
/// read: `options.part`, else the longest of the table with the most rows.
/// @throws InputError where none is one: why the first is not
[[nodiscard]] Log read_csv_folder(const std::filesystem::path& folder, const TableOptions& options = {});

}  // namespace veridyn::io
