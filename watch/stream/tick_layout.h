#pragma once
// Which numbers a tick has, in which order, and what they are called where they have
// names: readings, then commands, in the order of the setup.

#include <cstddef>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct TickChannel {
  std::string name;    ///< of the setup
  std::string unit;    ///< SI
  std::string column;  ///< its name in lines with a header: [record], else the name
  /// Unit of that column; empty: what the header says, SI if it says nothing.
  std::string column_unit = {};
};

struct TickLayout {
  std::vector<TickChannel> channels;
  std::size_t outputs = 0;  ///< how many of them are readings
  TickChannel time{"time", "s", "time"};
  double sample_time = 0.0;  ///< the control tick [s]

  std::size_t inputs() const { return channels.size() - outputs; }
};

TickLayout LayoutOf(const Setup& setup);

/// "x [m], y [m], u_x [N]"
std::string LayoutText(const TickLayout& layout);

}  // namespace mjdiag
