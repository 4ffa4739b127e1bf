// Writes the cases that a search for causes in the wire bonder is judged by
// (tests/support/hidden_cases): bonder_cases [--case NAME] [--seed N] --out DIR
//
// Each is a folder with a setup, record.csv, unseen.csv and truth.json. What the catalogue
// of effects has is there once with the plant as it is and, as NAME_off, once with three
// numbers of the given plant 1, 8 and 5 % off; laws of no list are there once. Three
// small machines are there once with nothing and once with one thing hidden.
// scripts/bonder-cases asks for causes and judges the answers.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/bonder.h"
#include "support/hidden_cases/bonder_motion.h"
#include "support/hidden_cases/bonder_run.h"
#include "support/hidden_cases/case_files.h"
#include "support/hidden_cases/own_simulator.h"
#include "support/hidden_cases/small_machines.h"

namespace mjdiag {
namespace {

using test::CaseDice;
using test::Hidden;
using test::HiddenCase;
using test::NamedFactors;

constexpr double kDuration = 1.0;  // s
constexpr double kUnseen = 0.5;    // s

struct Options {
  std::string name;
  std::string out;
  std::uint64_t seed = 1;
};

Options Parse(const std::vector<std::string>& words) {
  Options options;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--case") options.name = words[i + 1];
    if (words[i] == "--out") options.out = words[i + 1];
    if (words[i] == "--seed") options.seed = std::stoull(words[i + 1]);
  }
  if (words.size() % 2 == 1 || options.out.empty()) {
    throw InputError("bonder_cases", "arguments are missing",
                     "[--case NAME] [--seed N] --out DIR");
  }
  return options;
}

/// A mass, a damper and a spring, by how much the machine's are larger than those of the
/// given plant: none of them is what is hidden.
NamedFactors Off(const std::string& name) {
  const NamedFactors x = {
      {"mass@x_stage", 0.99}, {"damping@X", 1.08}, {"stiffness@u1", 0.95}};
  const NamedFactors y = {
      {"mass@y_stage", 1.01}, {"damping@Y", 0.92}, {"stiffness@u1", 1.05}};
  const NamedFactors z = {
      {"mass@arm", 0.99}, {"damping@Z", 1.08}, {"stiffness@u2", 0.95}};
  const std::map<std::string, NamedFactors> others = {
      {"soft_mount", y},         {"across", y},
      {"eddy_brake", y},         {"seal_and_ripple", z},
      {"motor_damper_drift", z},
  };
  const auto found = others.find(name);
  return found == others.end() ? x : found->second;
}

void Write(const Options& options, const HiddenCase& hidden, bool may_be_off) {
  const Machine machine = test::Bonder();
  const auto measure = [&](double duration, std::uint64_t part) {
    CaseDice dice(hidden.name, options.seed);
    const Hidden drawn = hidden.draw(machine, dice);
    const std::uint64_t seed = 2 * options.seed + part;
    return MeasureOwn(machine, drawn.physics,
                      BonderMotion(machine.setup(), duration, CaseDice("motion", seed)),
                      {.seed = seed});
  };
  const Record record = measure(kDuration, 0);
  const Record unseen = measure(kUnseen, 1);
  CaseDice dice(hidden.name, options.seed);
  const std::vector<test::TrueCause> truth = hidden.draw(machine, dice).truth;
  const auto write = [&](const std::string& name, const NamedFactors& numbers) {
    const std::string folder = options.out + "/" + name;
    test::WriteGivenSetup(folder, machine.setup().folder, machine, numbers);
    test::WriteCase(folder, {hidden, options.seed, truth, numbers}, machine, record,
                    unseen);
  };
  write(hidden.name, {});
  if (may_be_off) write(hidden.name + "_off", Off(hidden.name));
  std::printf("%s: %s\n", hidden.name.c_str(), hidden.words.c_str());
  std::fflush(stdout);
}

Record Measure(const test::SmallMachine& small, const Machine& machine,
               const test::HiddenPhysics& hidden, std::uint64_t seed) {
  const auto ticks =
      static_cast<Eigen::Index>(small.duration * machine.rates().control + 0.5);
  test::OwnComputer computer(machine.setup(),
                             small.controller(CaseDice("motion", seed)), ticks, seed);
  const int steps = std::max(32, 10 * machine.rates().substeps);
  test::RunOwn(machine, hidden, computer, {ticks, steps, small.start});
  return computer.ToRecord();
}

void Write(const Options& options, const test::SmallMachine& small,
           const HiddenCase& hidden) {
  const std::string folder = options.out + "/" + hidden.name;
  MakeOutputFolder(folder);
  WriteTextFile(folder + "/plant.xml", small.plant);
  WriteTextFile(folder + "/setup.toml", small.setup);
  const Machine machine(ReadSetup(folder));
  const auto draw = [&] {
    CaseDice dice(hidden.name, options.seed);
    return hidden.draw(machine, dice);
  };
  test::WriteCase(folder, {hidden, options.seed, draw().truth}, machine,
                  Measure(small, machine, draw().physics, 2 * options.seed),
                  Measure(small, machine, draw().physics, 2 * options.seed + 1));
  std::printf("%s: %s\n", hidden.name.c_str(), hidden.words.c_str());
  std::fflush(stdout);
}

void Main(const std::vector<std::string>& words) {
  const Options options = Parse(words);
  const auto write = [&](const std::vector<HiddenCase>& cases, bool may_be_off) {
    for (const HiddenCase& hidden : cases) {
      if (options.name.empty() || options.name == hidden.name) {
        Write(options, hidden, may_be_off);
      }
    }
  };
  write(test::BonderCatalogueCases(), true);
  write(test::BonderInventedCases(), false);
  for (const test::SmallMachine& small : test::SmallMachines()) {
    for (const HiddenCase& hidden : small.cases) {
      if (options.name.empty() || options.name == hidden.name) {
        Write(options, small, hidden);
      }
    }
  }
}

}  // namespace
}  // namespace mjdiag

int main(int argc, char** argv) {
  try {
    mjdiag::Main({argv + 1, argv + argc});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
