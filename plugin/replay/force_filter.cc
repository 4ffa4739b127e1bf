#include "mjdiag/plugin/replay/force_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/replay/force_kalman.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/replay/tangent_course.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

bool Counts(const MeasuredRun& run, Index sensor, Index sample) {
  return run.Counted().size() == 0 || run.Counted()(sensor, sample);
}

/// Of a state with the bodies of this machine's effects, which are known as their joints are.
VectorXd WithBodies(const VectorXd& sd, const TickMap& map) {
  VectorXd all(map.states());
  Index place = TangentSize(map.model());
  all.head(place) = sd.head(place);
  for (const ActiveEffects::BodyOf& body : map.bodies()) {
    all[place++] = sd[body.dof];
    all[place++] = sd[map.model().nv + body.dof];
  }
  return all;
}

/// One record into its columns of the path.
class RecordFilter {
 public:
  RecordFilter(const Machine& machine, const MeasuredRun& run, std::size_t record,
               FilterPath& path)
      : machine_(DuringRecord(run.records[record], machine)),
        run_(run),
        first_(run.records[record].sample),
        clock_begins_(run.TickOf(first_)),
        samples_(run.SamplesOf(record)),
        start_(path.starts[record]),
        path_(path),
        map_(machine_),
        course_(machine_, map_),
        inputs_(machine_, run),
        kalman_(path.dofs, path.noise, path.sample_time),
        applied_(VectorXd::Zero(machine.plant().nv)) {}

  void Run();
  std::vector<TickTangent> TakeTangents() { return std::move(course_.tangents); }
  double deviance() const { return deviance_; }

 private:
  /// Readings of the start of tick k, or of the end of the one before it.
  void Take(Index k, bool late);
  /// The innovation of a sensor that is expected to read that.
  void Innovate(Index sensor, Index k, double read) {
    const double expected = read + path_.speeds(sensor, k) * clock_;
    path_.innovations(sensor, k) =
        path_.counts(sensor, k) ? run_.outputs(sensor, k) - expected : 0.0;
  }
  const TickMap::Result& Tick(Index k);
  /// Place of the tangent of the last tick.
  std::size_t NextTangent(Index k) {
    const Index nf = path_.dof_count();
    const VectorXd sd = kalman_.P.diagonal().cwiseMax(0.0).cwiseSqrt();
    VectorXd force_sd = VectorXd::Zero(applied_.size());
    force_sd(path_.dofs) = sd.segment(sd.size() - nf - 1, nf);
    return course_.Next(state_, applied_, clock_begins_ + k, inputs_, sd, force_sd);
  }

  Machine machine_;  // during the record
  const MeasuredRun& run_;
  Index first_;
  Index clock_begins_;  // tick
  Index samples_;
  const FilterStart& start_;
  FilterPath& path_;
  TickMap map_;
  TangentCourse course_;
  RecordedInputs inputs_;
  ForceKalman kalman_;
  VectorXd applied_;  // nv
  PlantState state_;
  VectorXd latent_;  // nf
  double clock_ = 0.0;
  double deviance_ = 0.0;
};

void RecordFilter::Take(Index k, bool late) {
  kalman_.z.setZero();
  for (Index i = 0; i < map_.sensors(); ++i) {
    if (map_.ReadsAtEnd(i) != late || !path_.counts(i, k)) continue;
    deviance_ += kalman_.Take(i, late, path_.innovations(i, k), path_.speeds(i, k));
  }
}

const TickMap::Result& RecordFilter::Tick(Index k) {
  applied_(path_.dofs) = latent_;
  inputs_.StayAt(first_ + k);
  return map_.Run(state_, applied_, clock_begins_ + k, inputs_);
}

void RecordFilter::Run() {
  const mjModel& model = map_.model();
  const Index ns = map_.states();
  const Index nf = path_.dof_count();
  state_ = map_.Begun(start_.state);
  latent_ = VectorXd::Zero(nf);
  kalman_.Start(start_.sd);
  std::size_t tangent = 0;
  for (Index k = 0; k < samples_; ++k) {
    const Index at = first_ + k;
    if (k == 0) {
      Tick(0);
      tangent = NextTangent(0);
    }
    kalman_.MoveTo(course_.tangents[tangent]);
    const VectorXd read = map_.Read(state_, clock_begins_ + k);
    for (Index i = 0; i < map_.sensors(); ++i) {
      if (map_.ReadsAtEnd(i)) continue;
      Innovate(i, at, read[i]);
    }
    Take(at, false);
    path_.pulled.col(at) = kalman_.z;
    state_ = Moved(model, state_, kalman_.z);
    latent_ += kalman_.z.segment(ns, nf);
    clock_ += kalman_.z[ns + nf];

    const TickMap::Result& ticked = Tick(k);
    if (ticked.diverged) {
      throw NumericalError("replay: diverged at " +
                           std::to_string(static_cast<double>(k) * path_.sample_time) +
                           " s");
    }
    PlantState next = ticked.state;
    const VectorXd ended = ticked.reading;
    tangent = NextTangent(k);
    path_.of_tick[static_cast<std::size_t>(at)] = tangent;
    kalman_.MoveTo(course_.tangents[tangent]);
    if (k + 1 < samples_) {
      for (Index i = 0; i < map_.sensors(); ++i) {
        if (!map_.ReadsAtEnd(i)) continue;
        Innovate(i, at + 1, ended[i]);
      }
      Take(at + 1, true);
    } else {
      kalman_.z.setZero();
    }
    path_.pulled_late.col(at) = kalman_.z;
    latent_ += kalman_.z.segment(ns, nf);
    clock_ += kalman_.z[ns + nf];
    path_.states[static_cast<std::size_t>(at)] = Moved(model, state_, kalman_.z);
    path_.forces.col(at) = latent_;
    path_.clock[at] = clock_;
    // What the readings of the end say of the state goes through the tick to first order.
    kalman_.Advance();
    state_ = Moved(model, next, kalman_.z.head(ns));
    latent_ = latent_.cwiseProduct(kalman_.rho().head(nf));
    clock_ *= kalman_.rho()[nf];
  }
}

/// Rates of readings by central differences over 20 ms.
MatrixXd SpeedsOf(const MeasuredRun& run) {
  constexpr double kSide = 0.01;  // [s]
  const auto side =
      std::max<Index>(1, static_cast<Index>(std::lround(kSide / run.sample_time)));
  MatrixXd speeds(run.outputs.rows(), run.samples());
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index begin = run.records[r].sample;
    const Index end = begin + run.SamplesOf(r);
    for (Index k = begin; k < end; ++k) {
      const Index a = std::max(begin, k - side);
      const Index b = std::min(end - 1, k + side);
      speeds.col(k) =
          (run.outputs.col(b) - run.outputs.col(a)) /
          (run.sample_time * static_cast<double>(std::max<Index>(1, b - a)));
    }
  }
  return speeds;
}

}  // namespace

FilterPath RunForceFilter(const Machine& machine, const MeasuredRun& run,
                          const std::vector<Index>& dofs,
                          const std::vector<FilterStart>& starts,
                          const FilterNoise& noise) {
  FilterPath path;
  path.sample_time = run.sample_time;
  path.dofs = dofs;
  path.starts = starts;
  path.noise = noise;
  const Index ny = run.outputs.rows();
  const Index samples = run.samples();
  const auto nf = static_cast<Index>(dofs.size());
  const TickMap map(machine);
  for (const ActiveEffects::BodyOf& body : map.bodies()) {
    path.bodies.emplace_back(body.effect, body.number);
  }
  for (FilterStart& start : path.starts) start.sd = WithBodies(start.sd, map);
  const Index n = map.states() + nf + 1;
  path.of_tick.resize(static_cast<std::size_t>(samples));
  path.states.resize(static_cast<std::size_t>(samples));
  path.forces.resize(nf, samples);
  path.clock.resize(samples);
  path.innovations = MatrixXd::Zero(ny, samples);
  path.speeds = SpeedsOf(run);
  path.pulled.resize(n, samples);
  path.pulled_late.resize(n, samples);
  path.counts.resize(ny, samples);
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < ny; ++i) path.counts(i, k) = Counts(run, i, k);
  }
  const std::size_t records = run.records.size();
  std::vector<double> deviances(records);
  std::vector<std::vector<TickTangent>> tangents(records);
  ParallelFor(static_cast<int>(records), [&](int number) {
    const auto r = static_cast<std::size_t>(number);
    RecordFilter filter(machine, run, r, path);
    filter.Run();
    deviances[r] = filter.deviance();
    tangents[r] = filter.TakeTangents();
  });
  for (std::size_t r = 0; r < records; ++r) {
    const Index first = run.records[r].sample;
    path.first.push_back(first);
    for (Index k = first; k < first + run.SamplesOf(r); ++k) {
      path.of_tick[static_cast<std::size_t>(k)] += path.tangents.size();
    }
    std::ranges::move(tangents[r], std::back_inserter(path.tangents));
    path.deviance += deviances[r];
  }
  for (const SensorSetup& sensor : machine.channels().sensors) {
    path.late.push_back(StageOf(machine.plant(), sensor) == mjSTAGE_ACC);
  }
  return path;
}

}  // namespace mjdiag
