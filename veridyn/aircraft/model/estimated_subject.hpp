#pragma once

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// The terms of `structure` that the estimate holds a value for under their `names` (one per term), with these values.
/// Terms that it dropped or rejected are left out, so the result may be smaller, or empty, as where alongside rejected
/// terms there are only held ones.
[[nodiscard]] CoefficientModel estimated_coefficient(const CoefficientModel& structure,
                                                     const std::vector<std::string>& names,
                                                     const estimation::Estimate& estimate);

/// The subject with the estimate's model: each coefficient as `estimated_coefficient`; one of which the estimate holds
/// nothing keeps its terms with unknown values, so that nothing can be simulated with what was not identified.
/// @param place of the estimate in messages: its file
/// @throws InputError when the estimate names a parameter that the subject's model does not have, or holds nothing
/// usable of it.
[[nodiscard]] Subject estimated_subject(const Subject& subject, const estimation::Estimate& estimate,
                                        const std::string& place);

/// Subject and model as one JSON object: mass, geometry, inertia, sign convention, and per coefficient a list of
/// {"term", "name", "unit", "value"}, with "sigma" and "status" where `estimate` is given; unknown values are null.
[[nodiscard]] std::string to_json(const Subject& subject, const estimation::Estimate* estimate = nullptr);

}  // namespace veridyn::aircraft
