// Writes the cases that a search for causes in the wire bonder is judged by
// (tests/support/hidden_cases): bonder_cases [--case NAME] [--seed N] --out DIR
//
// Each is a folder with a setup, record.csv, unseen.csv and truth.json, once with the plant
// as it is and, as NAME_off, once with three numbers of the given plant 1, 8 and 5 % off.
// scripts/bonder-cases asks for causes and judges the answers.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/hidden_cases/bonder_motion.h"
#include "support/hidden_cases/bonder_run.h"
#include "support/hidden_cases/case_files.h"

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

/// A mass, a damper and a spring of which the given plant does not know enough, away from
/// what is hidden: of one axis in one half of the cases, of the other in the rest.
NamedFactors Off(const std::string& name) {
  if (CaseDice(name, 0).Sign() > 0.0) {
    return {{"mass@x_stage", 0.99}, {"damping@X", 1.08}, {"stiffness@r1", 0.95}};
  }
  return {{"mass@y_stage", 1.01}, {"damping@Y", 0.92}, {"stiffness@u1", 1.05}};
}

void Write(const Options& options, const HiddenCase& hidden) {
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
  for (const bool off : {false, true}) {
    const std::string name = hidden.name + (off ? "_off" : "");
    WriteCase(options.out + "/" + name,
              {hidden, name, options.seed, machine.setup().folder,
               off ? Off(hidden.name) : NamedFactors{}},
              machine, truth, record, unseen);
  }
  std::printf("%s: %s\n", hidden.name.c_str(), hidden.words.c_str());
  std::fflush(stdout);
}

void Main(const std::vector<std::string>& words) {
  const Options options = Parse(words);
  for (const HiddenCase& hidden : test::BonderCatalogueCases()) {
    if (options.name.empty() || options.name == hidden.name) Write(options, hidden);
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
