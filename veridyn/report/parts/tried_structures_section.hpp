#pragma once

#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The structures of the model that were fitted, in a table: which one was taken, what each gained, how it predicts the
/// hold-out, and its parameters, which show what a structure that is too simple does to them. Why the one was taken
/// stands above, what kept others from being taken below. One alone is named without a table. Empty where no structure
/// was tried.
[[nodiscard]] Section tried_structures_section(const estimation::Estimate& estimate);

}  // namespace veridyn::report
