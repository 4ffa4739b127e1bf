#include "mjdiag/discovery/discovery.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {

Changes ChangesOfAnswer(const Discovery& discovery) {
  std::vector<Cause> causes;
  for (const FoundCause& found : discovery.causes) causes.push_back(found.cause);
  Changes changes = ChangesOf(causes);
  for (const CalibratedNumber& number : discovery.calibration) {
    if (number.factor == 1.0) continue;
    changes.numbers.emplace_back(number.number, number.factor);
  }
  return changes;
}

bool HasFound(const Discovery& discovery) {
  return !discovery.causes.empty() || std::ranges::any_of(discovery.calibration, IsOff);
}

const RecordReplay* Discovery::Fitted() const {
  return records.empty() ? nullptr : &records.front();
}

const RecordReplay* Discovery::Unseen() const {
  const auto first = std::ranges::find(records, false, &RecordReplay::seen);
  return first == records.end() ? nullptr : &*first;
}

// Data have to say more than what was known before, and something else.
constexpr double kBeyondDoubt = 0.5;

bool IsMoved(const CalibratedMoment& moment) {
  const double known = 2.0 * TwoSidedNormalQuantile(0.05) * moment.doubt;
  return moment.high - moment.low < kBeyondDoubt * known &&
         (moment.low > moment.model || moment.high < moment.model);
}

bool IsOff(const CalibratedNumber& number) {
  if (number.is_found) return true;
  const double width = std::log(number.high / number.low);
  const double known = 2.0 * TwoSidedNormalQuantile(0.05) * number.doubt;
  return width < kBeyondDoubt * known && (number.low > 1.0 || number.high < 1.0);
}

}  // namespace mjdiag
