#pragma once
// Machines that a search for causes has not met: a double pendulum, a cart with a pole and
// a leg on a boom, each with one thing hidden, under controllers that no setup has.

#include <functional>
#include <string>
#include <vector>

#include "support/hidden_cases/hidden_case.h"
#include "support/hidden_cases/own_computer.h"

namespace mjdiag::test {

struct SmallMachine {
  std::string name;
  std::string plant;      ///< MJCF
  std::string setup;      ///< setup.toml
  double duration = 8.0;  ///< of a record [s]
  /// Where it begins, nq; empty: where it rests.
  Eigen::VectorXd start = {};
  /// The controller that makes it go along a motion of its own a draw.
  std::function<OwnComputer::Law(CaseDice dice)> controller;
  std::vector<HiddenCase> cases;
};

const std::vector<SmallMachine>& SmallMachines();

}  // namespace mjdiag::test
