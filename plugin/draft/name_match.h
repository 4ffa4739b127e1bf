#pragma once
// Which column is of which place of a plant, by names and units alone.
//
// Pairs are decided in the order of what is surer: a column that is called as the sensor, the
// joint or the motor; rows of numbered columns, q1 .. q6, beside joints that have numbers or
// are as many; then the one that agrees best, if no other column and no other place agree as
// well. Only what a column can be by its quantity, its unit and its role counts.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/draft/column_words.h"
#include "mjdiag/plugin/draft/plant_places.h"

namespace mjdiag {

/// Of a reading or a drive, by their numbers.
struct ColumnChoice {
  std::optional<std::size_t> column;  ///< that which is it; none: none is, or see below
  /// Others that could be it: with `column` those that stood behind it (a command behind
  /// what was measured), without it those between which nothing decides.
  std::vector<std::size_t> others;
  bool by_order = false;        ///< numbered columns, joints without numbers
  bool by_elimination = false;  ///< the names have nothing in common
};

/// One of each reading. Speeds are taken where no position of their joint is there; sensors
/// of other kinds by their own name alone.
std::vector<ColumnChoice> MatchReadings(const std::vector<Reading>& readings,
                                        const std::vector<ColumnWords>& columns);

/// One of each drive. What was measured goes before what was commanded, that before what was
/// wanted; a servo takes what it was told. Of the same place and role the unit decides: a
/// force for a motor whose control is its force, a voltage where there is back EMF.
/// @param taken  columns that are readings
std::vector<ColumnChoice> MatchDrives(const std::vector<Drive>& drives,
                                      const std::vector<ColumnWords>& columns,
                                      const std::vector<bool>& taken);

}  // namespace mjdiag
