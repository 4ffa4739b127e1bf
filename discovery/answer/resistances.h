#pragma once
// What resists a joint is one curve over its velocity, however many laws it takes to say it:
// dry friction that rises from a spring at rest to what a brake adds is "20 N at 0.05 m/s". Of
// all members of an answer that resist a joint, the force R that they make together, as what
// the machine does otherwise without them in every tick (member_forces.h),
//
//   R(k) = (M(q) dv(k))_j / h,
//
// or, where all of them are laws of that velocity alone, what these say where the joint slides;
// and by least squares along the motion R = dry sign(v) + viscous v + offset: what people put
// into a controller. Intervals by first order from those of the answer.

#include "mjdiag/discovery/answer/found_members.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Of every joint that members of the answer resist, but for one law of one size, which says
/// it itself.
void AddResistances(const AnswerData& data, const ModelOnRuns& answer,
                    const CoordinateErrors& errors, Discovery& discovery);

}  // namespace mjdiag
