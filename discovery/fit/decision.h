#pragma once
// What a discovery tried, and why it is in the answer or not, for people.

#include <string>

namespace mjdiag {

struct Decision {
  std::string tried;   ///< a model, or what was done to one
  double score = 0.0;  ///< -2 ln of how much more probable the model before was
  std::string why;     ///< what came of it
};

}  // namespace mjdiag
