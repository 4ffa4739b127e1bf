#include "mjdiag/report/discovery_plots.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// How far a channel is above its floor; free of noise comes first.
double OverFloor(const ChannelMismatch& channel) {
  if (channel.rms == 0.0) return 0.0;
  return channel.rms / channel.noise_floor.rms;
}

std::vector<const ChannelMismatch*> WorstChannels(const Comparison& comparison,
                                                  std::size_t most) {
  std::vector<const ChannelMismatch*> channels;
  for (const ChannelMismatch& channel : comparison.channels) {
    channels.push_back(&channel);
  }
  std::stable_sort(channels.begin(), channels.end(),
                   [](const ChannelMismatch* a, const ChannelMismatch* b) {
                     return OverFloor(*a) > OverFloor(*b);
                   });
  channels.resize(std::min(most, channels.size()));
  return channels;
}

VectorXd Mismatch(const Comparison& comparison, const std::string& channel) {
  VectorXd mismatch = comparison.measured.At(channel).samples -
                      comparison.simulated.At(channel).samples;
  mismatch.head(std::min<Index>(comparison.options.skip_samples, mismatch.size()))
      .setConstant(kNothing);
  return mismatch;
}

TimePlot MismatchPlot(const Comparison& before, const Comparison* after,
                      const ChannelMismatch& channel, double fitted_share) {
  const Record& record = before.measured;
  TimePlot plot;
  plot.caption = channel.name + ", measured - simulated";
  plot.quantity = channel.name;
  plot.unit = channel.unit;
  plot.start_time = record.start_time();
  plot.sample_time = record.sample_time();
  plot.curves = {
      {"plant as given", CurveRole::kMismatch, Mismatch(before, channel.name)}};
  if (after != nullptr && after->simulated.Find(channel.name) != nullptr) {
    plot.curves.push_back(
        {"extended plant", CurveRole::kSimulated, Mismatch(*after, channel.name)});
  }
  const double floor = channel.noise_floor.rms;
  plot.levels = {{floor, "noise floor (rms)"}, {-floor, "noise floor (rms)"}};
  if (fitted_share > 0.0 && fitted_share < 1.0) {
    const double end = record.start_time() + record.duration();
    plot.bands = {{end - (1.0 - fitted_share) * record.duration(), end, "not fitted"}};
  }
  return plot;
}

/// Levels do not widen the axis; where all of the signal lies within, curves do.
void AddLimitLevels(TimePlot& plot, double limit, const std::string& name) {
  const std::string label = name + FormatQuantity(limit, plot.unit);
  const VectorXd& value = plot.curves.front().values;
  const bool beyond = (value.array().abs() > limit).any();
  if (beyond) {
    plot.levels = {{limit, label}, {-limit, label}};
    return;
  }
  const VectorXd level = VectorXd::Constant(value.size(), limit);
  plot.curves.push_back({label, CurveRole::kNoise, level});
  plot.curves.push_back(
      {"-" + FormatQuantity(limit, plot.unit), CurveRole::kNoise, -level});
}

TimePlot UnexplainedPlot(const DisturbanceEstimate& force, const std::string& plant,
                         double start_time, double sample_time) {
  TimePlot plot;
  plot.caption = "Unexplained at " + force.joint + ", " + plant;
  plot.quantity = force.joint;
  plot.unit = force.unit;
  plot.start_time = start_time;
  plot.sample_time = sample_time;
  plot.curves = {{"unexplained", CurveRole::kMismatch, force.value}};
  AddLimitLevels(plot, 2.0 * force.sd, "±2 sd of its error: ");
  plot.height = 180;
  return plot;
}

/// Every n-th value, so that a page stays light: no eye tells more dots than that.
VectorXd Thinned(const VectorXd& values) {
  constexpr Index kMostPoints = 5000;
  const Index step =
      std::max<Index>(1, (values.size() + kMostPoints - 1) / kMostPoints);
  const Index count = (values.size() + step - 1) / step;
  return VectorXd::NullaryExpr(count, [&](Index i) { return values[i * step]; });
}

std::string Title(const LawPlot& law) {
  const bool has_site = law.site.empty() || law.cause.find('@') != std::string::npos;
  return law.cause + (has_site ? "" : " at " + law.site);
}

}  // namespace

std::vector<TimePlot> MismatchPlots(const Comparison& before, const Comparison* after,
                                    double fitted_share, std::size_t most) {
  std::vector<TimePlot> plots;
  for (const ChannelMismatch* channel : WorstChannels(before, most)) {
    plots.push_back(MismatchPlot(before, after, *channel, fitted_share));
  }
  return plots;
}

std::vector<TimePlot> UnexplainedPlots(const Discovery& discovery) {
  const RecordReplay* first = discovery.Fitted();
  const double start = first != nullptr ? first->before.measured.start_time() : 0.0;
  std::vector<TimePlot> plots;
  for (const DisturbanceEstimate& before : discovery.forces_before) {
    plots.push_back(
        UnexplainedPlot(before, "plant as given", start, discovery.sample_time));
    for (const DisturbanceEstimate& after : discovery.forces_after) {
      if (after.joint != before.joint || !HasFound(discovery)) continue;
      plots.push_back(
          UnexplainedPlot(after, "extended plant", start, discovery.sample_time));
    }
  }
  return plots;
}

XyPlot PlotOf(const LawPlot& law) {
  XyPlot plot;
  plot.caption = Title(law) + ", over " + law.x_name;
  plot.x_quantity = law.x_name;
  plot.x_unit = law.x_unit;
  plot.y_quantity = "unexplained";
  plot.y_unit = law.y_unit;
  plot.points = {
      {"without this cause", CurveRole::kMeasured, Thinned(law.x), Thinned(law.y)}};
  plot.curves = {{"found law", CurveRole::kSimulated, law.law_x, law.law_y}};
  return plot;
}

XyPlot ResidualDependencePlot(const ResidualDependence& signature,
                              const std::string& unit) {
  XyPlot plot;
  plot.caption = "What is left at " + signature.site + ", over " + signature.variable;
  plot.x_quantity = signature.variable;
  plot.x_unit = signature.unit;
  plot.y_quantity = "left";
  plot.y_unit = unit;
  plot.curves = {{"what is left", CurveRole::kSimulated, signature.x, signature.y}};
  if (signature.y_sd.size() == signature.y.size()) {
    plot.curves.push_back(
        {"+2 sd", CurveRole::kNoise, signature.x, signature.y + 2.0 * signature.y_sd});
    plot.curves.push_back(
        {"-2 sd", CurveRole::kNoise, signature.x, signature.y - 2.0 * signature.y_sd});
  }
  return plot;
}

}  // namespace mjdiag
