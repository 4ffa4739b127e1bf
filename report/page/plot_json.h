#pragma once
// Plots as the script of a page reads them.

#include <nlohmann/json.hpp>

#include "mjdiag/report/page/plot.h"

namespace mjdiag {

/// The plot as a JSON object for the page's script. InputError if x and y, edges and
/// counts, or frequencies and magnitudes do not go together.
nlohmann::json DescribePlot(const TimePlot& plot);
nlohmann::json DescribePlot(const SpectrumPlot& plot);
nlohmann::json DescribePlot(const XyPlot& plot);
nlohmann::json DescribePlot(const HistogramPlot& plot);
nlohmann::json DescribePlot(const BodePlot& plot);

}  // namespace mjdiag
