#include "mjdiag/plugin/replay/coarser_run.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Whether a cubic through readings that are some ticks apart tells those between them.
bool ShowsMotion(const MeasuredRun& run, const VectorXd& reading_sd, int ticks) {
  constexpr double kTenth = 0.1;
  // Lagrange's cubic, next to the middle.
  const Index half = ticks / 2;
  const double x = static_cast<double>(half) / ticks;
  const double weights[] = {
      -x * (x - 1.0) * (x - 2.0) / 6.0, (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
      (x + 1.0) * x * (x - 2.0) / 2.0, (x + 1.0) * x * (x - 1.0) / 6.0};
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    double wrong = 0.0, changes = 0.0;
    Index count = 0;
    for (std::size_t r = 0; r < run.records.size(); ++r) {
      const Index first = run.records[r].sample;
      const VectorXd y = run.outputs.row(i).segment(first, run.SamplesOf(r));
      const SampleMask counts = run.CountedOf(i, first, y.size());
      for (Index k = ticks; k + 2 * ticks < y.size(); k += ticks) {
        if (!counts.segment(k - ticks, 3 * ticks + 1).all()) continue;
        const double told = weights[0] * y[k - ticks] + weights[1] * y[k] -
                            weights[2] * y[k + ticks] + weights[3] * y[k + 2 * ticks];
        // Not squared: a logger's time stamps are off by much now and then.
        wrong += std::abs(y[k + half] - told);
        changes += std::abs(y[k + ticks] - y[k]);
        ++count;
      }
    }
    if (count == 0) return false;
    // Of a reading in the middle and of two beside it, which count a half each, and more.
    const double noise = 1.5 * static_cast<double>(count) * reading_sd[i];
    if (wrong > kTenth * changes + noise) return false;
  }
  return true;
}

/// Of a record of so many.
Index CoarseSamples(Index samples, int ticks) {
  return std::max<Index>(1, samples / ticks);
}

}  // namespace

Machine InTicksOf(const Machine& machine, int ticks) {
  Setup setup = machine.setup();
  setup.rates.control /= ticks;
  setup.rates.substeps *= ticks;
  setup.compare.skip_samples /= ticks;
  return machine.WithSetup(std::move(setup));
}

MeasuredRun Coarser(const MeasuredRun& run, int ticks) {
  if (ticks == 1) return run;
  Index samples = 0;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    samples += CoarseSamples(run.SamplesOf(r), ticks);
  }
  MeasuredRun coarse;
  coarse.sample_time = run.sample_time * ticks;
  coarse.finer_inputs.resize(run.inputs.rows(), samples * ticks);
  coarse.records = run.records;
  std::vector<Index> kept;
  if (run.driven.size() > 0) coarse.driven.setConstant(samples, true);
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index first = run.records[r].sample;
    const Index last = first + run.SamplesOf(r) - 1;
    RecordStart& record = coarse.records[r];
    record.sample = std::ssize(kept);
    record.ticks_before /= ticks;
    if (record.machine) {
      record.machine =
          std::make_shared<const Machine>(InTicksOf(*record.machine, ticks));
    }
    for (Index k = 0; k < CoarseSamples(run.SamplesOf(r), ticks); ++k) {
      const Index sample = std::ssize(kept);
      kept.push_back(first + k * ticks);
      for (Index i = 0; i < ticks; ++i) {
        const Index from = std::min(last, kept.back() + i);
        coarse.finer_inputs.col(sample * ticks + i) = run.inputs.col(from);
        if (run.driven.size() > 0 && !run.driven[from]) coarse.driven[sample] = false;
      }
    }
  }
  coarse.outputs = run.outputs(Eigen::all, kept);
  if (run.on.size() > 0) coarse.on = run.on(Eigen::all, kept);
  if (run.measured.size() > 0) coarse.measured = run.measured(Eigen::all, kept);
  if (run.counted.size() > 0) coarse.counted = run.counted(Eigen::all, kept);
  coarse.inputs.resize(run.inputs.rows(), samples);
  for (Index k = 0; k < samples; ++k) {
    coarse.inputs.col(k) =
        coarse.finer_inputs.middleCols(k * ticks, ticks).rowwise().mean();
  }
  return coarse;
}

int TicksThatShowMotion(const MeasuredRun& run, const VectorXd& reading_sd,
                        Index samples) {
  if (run.on.size() > 0 || run.ticks() > 1) return 1;
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    if (run.PeriodOf(i) > 1) return 1;
  }
  for (auto ticks = static_cast<int>(run.samples() / std::max<Index>(1, samples));
       ticks > 1; --ticks) {
    if (ShowsMotion(run, reading_sd, ticks)) return ticks;
  }
  return 1;
}

}  // namespace mjdiag
