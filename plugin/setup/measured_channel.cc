#include "mjdiag/plugin/setup/measured_channel.h"

#include "mjdiag/signals/error.h"

namespace mjdiag {

const Channel& MeasuredChannel(const Record& measured, const std::string& name,
                               const std::string& unit) {
  const Channel& channel = measured.At(name);
  if (channel.unit != unit) {
    throw InputError("record", "channel '" + name + "' is in '" + channel.unit + "'",
                     unit + "; a column under [record.channels] may give the unit");
  }
  return channel;
}

}  // namespace mjdiag
