#include "mjdiag/discovery/discovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

DiscoverOptions CausesOnly() {
  DiscoverOptions options;
  options.figures = false;
  return options;
}

std::string Named(const Discovery& discovery) {
  std::string names;
  for (const FoundCause& found : discovery.causes) {
    names += (names.empty() ? "" : ", ") + found.cause.name() + "@" + found.cause.site;
  }
  return names;
}

const CauseParameter& Parameter(const Discovery& discovery, const std::string& name) {
  for (const CauseParameter& parameter : discovery.causes.at(0).parameters) {
    if (parameter.name == name) return parameter;
  }
  throw std::out_of_range(name);
}

/// What the mass of the machine is of what its model says.
constexpr double kLight = 0.99;

Record MeasureLight(const test::Stage& stage, const std::vector<std::string>& effects) {
  const Machine light = stage.machine.WithNumbers(
      {{FindModelParameter(stage.machine.plant(), "mass@load"), kLight}});
  return Simulate(light.With(test::With(effects)), stage.Motion(), {});
}

TEST(Discovery, SaysNothingOfNoise) {
  const test::Stage stage;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Discovery answer =
        Discover(stage.machine, stage.Measure({}, {}, seed), nullptr, CausesOnly());
    EXPECT_EQ(answer.verdict, DiscoveryVerdict::kNoDiscrepancy);
    EXPECT_EQ(Named(answer), "");
    EXPECT_TRUE(answer.kinds.empty());
  }
}

TEST(Discovery, NamesDryFrictionAndItsForce) {
  const test::Stage stage;
  const Discovery answer =
      Discover(stage.machine, stage.Measure({"coulomb_friction@load:force=18"}),
               nullptr, CausesOnly());
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kExplained);
  EXPECT_EQ(Named(answer), "coulomb_friction@load");
  // Four standard deviations: 6e-5 of the draws are further off.
  const CauseParameter& force = Parameter(answer, "force");
  EXPECT_NEAR(force.value, 18.0, 4.0 * force.sd);
  EXPECT_EQ(force.unit, "N");
  // The kind before the law: the unseen part of the record is lost without it.
  ASSERT_EQ(answer.kinds.size(), 1u);
  EXPECT_EQ(answer.kinds[0].kind, Kind::kDryFriction);
  EXPECT_EQ(answer.kinds[0].site, "load");
  EXPECT_GT(answer.kinds[0].probability, 0.99);
  EXPECT_GT(answer.kinds[0].share, 0.9);
}

// Three short records, of which no fit sees the ends.
TEST(Discovery, FindsOneCauseInSeveralRecords) {
  const test::Stage stage;
  Measurements measurements;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const std::string name = "run" + std::to_string(seed) + ".csv";
    measurements.fit.push_back(
        {stage.Measure({"coulomb_friction@load:force=18"}, {}, seed), stage.machine,
         name});
  }
  DiscoverOptions options;
  const Discovery answer = Discover(stage.machine, measurements, options);
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kExplained);
  EXPECT_EQ(Named(answer), "coulomb_friction@load");
  const CauseParameter& force = Parameter(answer, "force");
  EXPECT_NEAR(force.value, 18.0, 4.0 * force.sd);
  ASSERT_EQ(answer.records.size(), 3u);
  EXPECT_EQ(answer.Fitted()->name, "run1.csv");
  EXPECT_EQ(answer.Unseen(), nullptr);
  for (const RecordReplay& replay : answer.records) {
    EXPECT_LT(replay.after.channels.front().mae,
              0.02 * replay.before.channels.front().mae);
  }
  EXPECT_GT(answer.gain_validation, 0.98);
}

TEST(Discovery, NamesAChangedFaultParameterAsTheFault) {
  const test::Stage stage;
  const Discovery answer = Discover(stage.machine, stage.Measure({}, {{"zeta", 1.02}}),
                                    nullptr, CausesOnly());
  ASSERT_EQ(Named(answer), "zeta@load");
  EXPECT_TRUE(answer.causes[0].cause.effect->IsFault());
  // The same change of the model by another name is said to be one.
  ASSERT_FALSE(answer.causes[0].alternatives.empty());
  EXPECT_TRUE(answer.causes[0].alternatives[0].indistinguishable);
  EXPECT_EQ(answer.causes[0].alternatives[0].cause.name(), "viscous_friction");
}

// A drive that was limited in one record and is not in the other: the machine has no
// such limit.
TEST(Discovery, DoesNotNameWhatSpoilsTheValidationRecord) {
  const test::Stage stage;
  const Record measured = stage.Measure({"force_saturation@drive:limit=1.2"});
  const Discovery alone = Discover(stage.machine, measured, nullptr, CausesOnly());
  EXPECT_EQ(Named(alone), "force_saturation@drive");
  const Record validation = stage.Measure({}, {}, 2);
  const Discovery judged = Discover(stage.machine, measured, &validation, CausesOnly());
  EXPECT_EQ(Named(judged).find("force_saturation"), std::string::npos);
  EXPECT_TRUE(std::ranges::any_of(judged.notes, [](const std::string& note) {
    return note.find("outside the fit") != std::string::npos &&
           note.find("force_saturation@drive") != std::string::npos;
  }));
}

TEST(DiscoveryOfTwo, FindsTwoCausesAtOnce) {
  const test::Stage stage;
  const Discovery answer =
      Discover(stage.machine,
               stage.Measure({"coulomb_friction@load:force=18",
                              "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"}),
               nullptr, CausesOnly());
  EXPECT_EQ(answer.causes.size(), 2u) << Named(answer);
  for (const std::string name : {"coulomb_friction@load", "force_ripple@load"}) {
    EXPECT_NE(Named(answer).find(name), std::string::npos) << Named(answer);
  }
}

/// Median distance of the dots from the law.
double MedianMiss(const LawPlot& plot) {
  std::vector<double> misses;
  for (Eigen::Index i = 0; i < plot.x.size(); ++i) {
    const auto after = std::ranges::upper_bound(plot.law_x, plot.x[i]);
    const auto k =
        std::clamp<Eigen::Index>(after - plot.law_x.begin(), 1, plot.law_x.size() - 1);
    const double share =
        (plot.x[i] - plot.law_x[k - 1]) / (plot.law_x[k] - plot.law_x[k - 1]);
    const double law = std::lerp(plot.law_y[k - 1], plot.law_y[k], share);
    misses.push_back(std::abs(plot.y[i] - law));
  }
  std::ranges::nth_element(misses, misses.begin() + misses.size() / 2);
  return misses[misses.size() / 2];
}

// Of all that the plant as given lacks, the friction is twelve times the ripple.
TEST(DiscoveryOfTwo, DrawsTheLawOfOneCauseThroughWhatTheOtherLeaves) {
  constexpr double kRipple = 1.5;
  const test::Stage stage;
  const Discovery answer =
      Discover(stage.machine,
               stage.Measure({"coulomb_friction@load:force=18",
                              "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"}),
               nullptr, {});
  const auto ripple =
      std::ranges::find(answer.laws, "force_ripple@load", &LawPlot::cause);
  ASSERT_NE(ripple, answer.laws.end());
  EXPECT_NEAR(ripple->law_y.maxCoeff(), kRipple, 0.02 * kRipple);
  EXPECT_LT(MedianMiss(*ripple), 0.1 * kRipple);
}

TEST(Discovery, NamesRaisedEncoderNoise) {
  const test::Stage stage;
  const Discovery answer =
      Discover(stage.machine, stage.Measure({"encoder_noise@load_encoder:sd=1.5e-8"}),
               nullptr, CausesOnly());
  ASSERT_EQ(Named(answer), "encoder_noise@load_encoder");
  const CauseParameter& sd = Parameter(answer, "sd");
  EXPECT_NEAR(sd.value, 1.5e-8, 4.0 * sd.sd);
}

/// A measurement with a force that no entry of the catalogue makes, as a function of
/// the reference's position and velocity and of time. It goes in through the known
/// disturbance of the drive, of which the record then says nothing.
Record WithForce(const test::Stage& stage,
                 const std::function<double(double q, double v, double t)>& force) {
  Excitation motion = stage.Motion();
  const AxisReference& reference = motion.reference.axes[0];
  Channel hidden{"pulse", "V", Eigen::VectorXd(motion.samples())};
  for (Eigen::Index k = 0; k < motion.samples(); ++k) {
    hidden.samples[k] = force(reference.position[k], reference.velocity[k],
                              static_cast<double>(k) * stage.setup().rates.tick()) /
                        stage.machine.plant().actuator_gear[0];
  }
  motion.inputs = Record(stage.setup().rates.tick());
  motion.inputs.Add(hidden);
  const Record run = Simulate(stage.machine, motion, {});
  Record shown(run.sample_time());
  for (Channel channel : run.channels()) {
    if (channel.name == "pulse") continue;
    if (channel.name == "u") channel.samples -= hidden.samples;
    shown.Add(std::move(channel));
  }
  return shown;
}

// No curve is over two variables, and what comes nearest is no explanation.
TEST(DiscoveryOutsideTheList, ExplainsNoDampingThatNoListHolds) {
  const test::Stage stage;
  const Record record = WithForce(stage, [](double q, double v, double) {
    return -150.0 * std::sin(60.0 * q) * v;
  });
  DiscoverOptions options = CausesOnly();
  options.budget = 60.0;
  const Discovery answer = Discover(stage.machine, record, nullptr, options);
  EXPECT_TRUE(answer.verdict == DiscoveryVerdict::kPartlyExplained ||
              answer.verdict == DiscoveryVerdict::kUnexplained)
      << Named(answer);
}

TEST(DiscoveryOutsideTheList, DoesNotNameAForceThatComesAndGoesWithTime) {
  const test::Stage stage(2000.0);
  const Record record = WithForce(
      stage, [](double, double, double t) { return t > 1.2 && t < 1.9 ? 4.0 : 0.0; });
  const Discovery answer = Discover(stage.machine, record, nullptr, CausesOnly());
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kUnexplained) << Named(answer);
  ASSERT_TRUE(answer.unexplained.has_value());
  EXPECT_NE(answer.unexplained->text.find("time"), std::string::npos)
      << answer.unexplained->text;
}

// With a mass, a motor and a damper that are all in doubt only their ratios are known: one of
// the first two makes up for the other.
TEST(DiscoveryInDoubt, TakesAWrongMassAsANumberOfThePlantAndNotAsACause) {
  const test::Stage stage;
  DiscoverOptions options = CausesOnly();
  options.doubt = true;
  const Discovery answer =
      Discover(stage.machine, MeasureLight(stage, {}), nullptr, options);
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kExplained);
  EXPECT_EQ(Named(answer), "");
  double ratio = 1.0;
  for (const CalibratedNumber& number : answer.calibration) {
    EXPECT_TRUE(IsOff(number)) << number.name;
    if (number.name == "mass@load") ratio *= number.factor;
    if (number.name == "gear@drive") ratio /= number.factor;
  }
  EXPECT_NEAR(ratio, kLight, 1e-5);
}

TEST(DiscoveryInDoubt, SaysWhichNumberIsOffWhereTheOthersAreKnown) {
  const test::Stage stage(2000.0);
  DiscoverOptions options = CausesOnly();
  options.doubt = true;
  options.known = {"gear@drive", "damping"};
  const Discovery answer =
      Discover(stage.machine, MeasureLight(stage, {}), nullptr, options);
  EXPECT_EQ(Named(answer), "");
  ASSERT_EQ(answer.calibration.size(), 1u);
  EXPECT_TRUE(IsOff(answer.calibration[0]));
  EXPECT_LE(answer.calibration[0].low, kLight);
  EXPECT_GE(answer.calibration[0].high, kLight);
  options.known = {"mas"};
  EXPECT_THROW(Discover(stage.machine, MeasureLight(stage, {}), nullptr, options),
               InputError);
}

TEST(DiscoveryInDoubt, FindsDryFrictionBesideAWrongMass) {
  const test::Stage stage;
  DiscoverOptions options = CausesOnly();
  options.doubt = true;
  options.known = {"gear"};
  const Discovery answer =
      Discover(stage.machine, MeasureLight(stage, {"coulomb_friction@load:force=18"}),
               nullptr, options);
  EXPECT_EQ(Named(answer), "coulomb_friction@load");
  const CauseParameter& force = Parameter(answer, "force");
  EXPECT_NEAR(force.value, 18.0, 4.0 * force.sd);
  const CalibratedNumber& mass = answer.calibration.at(0);
  EXPECT_NEAR(mass.factor, kLight, 1e-4);
}

}  // namespace
}  // namespace mjdiag
