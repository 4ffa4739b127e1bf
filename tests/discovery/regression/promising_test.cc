#include "mjdiag/discovery/regression/promising.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "mjdiag/discovery/fit/exact_columns.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/member_of.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// Curves over the velocity do what a brake does in several shapes each: where these took the
// room, the damper that was hidden was not asked for.
TEST(PromisingVariations, InThePlaceOfAMemberAreOneOfEveryBlock) {
  const test::Stage stage(500.0);
  const MeasuredRun run = ToMeasuredRun(
      stage.setup(), stage.Measure({"viscous_friction@load:coefficient=60"}));
  std::vector<Block> blocks =
      BlocksOf(stage.machine, ListCandidates(stage.machine), {});
  const Model model{
      test::MemberOf(blocks, "eddy_current_brake@load", Eigen::Vector2d(70.0, 0.2))};
  const MachineWith machine_with = [&](const Model& of) {
    return stage.machine.With(ChangesOfModel(blocks, of));
  };
  const Machine machine = machine_with(model);
  const FilterPath path =
      FilterLikeliest(machine, run, Eigen::VectorXd::Constant(1, 1e-8));
  const Whitening map(path, KeepGains(path));
  const Term term =
      ExactColumnsOf(machine_with, machine, run, path, blocks, model).terms.front();
  std::vector<const Column*> columns;
  for (const Column& column : term.columns) columns.push_back(&column);
  std::vector<Index> all(columns.size());
  std::iota(all.begin(), all.end(), Index{0});
  // Beside a model that leaves nothing nothing promises anything.
  const WhitenedModel itself{Eigen::VectorXd::Zero(map.rows()), all, {}};
  const WhitenedModel without{map.left() - map.Of({&term.removed}).col(0), {}, all};
  const BlockMotion along{MotionAlong(machine, run, path), path.noise.reading,
                          run.Time().maxCoeff(), path.dofs};
  const auto kept = PromisingVariations(
      machine, along, {{map, map.Of(columns), term.sd, {itself, without}, 0.0}}, blocks,
      [](const Block&) { return true; });
  std::multiset<std::string> in_place;
  for (const Variation& one : kept) in_place.insert(blocks[one.block].name);
  EXPECT_GT(in_place.size(), 3);
  for (const std::string& name : in_place) EXPECT_EQ(in_place.count(name), 1) << name;
}

}  // namespace
}  // namespace mjdiag
