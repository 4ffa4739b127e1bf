// What one regression along the filtered motion says that a machine lacks, of any setup and
// records: lacks SETUP RECORD... [EFFECT@SITE:VALUES]...; SECONDS_OF_WORK in the environment is
// its time, and with NO_DOUBT numbers of the plant are known.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "mjdiag/plugin/setup/measured_file.h"

namespace mjdiag {
namespace {

/// Of the processor, which does not depend on what else runs.
double Now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

int Main(int argc, char** argv) {
  const std::string setup = argv[1];
  Machine machine(ReadSetup(setup));
  std::vector<MeasuredRun> runs;
  for (int i = 2; i < argc; ++i) {
    if (std::string(argv[i]).find('@') != std::string::npos) {
      machine = machine.With({{}, {ParseEffect(argv[i])}});
      continue;
    }
    runs.push_back(
        ToMeasuredRun(machine.setup(), ReadMeasured(machine.setup(), argv[i]).record));
  }
  const MeasuredRun run = Joined(runs);
  const double begin = Now();
  ExplainOptions options;
  if (const char* seconds = std::getenv("SECONDS_OF_WORK")) {
    options.seconds = std::atof(seconds);
  }
  if (std::getenv("NO_DOUBT")) options.numbers.emplace();
  options.progress = [&](const std::string& text) {
    std::printf("[%.1f s] %s\n", Now() - begin, text.c_str());
    std::fflush(stdout);
  };
  const Explained found =
      Explain(machine, run, SensorNoise(machine.channels(), run), options);
  std::printf("score %.1f from %.1f\n", found.score, found.nothing.deviance);
  const FilterPath& path = found.path;
  for (Eigen::Index j = 0; j < path.dof_count(); ++j) {
    std::printf("  dof %ld size %.3g (%.3g) memory %.3g white %.3g (%.3g)\n",
                static_cast<long>(path.dofs[static_cast<std::size_t>(j)]),
                path.noise.size[j], found.nothing.noise.size[j], path.noise.memory[j],
                path.noise.white[j], found.nothing.noise.white[j]);
  }
  for (const Member& member : found.fit.model) {
    std::printf("  %s\n", ModelText(found.blocks, {member}).c_str());
  }
  return 0;
}

}  // namespace
}  // namespace mjdiag

int main(int argc, char** argv) { return mjdiag::Main(argc, argv); }
