#include "mjdiag/discovery/fit/pruned_fit.h"

#include <cmath>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

ModelFit Pruned(const std::vector<Block>& blocks, ModelFit fit, const FitOf& fit_of) {
  for (bool again = true; again;) {
    again = false;
    const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, fit.model);
    const VectorXd x = Place(coordinates, fit.model);
    for (std::size_t m = 0; m < fit.model.size() && !again; ++m) {
      double worth = 0.0;
      bool is_sized = false;
      for (std::size_t i = 0; i < coordinates.size(); ++i) {
        const auto place = static_cast<Index>(i);
        if (coordinates[i].member != m || !coordinates[i].is_known) continue;
        is_sized = true;
        worth += std::pow(x[place] / fit.sd[place], 2);
      }
      const double price = blocks[fit.model[m].block].price;
      if (!is_sized || worth > price) continue;
      ModelFit tried = fit_of(Without(fit.model, m));
      again = tried.score() < fit.score();
      if (again) fit = std::move(tried);
    }
  }
  return fit;
}

}  // namespace mjdiag
