#pragma once
// How long a residual generator r = d(p)^-1 N(p) z is: the degree of its numerators N,
// which decides what parity relations there are, and the denominator d that makes it a
// proper filter.

#include "mjdiag/diagnosis/residuals/filter_bank.h"

namespace mjdiag {

struct ResidualOrder {
  int degree = 7;           ///< d_N, no more than the order of the denominator
  Denominator denominator;  ///< [AB383], Eq. 31
};

}  // namespace mjdiag
