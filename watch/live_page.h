#pragma once
// The page itself.

#include <string>

#include "mjdiag/watch/live_server.h"

namespace mjdiag {

/// One document, all that it needs in it.
/// @param title  plain text
std::string LivePage(const std::string& title, const PageParts& parts);

}  // namespace mjdiag
