#pragma once
// The page of `mjdiag discover`: what the simulation gets wrong, why, and what it
// gains to put that in.

#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// What a page of a discovery says beside it.
struct DiscoveryRun {
  RunDescription run;
  std::string validation;      ///< name of the validation file; empty: none
  std::string extended_plant;  ///< path of the MJCF file; empty: none
};

/// The whole page.
Page DiscoveryPage(const Discovery& discovery, const DiscoveryRun& run);

}  // namespace mjdiag
