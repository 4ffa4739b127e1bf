#pragma once

#include <Eigen/Core>

namespace mjdiag {

/// The step q of an encoder behind a filter, whose readings have values between its steps,
/// but rest on them: half of the differences from one value that repeats to the next that
/// does are one, two or three of it. 0 where fewer than six values repeat, or they differ
/// otherwise, as those of a bus that is slower than the record. [unit of x]
double EncoderStep(const Eigen::VectorXd& x);

}  // namespace mjdiag
