#pragma once
// The most likely noise along one path of a machine (noise_fit.h): -2 ln L of linear passes
// over pieces of it, by logarithms of the noises. Coarse steps of 64 of one kind of noise after
// the other (sizes, memories, both along the same random walk, white forces, readings), on a
// quarter of the pieces, in which every joint goes to where the parabola through -2 ln L of the
// sensor that shows it best is least; then downhill by the slope (noise_slope.h).

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

/// Four pieces of a record, of `of_all` samples of `sensors` of a run; of a short one all of
/// it.
/// @param states  of a filter: of few, more samples take no longer
std::vector<Stretch> PiecesOf(Eigen::Index first, Eigen::Index count,
                              Eigen::Index of_all, Eigen::Index sensors,
                              Eigen::Index states);

/// The sensor that shows each latent force best, and the force that moves its reading by
/// its noise in a tick.
struct Shown {
  std::vector<Eigen::Index> by;
  Eigen::VectorXd unit;  // nf
};

Shown ShownBy(const TickTangent& tangent, const std::vector<Eigen::Index>& dofs,
              const Eigen::VectorXd& reading_sd);

/// A noise, and -2 ln L of the pieces behind it.
struct LikelyNoise {
  FilterNoise noise;
  double deviance = 0.0;
};

class NoiseSearch {
 public:
  /// @param longest  memory [s]
  NoiseSearch(const FilterPath& path, const Eigen::VectorXd& reading_sd,
              double longest);

  /// Forces that, as long as they last, move readings by their noise.
  FilterNoise Slow(FilterNoise noise) const;
  /// From a noise on: by coarse steps where it may be far off, then downhill. A clock that
  /// shows is different at every reading, so that no gain is kept: it is asked for last.
  LikelyNoise Descend(const FilterNoise& noise, bool is_far) const;

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
