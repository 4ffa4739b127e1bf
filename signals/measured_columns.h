#pragma once
// Columns as a logger left them, and the record that they are. Nothing is refused that
// something can be made of:
//
//   a row without a time, or with one that is not after those before it, is left out
//   irregular times, or another rate, go on the wanted grid (resampling.h)
//   rows and values that are missing are bridged and count as not measured (bridging.h)
//   so do the repeats of a sensor or bus that is slower than the record (fresh_samples.h)
//   the ends at which inputs have no values are cut off; those of readings, too, up to a
//   tenth of the record

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/resampling.h"

namespace mjdiag {

struct MeasuredColumns {
  Eigen::VectorXd times;          ///< [s], NaN where there is none
  std::vector<Channel> channels;  ///< in SI units, NaN where there is no value
  std::function<std::string(Eigen::Index)> place;  ///< of a time, for messages
};

/// A record, and what one should know about how it became one, sentences for people.
struct MeasuredFile {
  Record record;
  std::vector<std::string> notes;
};

/// InputError, with what to do about it: a channel with fewer than two values; rows or
/// values missing for nine tenths of the record; every tenth time not after those before
/// it; and as ChooseGrid.
MeasuredFile RecordOfColumns(const MeasuredColumns& columns,
                             const Resampling& resampling);

/// The same of a record of which nobody has said yet what of it was measured. What has
/// been said, and samples that all count, stay bitwise as they are.
MeasuredFile WithoutRepeats(const Record& record,
                            const std::map<std::string, ReadingScale>& readings);

}  // namespace mjdiag
