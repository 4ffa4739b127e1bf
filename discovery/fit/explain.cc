#include "mjdiag/discovery/fit/explain.h"

#include "mjdiag/discovery/fit/model_search.h"

namespace mjdiag {

Explained Explain(const Machine& machine, const MeasuredRun& run,
                  const Eigen::VectorXd& reading_sd, const ExplainOptions& options) {
  return ModelSearch(machine, run, reading_sd, options).Run();
}

}  // namespace mjdiag
