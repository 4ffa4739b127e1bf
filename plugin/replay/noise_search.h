#pragma once
// The most likely noise along one path of a machine (noise_fit.h): -2 ln L of linear passes
// along it, by logarithms of the noises. Coarse steps of 64 of one kind of noise after the
// other (sizes, memories, both along the same random walk, white forces, readings), on some
// pieces, in which every joint goes to where the parabola through -2 ln L of the sensor that
// shows it best is least; then downhill by the slope (noise_slope.h), along all of it: what is
// missing is not the same at all times, and a noise that is likeliest by a part is off by
// hundreds of -2 ln L by the whole.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// Samples first .. first + count - 1 of a record.
struct Stretch {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Of a run, samples that tell a noise well enough to begin with.
/// @param states  of a filter: of few, more samples take no longer
Eigen::Index EnoughOf(Eigen::Index sensors, Eigen::Index states);

/// Four pieces of a record, together its part of `enough` of the samples of a run; of a short
/// run all of it.
std::vector<Stretch> PiecesOf(Eigen::Index first, Eigen::Index count,
                              Eigen::Index of_all, Eigen::Index enough);

/// The sensor that shows each latent force best, and the force that moves its reading by
/// its noise in a tick.
struct Shown {
  std::vector<Eigen::Index> by;
  Eigen::VectorXd unit;  // nf
};

Shown ShownBy(const TickTangent& tangent, const std::vector<Eigen::Index>& dofs,
              const Eigen::VectorXd& reading_sd);

/// What takes seconds.
inline constexpr Eigen::Index kMostReadings = 40000;
/// What tells a noise to 1.4 %.
inline constexpr Eigen::Index kFewReadings = 10000;

/// A noise, and -2 ln L of the pieces behind it.
struct LikelyNoise {
  FilterNoise noise;
  double deviance = 0.0;
  double gain = 0.0;  ///< beside that which it began with
};

class NoiseSearch {
 public:
  /// @param longest   memory [s]
  /// @param readings  so many of the path at most
  NoiseSearch(const FilterPath& path, const Eigen::VectorXd& reading_sd, double longest,
              Eigen::Index readings = kMostReadings);

  /// Forces that, as long as they last, move readings by their noise.
  FilterNoise Slow(FilterNoise noise) const;
  /// From a noise on: by coarse steps where it may be far off, then downhill. A clock that
  /// shows is different at every reading, so that no gain is kept: it is asked for last.
  LikelyNoise Descend(const FilterNoise& noise, bool is_far) const;
  /// Whether it looks at all of the path.
  bool LooksAtAll() const {
    Eigen::Index samples = 0;
    for (const Stretch& piece : pieces_) samples += piece.count;
    return samples == path_.samples();
  }

 private:
  /// A point of the search, and -2 ln L there of every sensor.
  struct Point {
    Eigen::VectorXd x;
    Eigen::VectorXd deviances;
    double deviance() const { return deviances.sum(); }
  };
  /// Directions with the sensor that judges each.
  using Kind = std::vector<std::pair<Eigen::VectorXd, Eigen::Index>>;

  Eigen::Index clock() const { return 3 * nf_ + ny_; }
  FilterNoise NoiseOf(const Eigen::VectorXd& x) const;
  Eigen::VectorXd WithClock(Eigen::VectorXd x, double size) const;
  Point Evaluate(const Eigen::VectorXd& x, const std::vector<Stretch>& by) const;
  /// One step of every joint or sensor of a kind; false if nothing is gained.
  bool Move(const Kind& kind, double step, Point& best) const;
  /// By steps of 64 of every kind: what is next to nothing has no slope.
  Eigen::VectorXd Hop(const Eigen::VectorXd& x) const;
  LikelyNoise Downhill(const Eigen::VectorXd& x, bool with_clock) const;

  const FilterPath& path_;
  std::vector<Stretch> pieces_;
  std::vector<Stretch> quarter_;
  Eigen::Index nf_;
  Eigen::Index ny_;
  Eigen::VectorXd unit_;
  Eigen::VectorXd lower_,
      upper_;  // by logarithms: size, memory, white (nf each), readings,
               // the clock and its memory
  std::vector<Kind> kinds_;
};

}  // namespace mjdiag
