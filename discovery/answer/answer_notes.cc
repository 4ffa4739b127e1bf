#include "mjdiag/discovery/answer/answer_notes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/answer/discriminating_experiment.h"
#include "mjdiag/discovery/answer/raised_noise.h"
#include "mjdiag/discovery/checks/data_check.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/site.h"
#include "mjdiag/plugin/plant/fixed_numbers.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

void NoteQuiet(const AnswerData& data, const VectorXd& reading_noise,
               std::vector<std::string>& notes) {
  constexpr double kMoving = 50.0;  // times the sensor noise
  const MechanicalModel& linear = data.machine.mechanics();
  const std::vector<Index> seen = SeenJoints(linear);
  for (std::size_t y = 0; y < seen.size(); ++y) {
    const auto row = static_cast<Index>(y);
    const VectorXd read = data.run.seen.ReadingsOf(row);
    const double range = read.maxCoeff() - read.minCoeff();
    if (range >= kMoving * reading_noise[row]) continue;
    notes.push_back(
        NoteOfQuietAxis(data.machine.channels().sensors[y].channel,
                        linear.coordinates[static_cast<std::size_t>(seen[y])]));
  }
}

/// NoteOfExperiment; "" where one of the two makes a machine that diverges or cannot be.
std::string ExperimentText(const Machine& machine, const Cause& one,
                           const Cause& other) {
  try {
    return NoteOfExperiment(machine, one, other);
  } catch (const NumericalError&) {
    return "";
  } catch (const InputError&) {
    return "";
  }
}

void NoteAlternatives(const Machine& machine, const FoundCause& found,
                      const std::function<bool()>& may_go_on,
                      std::vector<std::string>& notes) {
  constexpr double kCompeting = 0.05;
  for (const Alternative& other : found.alternatives) {
    if (other.indistinguishable) {
      notes.push_back(CauseWithValues(found.cause) + " and " +
                      CauseWithValues(other.cause) +
                      " are the same change of the model: no measurement tells them "
                      "apart");
    } else if (other.probability >= kCompeting) {
      notes.push_back(
          "the record does not tell " + CauseWithValues(found.cause) + " from " +
          CauseWithValues(other.cause) +
          (may_go_on() ? ExperimentText(machine, found.cause, other.cause) : ""));
    }
  }
  for (const FoundCause::NumberInstead& other : found.numbers) {
    if (other.probability < kCompeting) continue;
    notes.push_back("the record does not tell " + CauseWithValues(found.cause) +
                    " from " + other.name +
                    " being another one than the plant says; measure it, "
                    "or say how well it is known (known." +
                    other.name + ")");
  }
}

void NoteFar(const CalibratedNumber& number, std::vector<std::string>& notes) {
  constexpr double kFarAway = 3.0;  // standard deviations of what is known beforehand
  const double far = std::abs(std::log(number.factor)) / number.doubt;
  if (!(number.doubt > 0.0) || far < kFarAway) return;
  notes.push_back(number.name + " is " + FormatNumber(number.factor, 3) +
                  " times what the plant says, " + FormatNumber(far, 2) +
                  " standard deviations of what was known of it; measure it, or say "
                  "how well it is known (known." +
                  number.name + ")");
}

}  // namespace

std::vector<std::string> NotesOfChecks(const mjModel& plant, const Measurements& split,
                                       bool doubt) {
  std::vector<std::string> notes;
  const auto check = [&](const std::vector<MeasuredRecord>& records,
                         const std::string& role) {
    for (const MeasuredRecord& one : records) {
      const bool named = split.Several() && !one.name.empty();
      const std::string of = named ? one.name + ": " : role;
      std::vector<std::string> of_record = one.notes;
      std::ranges::copy(CheckRecord(one.machine, one.record),
                        std::back_inserter(of_record));
      for (const std::string& note : of_record) notes.push_back(of + note);
    }
  };
  check(split.fit, "");
  check(split.unseen, "validation record: ");
  const std::string fixed = NoteOfFixedNumbers(plant);
  if (doubt && !fixed.empty()) notes.push_back(fixed);
  return notes;
}

std::string NoteOfBudget(const Budget& budget, const std::string& rest) {
  if (budget.stopped) return "it was stopped; left out: " + rest;
  constexpr double kMore = 5.0;  // times a budget that was too small
  // As it is given on a command line.
  const auto seconds = [](double value) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%g", value);
    return std::string(digits.data());
  };
  return "ended by its budget of " + seconds(budget.limit) + " s; left out: " + rest +
         "; --budget " + seconds(kMore * budget.limit) + " goes on";
}

std::string NoteOfQuietAxis(const std::string& channel, const std::string& joint) {
  return "'" + channel +
         "' does not move: friction, springs, ripple, mass and motor of joint '" +
         joint + "' cannot be judged; record a motion of it";
}

std::string NoteOfInputDelay(double delay, double step) {
  return "all inputs act " + FormatQuantity(delay, "s") +
         " later than in the simulation; it has physics steps of " +
         FormatQuantity(step, "s") +
         ", which are off by up to half of that; all figures of this answer, before "
         "and after, are of the machine without what its steps add (mjdiag compare is "
         "with it)";
}

std::string NoteOfExperiment(const Machine& machine, const Cause& one,
                             const Cause& other) {
  constexpr double kTold = 4.0;  // standard deviations
  const auto experiment =
      FindDiscriminatingExperiment(machine, ChangesOf({one}), ChangesOf({other}));
  if (!experiment || experiment->separation < kTold) {
    return "; no trajectory of the setup would, a larger or faster motion may";
  }
  std::string text = "; trajectory '" + experiment->trajectory + "'";
  if (experiment->slower > 1.0) {
    text +=
        ", " + std::to_string(static_cast<int>(experiment->slower)) + " times slower,";
  }
  return text + " would, by " +
         std::to_string(static_cast<int>(experiment->separation)) +
         " standard deviations";
}

void AddNotes(const AnswerData& data, const UnseenJudgement& judged,
              const std::function<bool()>& may_go_on, Discovery& discovery) {
  for (const std::string& refuted : judged.refuted) {
    discovery.notes.push_back("not named, for data outside the fit contradict it: " +
                              refuted);
  }
  if (data.steps.without > 0.0) {
    const double step = data.machine.plant().opt.timestep;
    const double late = 0.5 * data.steps.without * step / data.steps.finer;
    discovery.notes.push_back(NoteOfInputDelay(late, step));
  }
  const VectorXd& noise = judged.answer.seen.noise.reading;
  NoteQuiet(data, noise, discovery.notes);
  const Machine noisy = data.machine.WithSensorNoise(noise);
  for (const FoundCause& found : discovery.causes) {
    NoteAlternatives(noisy, found, may_go_on, discovery.notes);
  }
  for (const CalibratedNumber& number : discovery.calibration) {
    NoteFar(number, discovery.notes);
  }
}

void AddRaisedNoise(const AnswerData& data, const ModelOnRuns& answer,
                    const CandidateChoice& choice, Discovery& discovery) {
  const KeptGains gains = KeepGains(answer.seen);
  const Index sensors = answer.seen.sensors();
  VectorXd variance = VectorXd::Zero(sensors);
  VectorXd count = VectorXd::Zero(sensors);
  for (std::size_t row = 0; row < gains.readings.size(); ++row) {
    const double sd = 1.0 / gains.inverse_sd[static_cast<Index>(row)];
    variance[gains.readings[row].sensor] += sd * sd;
    count[gains.readings[row].sensor] += 1.0;
  }
  Observer observer;  // as much of one as this asks for
  observer.noise_sd = answer.seen.noise.reading;
  observer.innovation_sd = (variance.array() / count.array().max(1.0)).sqrt();
  for (const RaisedNoise& raised :
       FindRaisedNoise(data.machine.setup(), observer, answer.seen.innovations, 1.0,
                       data.run.seen.Counted())) {
    const Effect& noise = NoiseEffect();
    const Candidate candidate{
        .effect = Lasting(noise), .site = raised.element, .parameters = {}};
    if (!IsChosen(candidate, choice)) continue;
    FoundCause found;
    found.cause = {Lasting(noise), raised.element, ValuesOf({raised.sd})};
    const double half = TwoSidedNormalQuantile(0.05) * raised.sd_error;
    found.parameters = {{noise.parameters().front().name, raised.unit, raised.sd,
                         raised.sd_error, raised.sd - half, raised.sd + half}};
    found.probability = 1.0;
    discovery.causes.push_back(std::move(found));
  }
}

}  // namespace mjdiag
