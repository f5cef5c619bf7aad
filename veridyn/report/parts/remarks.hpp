#pragma once

#include <string>
#include <vector>

#include "veridyn/report/document/document.hpp"

/// What a report says besides its results.
namespace veridyn::report {

/// A section of the run's warnings at the end of the document; nothing without a warning.
void add_warnings(Document& document, const std::vector<std::string>& warnings);

/// The same for notes, which do not warn.
void add_notes(Document& document, const std::vector<std::string>& notes);

/// A document that says which program made it.
[[nodiscard]] Document started_document(std::string title, std::string subtitle, const std::string& program);

}  // namespace veridyn::report
