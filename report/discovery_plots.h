#pragma once
// The plots of a discovery: the mismatch before and after, the force that the model
// lacks, and that force over what it depends on.

#include <cstddef>
#include <string>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/plot.h"

namespace mjdiag {

/// Measured - simulated of the channels furthest above their noise floor, at most
/// `most` of them; what was left out of the figures is left out here.
/// @param after         the same record on the extended plant, or null
/// @param fitted_share  of the record that fits saw, the rest is shaded; 0: unknown
std::vector<TimePlot> MismatchPlots(const Comparison& before, const Comparison* after,
                                    double fitted_share, std::size_t most);

/// The unexplained signals over time between +-2 sd, without the samples at the ends
/// where that is larger; each as the plant was given, then as extended.
std::vector<TimePlot> UnexplainedPlots(const Discovery& discovery);

/// The points and the law through them.
XyPlot PlotOf(const LawPlot& law);

/// How what is left depends on its variable, between +-2 sd.
/// @param unit  of what is left; empty: not known
XyPlot ResidualDependencePlot(const ResidualDependence& signature,
                              const std::string& unit);

}  // namespace mjdiag
