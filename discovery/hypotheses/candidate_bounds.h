#pragma once
// What a record says of candidates beforehand. Of their shapes: a law that changes at a
// speed, a place or a command that the record never comes near is not one of that record.
// Of their sizes: what is plausible is so in proportion to what the machine does.

#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Narrows the bounds of shape parameters, by their role, to what the motion reaches
/// and resolves: velocities (of Stribeck friction) to 0.001 to 2 times the top speed of
/// the joint, lengths (of a hysteresis) to 1e-5 to 10 times the stroke, plays and positions
/// (of an end stop) to the stroke, limits (of a drive) to the largest force before the gear,
/// frequencies to between one period a record and half of the control rate. Joints that
/// stand still keep theirs. Sizes get their spread (Effect::Spread).
void BoundByRecord(std::vector<Candidate>& candidates, const Machine& machine,
                   const ObservedMotion& motion);

/// What springs before it slides has no damper there: a frequency above half of what samples
/// tell (Nyquist) is one that neither a record nor a filter follows. What a transmission gives is
/// more than how far its force moves the joint within a tick: less is when exactly it acts.
void BoundSprings(std::vector<Candidate>& candidates, const Machine& machine,
                  double sample_time);

/// Lets the frequencies of a candidate reach up to half of the rate of a finer look.
void WidenFrequencies(Candidate& candidate, double sample_time);

/// Errors of readings, narrowed by the steps in which these are written: none is smaller
/// than half of one, or repeats with it.
void BoundByReadings(std::vector<Candidate>& candidates, const Machine& machine,
                     const MeasuredRun& run);

/// A play that is less than the noise of the finest reading of its unit nobody would see: a
/// joint that moves no further has none.
void BoundPlays(std::vector<Candidate>& candidates, const Machine& machine,
                const Eigen::VectorXd& reading_sd);

/// A limit of a drive is no lower than the amplitude of a sine as large as what the drive is
/// asked for, sqrt(2) times its rms: below it is at its limit most of the time, and follows
/// nothing.
void BoundDriveLimits(std::vector<Candidate>& candidates, const Machine& machine,
                      const ObservedMotion& motion);

}  // namespace mjdiag
