#pragma once
// The page of `mjdiag design`: from which degree on the machine has parity relations,
// what healthy runs leave in the residual and where its thresholds lie ([AB383],
// Fig. 15 and 16), and what the filters let through (Fig. 28 to 30).

#include <optional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/report/filter_plots.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// What the linear programs of Eq. 18 give for the same machine and degree.
struct ParityProgramFacts {
  int degree = 0;
  std::string norm;  ///< that was minimised: "one" or "infinity"
  int fault_inputs = 0;
  int programs = 0;
  int feasible = 0;
  double objective =
      0.0;  ///< the norm of the relation; these three only if one is feasible
  double defect = 0.0;  ///< ParityProgramSolution::defect
  double angle = 0.0;   ///< between relation and null space of the decomposition [rad]
};

/// What a design starts from.
struct DesignFacts {
  int minimal_degree = 0;  ///< of a parity relation
  std::vector<int> observability_ranks;
  Eigen::Index states = 0;
  MechanicalModel healthy;
  std::vector<ChangedMachine> changed;  ///< for ChangePlot; may be empty
  std::optional<ParityProgramFacts> linear_program;
};

/// One sentence on the linear programs.
std::string DescribeParityPrograms(const ParityProgramFacts& facts);

/// Bars, fitted normal distribution and thresholds of the nominal residuals.
HistogramPlot ResidualHistogram(const ThresholdDesign& thresholds);

/// The whole page; plots of the residual only where its limits are known.
Page DesignPage(const DiagnosisDesign& design, const DesignFacts& facts,
                const RunDescription& run);

}  // namespace mjdiag
