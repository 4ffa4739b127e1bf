// What one regression along the filtered motion says that a machine lacks, of any setup and
// records: lacks SETUP RECORD...

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/regression/set_choice.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/setup/measured_file.h"

namespace mjdiag {
namespace {

double Now() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

int Main(int argc, char** argv) {
  const std::string setup = argv[1];
  const Machine machine(ReadSetup(setup));
  std::vector<MeasuredRun> runs;
  for (int i = 2; i < argc; ++i) {
    runs.push_back(
        ToMeasuredRun(machine.setup(), ReadMeasured(machine.setup(), argv[i]).record));
  }
  const MeasuredRun run = Joined(runs);
  const double begin = Now();
  const FilterPath path =
      FilterLikeliest(machine, run, SensorNoise(machine.channels(), run, {}));
  const double filtered = Now();
  std::printf("filter %.1f s, -2 ln L %.1f, %ld samples\n", filtered - begin,
              path.deviance, static_cast<long>(path.samples()));
  for (Eigen::Index j = 0; j < path.dof_count(); ++j) {
    std::printf("  dof %ld size %.3g memory %.3g white %.3g\n",
                static_cast<long>(path.dofs[static_cast<std::size_t>(j)]),
                path.noise.size[j], path.noise.memory[j], path.noise.white[j]);
  }
  std::vector<Candidate> candidates = ListCandidates(machine);
  BoundByRecord(candidates, machine, MotionAlong(machine, run, path));
  ChoiceOptions options;
  options.progress = [&](const std::string& text) {
    std::printf("[%.1f s] %s\n", Now() - filtered, text.c_str());
    std::fflush(stdout);
  };
  const ChosenSet chosen = ChooseSet(machine, run, path, candidates, options);
  std::printf("score %.1f from %.1f\n", chosen.score, chosen.score_of_nothing);
  for (const ChosenMember& member : chosen.members) {
    const TrialValues values = member.variation.values(member.amplitudes);
    std::printf("  %-40s loss %9.1f  ",
                chosen.blocks[member.variation.block].name.c_str(), member.loss);
    for (Eigen::Index i = 0; values && i < values->size(); ++i) {
      std::printf(" %.6g", (*values)[i]);
    }
    std::printf("   a/sd");
    for (Eigen::Index i = 0; i < member.sd.size(); ++i) {
      std::printf(" %.1f", member.amplitudes[i] / member.sd[i]);
    }
    std::printf("\n");
  }
  return 0;
}

}  // namespace
}  // namespace mjdiag

int main(int argc, char** argv) { return mjdiag::Main(argc, argv); }
