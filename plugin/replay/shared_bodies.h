#pragma once
// The bodies of effects that a machine has beside that of a path (FilterPath::bodies), which
// may have others.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

class SharedBodies {
 public:
  SharedBodies(const TickMap& map, const FilterPath& path);

  /// What the state of the map is pulled by where that of the path is by z; nothing pulls
  /// what the path does not have.
  Eigen::VectorXd Pulled(const Eigen::VectorXd& z) const;
  /// A state of the path, with what the path does not have where it was.
  PlantState Placed(PlantState state, const Eigen::VectorXd& before) const;

 private:
  Eigen::Index own_;                  // 2 nv + na
  Eigen::Index states_;               // of the map
  std::vector<Eigen::Index> places_;  // of each in the path, -1: none
};

}  // namespace mjdiag
