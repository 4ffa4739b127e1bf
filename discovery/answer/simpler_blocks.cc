#include "mjdiag/discovery/answer/simpler_blocks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

/// A law with all that it becomes.
std::vector<PlacedEffect> ChainOf(const PlacedEffect& law) {
  std::vector<PlacedEffect> chain{law};
  while (const auto next = chain.back().effect->Simpler(chain.back())) {
    chain.push_back(*next);
  }
  return chain;
}

/// Mean of the values of a law that have a role; 0 if it has none of it.
double SizeOf(const VectorXd& values, const Candidate& candidate, Role role) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    if (candidate.parameters[i].role != role) continue;
    sum += values[static_cast<Eigen::Index>(i)];
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

/// Of one of the same kind there, of a size and at most a speed within which it comes.
std::optional<VectorXd> SimpleValues(const Block& simple, const Candidate& own,
                                     const VectorXd& values) {
  if (simple.candidate->effect->kind() != own.effect->kind()) return std::nullopt;
  const std::vector<FitParameter>& parameters = simple.candidate->parameters;
  const double size = SizeOf(values, own, parameters.front().role);
  if (size == 0.0) return std::nullopt;
  if (parameters.size() == 1) return VectorXd::Constant(1, size);
  if (!simple.IsSmoothFriction()) return std::nullopt;
  const FitParameter& speed = parameters.back();
  return VectorXd{{size, std::sqrt(speed.lower * speed.upper)}};
}

}  // namespace

std::vector<Instead> SimplerThan(const Member& member, const std::vector<Block>& blocks,
                                 const mjModel& plant) {
  std::vector<Instead> instead;
  const std::optional<Candidate>& own = blocks[member.block].candidate;
  if (!own || own->effect->IsFault() || own->parameters.size() < 2) return instead;
  const std::vector<PlacedEffect> chain =
      ChainOf({own->effect, own->site, member.values});
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::optional<Candidate>& simple = blocks[b].candidate;
    if (blocks[b].number) {
      for (const PlacedEffect& law : chain) {
        const int element = FindElement(plant, law.effect->element(), law.site);
        if (law.effect->Number(plant, element) == blocks[b].number) {
          instead.push_back({b, VectorXd::Ones(1)});
          break;
        }
      }
    }
    if (!simple || simple->site != own->site ||
        simple->parameters.size() >= own->parameters.size()) {
      continue;
    }
    for (std::size_t i = 1; i < chain.size(); ++i) {
      if (chain[i].effect->name() == simple->effect->name()) {
        instead.push_back({b, chain[i].values});
      }
    }
    if (const auto values = SimpleValues(blocks[b], *own, member.values)) {
      instead.push_back({b, *values});
    }
  }
  return instead;
}

std::vector<Instead> SimplerResistances(const Member& member,
                                        const std::vector<Block>& blocks) {
  constexpr double kSmall = 0.01;  // of what is usual there
  std::vector<Instead> instead;
  const Block& own = blocks[member.block];
  if (own.resists.empty() || (own.candidate && own.IsSimplest())) return instead;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& other = blocks[b];
    const bool is_there = other.resists == own.resists && b != member.block;
    if (!is_there || !other.candidate || !other.IsSimplest()) continue;
    const FitParameter& size = other.candidate->parameters.front();
    const double little =
        size.role == Role::kFactor
            ? 1.0
            : size.nothing + std::max(kSmall * size.spread, 2.0 * size.least_size);
    instead.push_back({b, VectorXd::Constant(1, little)});
  }
  return instead;
}

}  // namespace mjdiag
