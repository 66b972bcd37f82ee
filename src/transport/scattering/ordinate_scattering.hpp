// Scattering operator from radiance to source, both at the ordinates.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "transport/scattering/low_moments.hpp"
#include "transport/scattering/octant_scattering.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

template <class Real>
class OrdinateScattering {
 public:
  /// @param matrix [p] D x D, ordinates from ordinates
  OrdinateScattering(const OrdinateSet& ordinates, std::vector<DenseMatrix<Real>> matrix);

  const std::vector<DenseMatrix<Real>>& matrix() const { return matrix_; }
  /// Radiance becomes source, in place.
  void scatter_in_place(AngularField<Real>& field, const Cells<Real>& cells, const ScatteringTerms<Real>& terms) const;
  /// [low_moments][cells of the field] of the radiance.
  void moments_of(const AngularField<Real>& radiance, std::span<Real> moments) const;

 private:
  std::vector<DenseMatrix<Real>> matrix_;
  LowMoments<Real> low_;
  std::optional<OctantScattering<Real>> octants_;  // if ordinates and matrices have the symmetry for it
};

}  // namespace cloudbow
