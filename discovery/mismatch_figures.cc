#include "mjdiag/discovery/mismatch_figures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// rms of measured minus simulated of records, samples first .. first + samples - 1.
/// @param samples  0: to the end
std::map<std::string, double> ChannelRms(
    const std::vector<const Comparison*>& comparisons, Index first, Index samples) {
  std::map<std::string, double> squares;
  std::map<std::string, double> counts;
  for (const Comparison* comparison : comparisons) {
    for (const ChannelMismatch& channel : comparison->channels) {
      const Channel& measured = comparison->measured.At(channel.name);
      const VectorXd difference =
          measured.samples - comparison->simulated.At(channel.name).samples;
      const Index n = samples > 0 ? samples : difference.size() - first;
      const VectorXd counted =
          measured.measured.size() == 0
              ? VectorXd(difference.segment(first, n))
              : Kept(difference.segment(first, n), measured.measured.segment(first, n));
      squares[channel.name] += counted.squaredNorm();
      counts[channel.name] += static_cast<double>(counted.size());
    }
  }
  for (auto& [name, square] : squares) square = std::sqrt(square / counts[name]);
  return squares;
}

/// 1 - after / before, of the root mean square over noise floor of all channels.
double GainOf(const std::map<std::string, double>& before,
              const std::map<std::string, double>& after,
              const std::map<std::string, double>& floor) {
  double was = 0.0;
  double is = 0.0;
  for (const auto& [channel, rms] : before) {
    const double scale = std::max(floor.at(channel), 1e-300);
    was += std::pow(rms / scale, 2);
    is += std::pow(after.at(channel) / scale, 2);
  }
  return was > 0.0 ? 1.0 - std::sqrt(is / was) : 0.0;
}

}  // namespace

void SetGains(Discovery& discovery) {
  discovery.gain_train = GainOf(discovery.mismatch_before.train,
                                discovery.mismatch_after.train, discovery.noise_floor);
  discovery.gain_validation =
      GainOf(discovery.mismatch_before.validation, discovery.mismatch_after.validation,
             discovery.noise_floor);
}

void AddMismatchFigures(Index first, Index train, Index samples, Discovery& discovery) {
  const auto figures = [&](const Comparison RecordReplay::*model) {
    std::vector<const Comparison*> seen;
    std::vector<const Comparison*> unseen;
    for (const RecordReplay& replay : discovery.records) {
      (replay.seen ? seen : unseen).push_back(&(replay.*model));
    }
    return Discovery::Figures{
        ChannelRms(seen, first, samples),
        unseen.empty() ? ChannelRms(seen, train, 0) : ChannelRms(unseen, first, 0)};
  };
  discovery.mismatch_before = figures(&RecordReplay::before);
  discovery.mismatch_after = figures(&RecordReplay::after);
  for (const ChannelMismatch& channel : discovery.Fitted()->after.channels) {
    discovery.noise_floor[channel.name] = channel.noise_floor.rms;
    discovery.unit[channel.name] = channel.unit;
  }
  SetGains(discovery);
}

}  // namespace mjdiag
