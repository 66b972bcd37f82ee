// Scattering among ordinates that the eight reflections x -> -x, y -> -y, z -> -z map onto themselves. Phase functions
// depend on the angle alone. The matrix between two octants thus depends on the reflections that lead from one to the
// other. Sums and differences over the octants (a Walsh-Hadamard transform) separate into eight sectors. Each has a
// matrix of an octant's size: an eighth of the multiplications (docs/theory.md, "Scattering").
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

template <class Real>
class OctantScattering {
 public:
  /// @param matrix [p] D x D; @param moment_weights low_moments x D; @param correction_shape D x low_moments: as for
  /// scatter_in_place and moments_of. @returns nothing if the set or a matrix lacks the symmetry.
  static std::optional<OctantScattering> make(const OrdinateSet& ordinates, std::span<const DenseMatrix<Real>> matrix,
                                              const DenseMatrix<Real>& moment_weights,
                                              const DenseMatrix<Real>& correction_shape);

  /// The same as the free function of this name, to rounding.
  void scatter_in_place(AngularField<Real>& field, const Cells<Real>& cells, const ScatteringTerms<Real>& terms) const;
  void moments_of(const AngularField<Real>& radiance, std::span<Real> moments) const;

 private:
  static constexpr int octants = 8;

  // Moments have the parity of one sector each.
  struct SectorMoment {
    int moment;
    std::vector<Real> weight;  // [octant size]
    std::vector<Real> shape;   // [octant size] times eight, as the sums over octants are
  };

  void add_moments(std::span<const Real> moments, std::size_t cells, std::size_t first, int n, Real scale,
                   Real* by_octant) const;
  void fold(const AngularField<Real>& field, std::size_t first, Real* by_octant) const;

  int octant_size_ = 0;
  std::vector<int> ordinate_;                                   // [octant][octant size] index of the ordinate
  std::vector<std::array<std::vector<Real>, octants>> matrix_;  // [p][sector] columns of an octant's matrix, an eighth
  std::array<std::vector<SectorMoment>, octants> moments_;
};

}  // namespace cloudbow
