#pragma once
// A parity relation by linear programming, [AB383], Eq. 17 to 19. With the coefficients
// of a polynomial row vector N(p) of degree d_N side by side, Nbar = [N_0 .. N_dN], one
// that is blind to the unknowns x and sees a fault is
//
//   Nbar Hbar = 0,   ||Nbar Fbar||_inf >= 1                              (Eq. 18)
//
// Hbar, Fbar: the bar matrices of H and F (BarMatrix). The second condition is not
// convex; since -Nbar is as good as Nbar it splits into one linear program for each of
// the m = n_f (d_F + d_N + 1) columns of Fbar, and the best of all of them is the
// relation:
//
//   min ||Nbar||   subject to   Nbar Hbar = 0,   (Nbar Fbar)_j >= 1,   j = 0 .. m - 1
//
// The size ||Nbar|| depends on the units, so pose the DAE in units in which all
// coefficients are of comparable size (UnitMassStateSpace). The infinity norm bounds
// the largest coefficient; the 1-norm favours relations with few of them.
//
// Hbar is equilibrated before Clp sees it, and every solution is projected onto the
// left null space of Hbar from its singular value decomposition, so that N annihilates
// H to rounding and not to the tolerance of a solver.

#include <optional>

#include "mjdiag/diagnosis/model/dae_model.h"

namespace mjdiag {

enum class RelationNorm { kOne, kInfinity };

struct ParityProgramOptions {
  RelationNorm norm = RelationNorm::kOne;  ///< of Nbar, to be minimised
};

struct ParityProgramSolution {
  PolynomialMatrix N;      ///< 1 x (rows of H), of the degree asked for
  int column = 0;          ///< j: the column of Fbar with (Nbar Fbar)_j = 1
  double objective = 0.0;  ///< ||Nbar|| in the norm that was minimised
  double defect = 0.0;     ///< ||Nbar Hbar|| / (||Nbar|| ||Hbar||), Frobenius norms
  int programs = 0;        ///< m
  int feasible = 0;        ///< how many of the m have a solution
};

/// The smallest relation of that degree, as far as the solver's tolerance tells; the
/// first of equals. No value: no relation of that degree that annihilates H sees any of
/// the faults, either because the degree is too low or because [H F] has no higher rank
/// than H ([AB383], Remark 2).
///
/// InputError if the degree is negative, H is empty, H and F have not as many rows, or
/// there are no fault inputs. NumericalError if the rank of Hbar is lost in rounding (a
/// unit of time far from the modes of the model does that) or Clp leaves a program
/// undecided.
std::optional<ParityProgramSolution> SolveParityPrograms(
    const DaeModel& dae, int degree, const ParityProgramOptions& options = {});

}  // namespace mjdiag
