#pragma once

#include <string>

#include "veridyn/core/study.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"

namespace veridyn::estimation {

/// A study's text of a subject with the grades of its identification: as a sentence at its head, and as a table that
/// whoever reads the subject finds.
///
///     # The recording agrees with itself and with physics; ...
///     [subject]
///     ...
///     [subject.grades]
///     data = "yes"
///     parameters = "with care"
///     prediction = "no"
[[nodiscard]] std::string graded_toml(const std::string& toml, const Judgement& judgement);

/// The table of grades that a [subject] carries, to be written with it again; empty: it has none.
[[nodiscard]] std::string grades_table(const StudyTable& subject);

/// What has to be said where the numbers of a [subject] are used as those of the individual; empty: nothing.
/// @throws InputError where they were rejected: neither parameters nor prediction are for use. `accept_rejected = true`
/// in the subject makes a warning of it. InputError too for a grade that there is not.
[[nodiscard]] std::string grades_warning(const StudyTable& subject);

}  // namespace veridyn::estimation
