#pragma once

#include <string>

#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The channel of a measured record, in the unit that the setup gives it. InputError if
/// it is missing or in another unit.
const Channel& MeasuredChannel(const Record& measured, const std::string& name,
                               const std::string& unit);

}  // namespace mjdiag
