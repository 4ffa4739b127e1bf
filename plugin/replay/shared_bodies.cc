#include "mjdiag/plugin/replay/shared_bodies.h"

#include <algorithm>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

SharedBodies::SharedBodies(const TickMap& map, const FilterPath& path)
    : own_(TangentSize(map.model())), states_(map.states()) {
  for (const ActiveEffects::BodyOf& body : map.bodies()) {
    const auto found =
        std::ranges::find(path.bodies, std::pair(body.effect, body.number));
    places_.push_back(found == path.bodies.end() ? -1 : found - path.bodies.begin());
  }
}

VectorXd SharedBodies::Pulled(const VectorXd& z) const {
  VectorXd pulled = VectorXd::Zero(states_);
  pulled.head(own_) = z.head(own_);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i] < 0) continue;
    pulled.segment<2>(own_ + 2 * static_cast<Index>(i)) =
        z.segment<2>(own_ + 2 * places_[i]);
  }
  return pulled;
}

PlantState SharedBodies::Placed(PlantState state, const VectorXd& before) const {
  VectorXd bodies = before;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i] < 0) continue;
    bodies.segment<2>(2 * static_cast<Index>(i)) =
        state.bodies.segment<2>(2 * places_[i]);
  }
  state.bodies = std::move(bodies);
  return state;
}

}  // namespace mjdiag
