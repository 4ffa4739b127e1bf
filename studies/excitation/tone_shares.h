#pragma once
// How an axis best shares what it may do among tones. With s_k the share of its limits
// that tone k has, sum_k s_k <= 1 keeps every limit, for peaks add up at most, and
//
//   I = I_moves + sum_k s_k^2 I_k
//
// with I_k the information of that tone at its limit. The largest standard deviation of
// what is wanted is made small by exchanges: shares go from one tone to another as long as
// one of them makes it smaller. Information is convex in shares: few tones are best, of
// which there have to be enough to tell the unknowns apart.

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace mjdiag {

/// A tone that an axis might have.
struct ToneChoice {
  std::size_t axis = 0;
  double frequency = 0.0;       ///< [Hz]
  double amplitude = 0.0;       ///< at the limits of the axis [m or rad]
  Eigen::MatrixXd information;  ///< at that amplitude, over the whole motion
};

struct ToneShares {
  Eigen::VectorXd shares;  ///< of every choice
  double log_sd = 0.0;     ///< logarithm of the largest standard deviation wanted
};

/// @param wanted  indices into the unknowns
double LargestLogSd(const Eigen::MatrixXd& information,
                    const std::vector<Eigen::Index>& wanted);

/// @param fixed   information of what moves besides tones, regular
/// @param budget  of every axis: the sum of its shares
/// @param stop    whether to end with what there is
ToneShares ShareTones(const std::vector<ToneChoice>& choices,
                      const Eigen::MatrixXd& fixed, const Eigen::VectorXd& budget,
                      const std::vector<Eigen::Index>& wanted,
                      const std::function<bool()>& stop);

}  // namespace mjdiag
