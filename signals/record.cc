#include "mjdiag/signals/record.h"

#include <cmath>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

std::string ListNames(const std::vector<Channel>& channels) {
  if (channels.empty()) return "a channel (the record has none)";
  std::string names = "one of";
  for (const Channel& channel : channels) {
    names += (&channel == &channels.front() ? " " : ", ") + channel.name;
  }
  return names;
}

}  // namespace

Eigen::VectorXd Channel::Measured() const { return Kept(samples, measured); }

Record::Record(double sample_time, double start_time)
    : sample_time_(sample_time), start_time_(start_time) {
  if (!(sample_time > 0.0) || !std::isfinite(sample_time)) {
    throw InputError("record", "sample time " + std::to_string(sample_time) + " s",
                     "a positive time");
  }
  if (!std::isfinite(start_time)) {
    throw InputError("record", "start time " + std::to_string(start_time) + " s",
                     "a finite time");
  }
}

Eigen::Index Record::samples() const {
  return channels_.empty() ? 0 : channels_.front().samples.size();
}

const Channel* Record::Find(std::string_view name) const {
  for (const Channel& channel : channels_) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

const Channel& Record::At(std::string_view name) const {
  if (const Channel* channel = Find(name)) return *channel;
  throw InputError("record", "no channel \"" + std::string(name) + "\"",
                   ListNames(channels_));
}

void Record::Add(Channel channel) {
  if (Find(channel.name)) {
    throw InputError("record", "a second channel \"" + channel.name + "\"",
                     "every name once");
  }
  if (!channels_.empty() && channel.samples.size() != samples()) {
    throw InputError("record",
                     "channel \"" + channel.name + "\" has " +
                         std::to_string(channel.samples.size()) + " samples",
                     std::to_string(samples()) + " as the other channels have");
  }
  if (channel.measured.size() > 0 &&
      channel.measured.size() != channel.samples.size()) {
    throw InputError("record",
                     "channel \"" + channel.name + "\" says of " +
                         std::to_string(channel.measured.size()) +
                         " samples whether they were measured",
                     "of none or of all " + std::to_string(channel.samples.size()));
  }
  channels_.push_back(std::move(channel));
}

Record Record::Slice(Eigen::Index first, Eigen::Index count) const {
  if (first < 0 || count < 0 || first + count > samples()) {
    throw InputError("record",
                     "samples " + std::to_string(first) + " to " +
                         std::to_string(first + count - 1) + " asked for",
                     "samples within 0 to " + std::to_string(samples() - 1));
  }
  Record slice(sample_time_, start_time_ + static_cast<double>(first) * sample_time_);
  for (const Channel& channel : channels_) {
    slice.Add({channel.name, channel.unit, channel.samples.segment(first, count)});
    if (channel.measured.size() == 0) continue;
    const SampleMask measured = channel.measured.segment(first, count);
    if (!measured.all()) slice.channels_.back().measured = measured;
  }
  return slice;
}

Eigen::VectorXd Record::Time() const {
  return Eigen::VectorXd::NullaryExpr(samples(), [this](Eigen::Index k) {
    return start_time_ + static_cast<double>(k) * sample_time_;
  });
}

Eigen::MatrixXd SamplesOf(const Record& record, const std::vector<std::string>& names) {
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(names.size()), record.samples());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    samples.row(i) = record.At(names[static_cast<std::size_t>(i)]).samples;
  }
  return samples;
}

Eigen::ArrayXX<bool> MeasuredOf(const Record& record,
                                const std::vector<std::string>& names) {
  Eigen::ArrayXX<bool> measured;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const SampleMask& of_channel = record.At(names[i]).measured;
    if (of_channel.size() == 0) continue;
    if (measured.size() == 0) {
      measured.setConstant(static_cast<Eigen::Index>(names.size()), record.samples(),
                           true);
    }
    measured.row(static_cast<Eigen::Index>(i)) = of_channel.transpose();
  }
  return measured;
}

Eigen::VectorXd Kept(const Eigen::VectorXd& values, const SampleMask& mask) {
  if (mask.size() == 0) return values;
  Eigen::VectorXd kept(mask.count());
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (mask[k]) kept[next++] = values[k];
  }
  return kept;
}

}  // namespace mjdiag
