#pragma once
// A record: uniformly sampled, named channels in SI units. It is the one currency
// between the folders. A simulated record and a measured one are the same type.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace mjdiag {

/// One of each sample; empty: true for all of them.
using SampleMask = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// One signal of a record. `unit` is the SI unit of `samples` ("m", "rad", "N", "N m",
/// "A", "V", "m/s", ...; "1" for a pure number).
struct Channel {
  std::string name;
  std::string unit;
  Eigen::VectorXd samples;
  /// Which samples were measured. The others bridge those beside them, for what needs a
  /// number at every tick, and say nothing: no figure and no estimate counts them.
  SampleMask measured{};

  bool IsMeasured(Eigen::Index k) const { return measured.size() == 0 || measured[k]; }
  /// Those that were measured, without gaps between them.
  Eigen::VectorXd Measured() const;
};

/// Channels sampled together at t_k = start_time + k * sample_time, k = 0 .. samples-1.
class Record {
 public:
  Record() = default;
  /// @param sample_time  time between samples [s], > 0, else InputError
  /// @param start_time   time of the first sample [s]
  explicit Record(double sample_time, double start_time = 0.0);

  double sample_time() const { return sample_time_; }
  double start_time() const { return start_time_; }
  /// Number of samples; 0 without channels.
  Eigen::Index samples() const;
  /// samples * sample_time [s]
  double duration() const { return static_cast<double>(samples()) * sample_time_; }
  const std::vector<Channel>& channels() const { return channels_; }

  /// The channel of that name, or null.
  const Channel* Find(std::string_view name) const;
  /// The channel of that name; InputError that lists the existing ones without it.
  const Channel& At(std::string_view name) const;
  /// Appends a channel. InputError on a repeated name or another length than the rest, of
  /// its mask, too.
  void Add(Channel channel);
  /// Samples first .. first+count-1 of every channel, with the matching start time.
  Record Slice(Eigen::Index first, Eigen::Index count) const;
  /// t_k of every sample [s].
  Eigen::VectorXd Time() const;

 private:
  double sample_time_ = 0.0;
  double start_time_ = 0.0;
  std::vector<Channel> channels_;
};

/// Samples of the channels of these names, names x samples. InputError as Record::At.
Eigen::MatrixXd SamplesOf(const Record& record, const std::vector<std::string>& names);
/// Which of them were measured, names x samples; empty: all of them.
Eigen::ArrayXX<bool> MeasuredOf(const Record& record,
                                const std::vector<std::string>& names);
/// The values where the mask is true, as many as there are.
Eigen::VectorXd Kept(const Eigen::VectorXd& values, const SampleMask& mask);

}  // namespace mjdiag
