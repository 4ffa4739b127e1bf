#include "mjdiag/render/trace.h"

#include <algorithm>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kReferenceSuffix = "_ref";

const Channel& TracedChannel(const Record& record, const std::string& name) {
  const Channel* channel = record.Find(name);
  if (channel == nullptr) {
    throw InputError("record", "no channel \"" + name + "\"",
                     "the axis and its reference in every run");
  }
  return *channel;
}

}  // namespace

double TraceValue(const Trace& trace, std::size_t run, const Record& record,
                  double time) {
  return SampleAt(record, trace.runs[run], time);
}

std::vector<std::string> TrackedAxes(const Record& record) {
  std::vector<std::string> axes;
  for (const Channel& channel : record.channels()) {
    if (record.Find(channel.name + std::string(kReferenceSuffix)) != nullptr) {
      axes.push_back(channel.name);
    }
  }
  return axes;
}

std::vector<Trace> TrackingErrors(std::span<const Record* const> runs,
                                  const std::vector<std::string>& axes) {
  std::vector<Trace> traces;
  for (const std::string& axis : axes) {
    Trace trace{axis + " error", axis + " tracking error", "", {}};
    for (const Record* run : runs) {
      const Channel& measured = TracedChannel(*run, axis);
      const Channel& reference =
          TracedChannel(*run, axis + std::string(kReferenceSuffix));
      trace.unit = measured.unit;
      trace.runs.emplace_back(reference.samples - measured.samples);
    }
    traces.push_back(std::move(trace));
  }
  return traces;
}

ValueRange RangeWithZero(const Trace& trace, std::span<const Record* const> runs,
                         TimeRange range) {
  ValueRange values;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SampleRange within = SamplesWithin(*runs[i], range);
    const auto samples = trace.runs[i].segment(within.first, within.count());
    values.low = std::min(values.low, samples.minCoeff());
    values.high = std::max(values.high, samples.maxCoeff());
  }
  return values;
}

}  // namespace mjdiag
