#include "mjdiag/diagnosis/twin/twin_in_coordinates.h"

#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Columns that are those rows alone.
std::vector<Index> PlacesOf(std::vector<Index> rows, const MatrixXd& T) {
  for (Index& row : rows) T.row(row).maxCoeff(&row);
  return rows;
}

}  // namespace

TwinInCoordinates::TwinInCoordinates(std::unique_ptr<Twin> twin, MatrixXd T,
                                     const std::vector<UnknownTone>& tones)
    : Twin({twin->outputs(), twin->inputs(), twin->states(), T.cols(),
            twin->start_unknowns(), twin->block(), twin->curvature(), twin->linear()},
           twin->gains(), tones, 1.0, PlacesOf(twin->drifting(), T)),
      twin_(std::move(twin)),
      T_(std::move(T)),
      of_twin_(VectorXd::Zero(T_.rows())),
      sensitivity_(MatrixXd::Zero(twin_->outputs() * twin_->block(), T_.cols())) {}

void TwinInCoordinates::Start(const VectorXd& z) noexcept {
  of_twin_.noalias() = T_ * z;
  twin_->Start(of_twin_);
}

void TwinInCoordinates::Start(const VectorXd& z, const TwinState& state,
                              Index tick) noexcept {
  of_twin_.noalias() = T_ * z;
  twin_->Start(of_twin_, state, tick);
}

const MatrixXd& TwinInCoordinates::EndBlock() noexcept {
  sensitivity_.noalias() = twin_->EndBlock() * T_;
  drift_ = twin_->drift();
  return sensitivity_;
}

void TwinInCoordinates::Shift(const VectorXd& change) noexcept {
  of_twin_.noalias() = T_ * change;
  twin_->Shift(of_twin_);
}

}  // namespace mjdiag
