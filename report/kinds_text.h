#pragma once
// What kinds of physics a discovery found and where, in words that need no law.

#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// "load friction at shaft".
std::string KindAt(const FoundKind& found);
/// The same with what that is and how sure: "all but certain", "likely", "possible".
std::string KindWords(const FoundKind& found);
/// One sentence with those that are rather there than not: "The model is wrong about load
/// friction at shaft (a resistance that grows with the load). "; empty without any.
std::string KindsSentence(const Discovery& discovery);
/// A row each, the most probable first.
Table KindTable(const Discovery& discovery);

}  // namespace mjdiag
