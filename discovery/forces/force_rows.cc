#include "mjdiag/discovery/forces/force_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ForceRows RowsAlong(const FilteredRun& filtered, std::vector<Index> dofs, Index train) {
  ForceRows rows;
  rows.dofs = std::move(dofs);
  const MeasuredRun& run = filtered.run;
  const Index step = rows.step = std::max<Index>(
      1, static_cast<Index>(std::lround(0.5 / (filtered.bandwidth * run.sample_time))));
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    bool follows = false;
    for (Index k = first + step / 2; k < first + run.SamplesOf(i); k += step) {
      if (!filtered.counts[k]) {
        follows = false;
        continue;
      }
      if (rows.train == 0 && k >= train) {
        rows.train = rows.values();
        follows = false;
      }
      rows.samples.push_back(k);
      rows.begins.push_back(!follows);
      follows = true;
    }
  }
  if (train >= run.samples()) rows.train = rows.values();
  return rows;
}

void Silence(const JointMask& sticks, ForceRows& rows) {
  constexpr Index kLeast = 20;  // values of a joint
  if (!sticks.any()) return;
  if (rows.silent.empty()) {
    rows.silent.assign(static_cast<std::size_t>(rows.rows()), false);
  }
  for (Index j = 0; j < std::ssize(rows.dofs); ++j) {
    const auto dof = rows.dofs[static_cast<std::size_t>(j)];
    std::vector<Index> more;
    Index left = 0;
    for (Index k = 0; k < rows.values(); ++k) {
      const Index row = j * rows.values() + k;
      if (rows.IsSilent(row)) continue;
      // A filter's value is that of the samples around it.
      const Index at = rows.samples[static_cast<std::size_t>(k)];
      const Index first = std::max<Index>(0, at - rows.step);
      const Index count = std::min(sticks.cols() - first, 2 * rows.step + 1);
      if (sticks.row(dof).segment(first, count).any()) {
        more.push_back(row);
      } else if (k < rows.train) {
        ++left;
      }
    }
    if (left < kLeast) continue;
    for (const Index row : more) rows.silent[static_cast<std::size_t>(row)] = true;
  }
}

VectorXd RowsOf(const ForceRows& rows, const MatrixXd& forces) {
  VectorXd all(rows.rows());
  Index next = 0;
  for (const Index dof : rows.dofs) {
    for (const Index k : rows.samples) all[next++] = forces(dof, k);
  }
  return all;
}

ForceNoise NoiseOf(const ForceRows& rows, const VectorXd& left,
                   const std::vector<bool>& seen) {
  // A force that lasts is an offset; one that alternates is noise of the readings, twice
  // differentiated.
  constexpr double kLongest = 0.98;
  constexpr double kShortest = -0.9;
  const auto joints = static_cast<Index>(rows.dofs.size());
  ForceNoise noise{VectorXd::Zero(joints), VectorXd::Zero(joints)};
  for (Index j = 0; j < joints; ++j) {
    const auto r = left.segment(j * rows.values(), rows.values());
    double both = 0.0;
    double before = 0.0;
    for (Index k = 1; k < r.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!seen[at] || rows.IsSilent(j * rows.values() + k) || rows.Begins(j, k))
        continue;
      both += r[k] * r[k - 1];
      before += r[k - 1] * r[k - 1];
    }
    const double phi =
        before > 0.0 ? std::clamp(both / before, kShortest, kLongest) : 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (Index k = 0; k < r.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!seen[at] || rows.IsSilent(j * rows.values() + k)) continue;
      const double e =
          rows.Begins(j, k) ? r[k] * std::sqrt(1.0 - phi * phi) : r[k] - phi * r[k - 1];
      squares += e * e;
      count += 1.0;
    }
    noise.phi[j] = phi;
    noise.sd[j] = std::max(std::sqrt(squares / std::max(count, 1.0)), 1e-12);
  }
  return noise;
}

ForceNoise WithoutMemory(ForceNoise noise) {
  noise.sd.array() /= (1.0 - noise.phi.array().square()).sqrt();
  noise.phi.setZero();
  return noise;
}

MatrixXd Whitened(const ForceRows& rows, const ForceNoise& noise,
                  const MatrixXd& columns) {
  MatrixXd white(columns.rows(), columns.cols());
  for (Index j = 0; j < noise.phi.size(); ++j) {
    const double phi = noise.phi[j];
    for (Index k = 0; k < rows.values(); ++k) {
      const Index row = j * rows.values() + k;
      if (rows.IsSilent(row)) {
        white.row(row).setZero();
      } else if (rows.Begins(j, k)) {
        white.row(row) = columns.row(row) * (std::sqrt(1.0 - phi * phi) / noise.sd[j]);
      } else {
        white.row(row) = (columns.row(row) - phi * columns.row(row - 1)) / noise.sd[j];
      }
    }
  }
  return white;
}

double DevianceOf(const ForceRows& rows, const ForceNoise& noise,
                  const std::vector<bool>& seen) {
  double deviance = 0.0;
  for (Index j = 0; j < noise.sd.size(); ++j) {
    double count = 0.0;
    for (Index k = 0; k < rows.values(); ++k) {
      if (seen[static_cast<std::size_t>(k)] && !rows.IsSilent(j * rows.values() + k)) {
        count += 1.0;
      }
    }
    deviance += count * (2.0 * std::log(noise.sd[j]) + 1.0);
  }
  return deviance;
}

}  // namespace mjdiag
