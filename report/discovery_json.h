#pragma once
// `discovery.json`: what a discovery found, for other programs.

#include <nlohmann/json.hpp>
#include <string>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// schema "mjdiag.discovery/1". A fault parameter off its healthy value is a cause
/// whose effect is its name and whose only parameter is "value". Beside the fields of
/// the design:
///
///   causes[].fault, parameters.<name>.sd, alternatives[].indistinguishable
///   explanations [{probability, causes: [{effect, site, fault}]}]: all sets of causes
///                that the record leaves possible, likeliest first (explanations.h)
///   units        {channel: unit of its mismatch and floor}
///   whiteness    {before, after}: share of the innovations' power that is white
///   train_share  of the record that fits saw
///   derived      {before, after: {record, validation: {signal: error [%]}}}
///   ladder       [{added, train, held_out, error_percent, validation_percent}]
///   fault_limits [{fault, before, after}]: smallest detectable change
///   unexplained  {signature, site, variable, factor, shape, explained_share, period,
///                exponent, runner_up, runner_up_share}
///   budget       {used, limit, stopped, left_out: [text]}, in seconds
///   notes        [text]
///
/// All in SI units. Numbers without a finite value are null, and so is a figure that
/// was not computed, such as that of a validation record that was not given.
/// @param extended_plant  path of its MJCF file; empty: none was written
nlohmann::json ToJson(const Discovery& discovery, const std::string& extended_plant);

}  // namespace mjdiag
