#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/report/document/document.hpp"

/// What figures of all domains make their curves of.
namespace veridyn::report {

/// Every value times a factor: from SI to the unit shown.
[[nodiscard]] std::vector<double> scaled(std::span<const double> values, double factor);

/// Whether any value is a number: a line without one is not drawn.
[[nodiscard]] bool any_finite(std::span<const double> values);

/// The stretches of a record whose parts lie far apart, to be shown side by side: cut where neighbours are more than
/// ten median spacings apart. Stretches of a single sample have no length and are left out. `time` increasing.
[[nodiscard]] std::vector<Window> windows_of(std::span<const double> time);

/// Spans over the moments at which `holds` is true, from the first to the last of each run. Sizes equal.
[[nodiscard]] std::vector<Span> spans_where(std::span<const double> time, const std::vector<bool>& holds,
                                            std::string_view label, SpanTone tone);

/// A line followed on line with its 95 % band, without what is wild before there are data: values beyond four times
/// `largest` and those without a finite sigma are missing, and the band ends at four times `largest`.
[[nodiscard]] Line followed_line(std::vector<double> value, std::span<const double> sigma, double largest);

}  // namespace veridyn::report
