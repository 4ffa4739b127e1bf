#pragma once
// Values that predict. Where a model lacks something that lasts, the likeliest values are those
// of what is quick: forces that last are noise, of which the next reading tells next to nothing.
// People run the plant without that noise, and what lasts is what makes it stray. Least squares
// of the missing forces themselves weigh what lasts as what is quick,
//
//   min over x of  sum over samples of |f_missing(x)|^2 / s^2,
//
// s what is missing now, rms; of a model that lacks nothing these are the same values, less
// well known. Which of the two predict, the data say that no fit saw: errors over a horizon
// (comparison/prediction.h).

#include <functional>
#include <optional>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/model_on_runs.h"

namespace mjdiag {

struct BetterValues {
  ModelOnRuns answer;
  /// Mean logarithm, over the sensors, of its errors over those of the likeliest values: the
  /// greater of that of what fits saw and that of what no fit saw.
  double log_ratio = 0.0;
};

/// The model with such values of how large its members are, where both what fits saw and what
/// no fit saw is predicted better.
/// @param given  noise of the machine as given
std::optional<BetterValues> WithValuesThatPredict(const AnswerData& data,
                                                  const ModelOnRuns& answer,
                                                  const FilterNoise& given,
                                                  const std::function<bool()>& is_over);

}  // namespace mjdiag
