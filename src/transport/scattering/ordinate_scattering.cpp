#include "transport/scattering/ordinate_scattering.hpp"

#include <utility>

namespace cloudbow {

template <class Real>
OrdinateScattering<Real>::OrdinateScattering(const OrdinateSet& ordinates, std::vector<DenseMatrix<Real>> matrix)
    : matrix_(std::move(matrix)),
      low_(ordinates),
      octants_(OctantScattering<Real>::make(ordinates, matrix_, low_.weights, low_.shape)) {}

template <class Real>
void OrdinateScattering<Real>::scatter_in_place(AngularField<Real>& field, const Cells<Real>& cells,
                                                const ScatteringTerms<Real>& terms) const {
  if (octants_) {
    octants_->scatter_in_place(field, cells, terms);
  } else {
    cloudbow::scatter_in_place<Real>(field, matrix_, cells, terms, low_.shape);
  }
}

template <class Real>
void OrdinateScattering<Real>::moments_of(const AngularField<Real>& radiance, std::span<Real> moments) const {
  if (octants_) {
    octants_->moments_of(radiance, moments);
  } else {
    cloudbow::moments_of<Real>(radiance, low_.weights, moments);
  }
}

template class OrdinateScattering<float>;
template class OrdinateScattering<double>;

}  // namespace cloudbow
