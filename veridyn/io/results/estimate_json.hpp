#pragma once

#include <filesystem>
#include <string>

#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::io {

/// Number of the shape of estimate.json, its first member: docs/estimate.schema.json.
inline constexpr int kEstimateSchema = 1;

/// An estimate as JSON, in the shape that docs/formats.md promises. Numbers that are not finite become null.
[[nodiscard]] std::string to_json(const estimation::Estimate& estimate);

/// Reads `estimate.json`.
/// @throws InputError naming the file and the key that is missing or of the wrong kind, or the parameter that is usable
/// by its status but has no value, or whose sigma is negative; or the file's schema, where it is not kEstimateSchema.
[[nodiscard]] estimation::Estimate read_estimate(const std::filesystem::path& path);

}  // namespace veridyn::io
