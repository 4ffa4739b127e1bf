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

/// From a share of each record to another one.
struct Stretch {
  double begin = 0.0;
  double end = 1.0;
};

/// rms of measured minus simulated of a stretch of records.
/// @param skip  samples at their start that count for nothing
std::map<std::string, double> ChannelRms(
    const std::vector<const Comparison*>& comparisons, Index skip, Stretch stretch) {
  std::map<std::string, double> squares;
  std::map<std::string, double> counts;
  for (const Comparison* comparison : comparisons) {
    for (const ChannelMismatch& channel : comparison->channels) {
      const Channel& measured = comparison->measured.At(channel.name);
      const VectorXd difference =
          measured.samples - comparison->simulated.At(channel.name).samples;
      const auto at = [&](double share) {
        return static_cast<Index>(
            std::lround(share * static_cast<double>(difference.size())));
      };
      const Index end = at(stretch.end);
      const Index first = std::min(std::max(at(stretch.begin), skip), end - 1);
      const Index n = end - first;
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

void AddMismatchFigures(Index skip, Discovery& discovery) {
  const auto figures = [&](const Comparison RecordReplay::*model) {
    std::vector<const Comparison*> seen;
    std::vector<const Comparison*> unseen;
    for (const RecordReplay& replay : discovery.records) {
      (replay.seen ? seen : unseen).push_back(&(replay.*model));
    }
    if (!unseen.empty()) {
      return Discovery::Figures{ChannelRms(seen, skip, {}),
                                ChannelRms(unseen, skip, {})};
    }
    const double share = discovery.train_share;
    return Discovery::Figures{ChannelRms(seen, skip, {0.0, share}),
                              ChannelRms(seen, skip, {share, 1.0})};
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
