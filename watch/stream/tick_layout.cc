#include "mjdiag/watch/stream/tick_layout.h"

namespace mjdiag {
namespace {

void TakeColumn(const ColumnSpec& spec, TickChannel& channel) {
  channel.column = spec.column;
  channel.column_unit = spec.unit;
}

}  // namespace

TickLayout LayoutOf(const Setup& setup) {
  TickLayout layout;
  layout.sample_time = setup.rates.tick();
  layout.outputs = setup.channels.sensors.size();
  for (const SensorSetup& sensor : setup.channels.sensors) {
    layout.channels.push_back({sensor.channel, sensor.unit, sensor.channel});
  }
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    layout.channels.push_back({actuator.channel, actuator.unit, actuator.channel});
  }
  if (!setup.record) return layout;
  TakeColumn(setup.record->time, layout.time);
  for (const ColumnSpec& spec : setup.record->columns) {
    for (TickChannel& channel : layout.channels) {
      if (channel.name == spec.channel) TakeColumn(spec, channel);
    }
  }
  return layout;
}

std::string LayoutText(const TickLayout& layout) {
  std::string text;
  for (const TickChannel& channel : layout.channels) {
    text += (text.empty() ? "" : ", ") + channel.name + " [" + channel.unit + "]";
  }
  return text;
}

}  // namespace mjdiag
