#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {

/// "of a recording", "of a flight", ...: who is checked.
[[nodiscard]] std::string_view to_string(CheckedOf of);

/// When a row is "with care", or has failed, in words and numbers with units: "outside of 0.98 to 1.02", "above 2 s, or
/// always". Empty: never.
[[nodiscard]] std::string rule_of(const CheckInfo& info, Outcome outcome);

/// The limit of a row with its sense, "at least 0.3", "-0.1 to 0.1"; a dash where it has none. Number and sense are
/// those of its value.
/// @param factor  from the row's unit to the one shown
[[nodiscard]] std::string limit_in_words(const Evidence& row, double factor = 1.0);

/// "campaign: SampleEvidence: 0 alarms of 200 clean recordings".
[[nodiscard]] std::string source_of(const CheckInfo& info);

/// "data, parameters".
[[nodiscard]] std::string list_of(Purposes purposes);

/// Checks of one kind, in the order of the table.
[[nodiscard]] std::vector<const CheckInfo*> checks_of(CheckedOf of);

/// All checks as tables of Markdown, one for each of `CheckedOf`: what docs/judgement.md holds.
[[nodiscard]] std::string checks_in_markdown();

}  // namespace veridyn::estimation
