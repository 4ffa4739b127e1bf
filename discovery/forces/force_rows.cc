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
  const auto step = std::max<Index>(
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
      if (!seen[at] || rows.begins[at]) continue;
      both += r[k] * r[k - 1];
      before += r[k - 1] * r[k - 1];
    }
    const double phi =
        before > 0.0 ? std::clamp(both / before, kShortest, kLongest) : 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (Index k = 0; k < r.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!seen[at]) continue;
      const double e =
          rows.begins[at] ? r[k] * std::sqrt(1.0 - phi * phi) : r[k] - phi * r[k - 1];
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
      if (rows.begins[static_cast<std::size_t>(k)]) {
        white.row(row) = columns.row(row) * (std::sqrt(1.0 - phi * phi) / noise.sd[j]);
      } else {
        white.row(row) = (columns.row(row) - phi * columns.row(row - 1)) / noise.sd[j];
      }
    }
  }
  return white;
}

double DevianceOf(const ForceNoise& noise, const std::vector<bool>& seen) {
  const auto count = static_cast<double>(std::ranges::count(seen, true));
  return count * (2.0 * noise.sd.array().log() + 1.0).sum();
}

}  // namespace mjdiag
