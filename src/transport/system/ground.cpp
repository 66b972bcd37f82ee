#include "transport/system/ground.hpp"

#include <algorithm>
#include <numbers>

#include "transport/grid/octants.hpp"
#include "transport/rays/ray_rows.hpp"

namespace cloudbow {
namespace {

// field.row(r) += matrix(r, c) * from for every row.
template <class Real, class From>
void add_rows(AngularField<Real>& field, const Eigen::MatrixXd& matrix, Eigen::Index c, const From* from) {
  for (int r = 0; r < field.rows; ++r) {
    const Real scale = static_cast<Real>(matrix(r, c));
    Real* __restrict const to = field.row(r);
    for (std::size_t i = 0; i < field.cells; ++i) to[i] += scale * static_cast<Real>(from[i]);
  }
}

// Calls use(column, radiance, n) for pieces of rows of columns.
template <class Real, class Use>
void for_each_piece(const ArrivingRays<Real>& rays, const BoxGrid& box, const Use& use) {
  for_shifted_rows(rays.shift_x, rays.shift_y, box.nx, box.ny, [&](std::size_t column, std::size_t ray, int n) {
    use(column, rays.radiance.data() + ray, static_cast<std::size_t>(n));
  });
}

// Flux through the horizontal per unit radiance along a downward ordinate.
double power(const OrdinateSet& ordinates, int d) { return ordinates.weight[d] * -ordinates.direction[d].z(); }

}  // namespace

template <class Real>
std::vector<Real> ArrivingRays<Real>::by_column(const BoxGrid& box) const {
  std::vector<Real> arranged(box.columns());
  for_each_piece(*this, box, [&](std::size_t column, const Real* from, std::size_t n) {
    std::copy_n(from, n, arranged.data() + column);
  });
  return arranged;
}

template <class Real>
const Real* GroundRadiance<Real>::along(const Direction& travel, std::vector<Real>& scratch) const {
  if (!points) return at_points.row(0);
  const Stencil stencil = points->stencil(travel);
  scratch.assign(at_points.cells, Real(0));
  for (int k = 0; k < 3; ++k) {
    const Real weight = static_cast<Real>(stencil.weight[k]);
    const Real* __restrict const from = at_points.row(stencil.index[k]);
    for (std::size_t c = 0; c < scratch.size(); ++c) scratch[c] += weight * from[c];
  }
  if (beam) {
    const Real reflectance = static_cast<Real>((*beam)(travel));
    for (std::size_t c = 0; c < scratch.size(); ++c) scratch[c] += reflectance * direct_flux[c];
  }
  return scratch.data();
}

template <class Real>
Real GroundRadiance<Real>::at(const Direction& travel, std::size_t column) const {
  if (!points) return at_points.row(0)[column];
  const Stencil stencil = points->stencil(travel);
  Real radiance = 0;
  for (int k = 0; k < 3; ++k)
    radiance += static_cast<Real>(stencil.weight[k]) * at_points.row(stencil.index[k])[column];
  return beam ? radiance + static_cast<Real>((*beam)(travel)) * direct_flux[column] : radiance;
}

template <class Real>
Ground<Real>::Ground(const Surface& surface, const OrdinateSet& ordinates, const std::optional<Direction>& sun_travel)
    : albedo_(surface.albedo),
      albedo_map_(surface.albedo_map),
      planck_(surface.planck),
      planck_map_(surface.planck_map) {
  if (!surface.brdf) return;
  table_ = make_reflection_table(*surface.brdf, surface.tilt, ordinates, sun_travel);
  row_.assign(ordinates.size(), 0);
  for (std::size_t u = 0; u < table_->up.size(); ++u) row_[table_->up[u]] = static_cast<int>(u);
  if (!emits()) return;
  emissivity_up_ = 1 - table_->up_from_down.rowwise().sum().array();
  emissivity_points_ = 1 - table_->points_from_down.rowwise().sum().array();
  for (std::size_t u = 0; u < table_->up.size(); ++u) {
    const int d = table_->up[u];
    mean_emissivity_ += ordinates.weight[d] * ordinates.direction[d].z() / std::numbers::pi *
                        emissivity_up_[static_cast<Eigen::Index>(u)];
  }
}

template <class Real>
Ground<Real> Ground<Real>::without_emission() const {
  Ground cold = *this;
  cold.planck_ = 0;
  cold.planck_map_.clear();
  return cold;
}

template <class Real>
Ground<Real> Ground<Real>::with_planck_less(double reference) const {
  Ground other = *this;
  other.planck_ -= reference;
  for (float& planck : other.planck_map_) planck -= static_cast<float>(reference);
  return other;
}

template <class Real>
double Ground<Real>::mean_emission() const {
  if (!emits()) return 0;
  const std::size_t columns = std::max({std::size_t{1}, planck_map_.size(), table_ ? 0 : albedo_map_.size()});
  double sum = 0;
  for (std::size_t c = 0; c < columns; ++c) sum += (table_ ? mean_emissivity_ : 1 - albedo(c)) * planck(c);
  return std::numbers::pi * sum / static_cast<double>(columns);
}

// leaving.row(r) += emissivity(r) B
template <class Real>
void Ground<Real>::add_emission(const Eigen::VectorXd& emissivity, AngularField<Real>& leaving) const {
  for (int r = 0; r < leaving.rows; ++r) {
    for (std::size_t c = 0; c < leaving.cells; ++c) leaving.row(r)[c] += static_cast<Real>(emissivity[r] * planck(c));
  }
}

template <class Real>
void Ground<Real>::add_to(Digest& digest) const {
  digest.add(albedo_);
  digest.add(std::span<const float>(albedo_map_));
  if (emits()) {
    digest.add(planck_);
    digest.add(std::span<const float>(planck_map_));
  }
  if (!table_) return;
  for (const Eigen::MatrixXd* matrix : {&table_->points_from_down, &table_->up_from_down})
    digest.add(std::span<const double>(matrix->data(), static_cast<std::size_t>(matrix->size())));
  for (const Eigen::VectorXd* column : {&table_->points_from_beam, &table_->up_from_beam, &table_->albedo})
    digest.add(std::span<const double>(column->data(), static_cast<std::size_t>(column->size())));
  digest.add(table_->beam_albedo);
}

template <class Real>
double Ground<Real>::mean_albedo() const {
  if (table_) return table_->bihemispherical_albedo;
  if (albedo_map_.empty()) return albedo_;
  double sum = 0;
  for (const float a : albedo_map_) sum += static_cast<double>(a);
  return sum / static_cast<double>(albedo_map_.size());
}

template <class Real>
double Ground<Real>::mean_planck() const {
  if (planck_map_.empty()) return planck_;
  double sum = 0;
  for (const float planck : planck_map_) sum += static_cast<double>(planck);
  return sum / static_cast<double>(planck_map_.size());
}

template <class Real>
double Ground<Real>::largest_albedo() const {
  if (table_) return table_->largest_albedo;
  return albedo_map_.empty() ? albedo_ : static_cast<double>(*std::max_element(albedo_map_.begin(), albedo_map_.end()));
}

template <class Real>
void add_arriving(const ArrivingRays<Real>& rays, const OrdinateSet& ordinates, int ordinate, const BoxGrid& box,
                  std::span<double> flux) {
  const double weight = power(ordinates, ordinate);
  const auto octant = static_cast<std::size_t>(octant_of(ordinates.direction[ordinate]));
  double* const of_octant = flux.data() + octant * box.columns();
  for_each_piece(rays, box, [&](std::size_t column, const Real* from, std::size_t n) {
    double* __restrict const to = of_octant + column;
    for (std::size_t i = 0; i < n; ++i) to[i] += weight * static_cast<double>(from[i]);
  });
}

template <class Real>
typename Ground<Real>::Reflection Ground<Real>::reflect(const std::vector<ArrivingRays<Real>>& arriving,
                                                        std::span<const double> diffuse_flux,
                                                        std::span<const double> direct_flux,
                                                        const OrdinateSet& ordinates, const BoxGrid& box) const {
  const std::size_t columns = box.columns();
  Reflection result;
  result.flux.assign(columns, 0.);
  std::copy(direct_flux.begin(), direct_flux.end(), result.flux.begin());
  for (std::size_t of_octant = 0; of_octant < diffuse_flux.size(); of_octant += columns) {
    for (std::size_t c = 0; c < columns; ++c) result.flux[c] += diffuse_flux[of_octant + c];
  }
  if (!table_) {
    result.leaving = AngularField<Real>(1, columns);
    for (std::size_t c = 0; c < columns; ++c) {
      result.leaving.row(0)[c] =
          static_cast<Real>(albedo(c) / std::numbers::pi * result.flux[c] + (1 - albedo(c)) * planck(c));
      result.absorbed += (1 - albedo(c)) * result.flux[c];
    }
  } else {
    result.leaving = AngularField<Real>(static_cast<int>(table_->up.size()), columns);
    for (std::size_t q = 0; q < table_->down.size(); ++q) {
      const int d = table_->down[q];
      const auto column = static_cast<Eigen::Index>(q);
      const std::vector<Real> by_column = arriving[d].by_column(box);
      add_rows(result.leaving, table_->up_from_down, column, by_column.data());
      const double kept = power(ordinates, d) * (1 - table_->albedo[column]);
      for (const Real radiance : by_column) result.absorbed += kept * static_cast<double>(radiance);
    }
    if (!direct_flux.empty()) {
      add_rows(result.leaving, table_->up_from_beam, 0, direct_flux.data());
      for (const double flux : direct_flux) result.absorbed += (1 - table_->beam_albedo) * flux;
    }
    if (emits()) add_emission(emissivity_up_, result.leaving);
  }
  result.absorbed /= static_cast<double>(columns);
  return result;
}

template <class Real>
GroundRadiance<Real> Ground<Real>::radiance(const std::vector<std::vector<Real>>& arriving,
                                            std::span<const double> diffuse_flux, std::span<const double> direct_flux,
                                            const OrdinateSet& ordinates) const {
  const std::size_t columns = diffuse_flux.size();
  GroundRadiance<Real> result;
  result.flux.assign(columns, 0.);
  if (!table_) {
    result.at_points = AngularField<Real>(1, columns);
    for (std::size_t c = 0; c < columns; ++c) {
      result.flux[c] = albedo(c) * (diffuse_flux[c] + (direct_flux.empty() ? 0. : direct_flux[c])) +
                       std::numbers::pi * (1 - albedo(c)) * planck(c);
      result.at_points.row(0)[c] = static_cast<Real>(result.flux[c] / std::numbers::pi);
    }
    return result;
  }
  result.points = table_->points;
  result.at_points = AngularField<Real>(table_->points.size(), columns);
  std::vector<double> found(columns, 0.);
  for (const int d : table_->down) {
    for (std::size_t c = 0; c < columns; ++c) found[c] += power(ordinates, d) * static_cast<double>(arriving[d][c]);
  }
  std::vector<double> scaled(columns);
  for (std::size_t q = 0; q < table_->down.size(); ++q) {
    const int d = table_->down[q];
    const auto column = static_cast<Eigen::Index>(q);
    for (std::size_t c = 0; c < columns; ++c) {
      scaled[c] = found[c] > 0 ? diffuse_flux[c] / found[c] * static_cast<double>(arriving[d][c]) : 0.;
      result.flux[c] += power(ordinates, d) * table_->albedo[column] * scaled[c];
    }
    add_rows(result.at_points, table_->points_from_down, column, scaled.data());
  }
  if (emits()) {
    add_emission(emissivity_points_, result.at_points);
    for (std::size_t c = 0; c < columns; ++c) result.flux[c] += std::numbers::pi * mean_emissivity_ * planck(c);
  }
  if (!direct_flux.empty()) {
    add_rows(result.at_points, table_->points_from_beam, 0, direct_flux.data());
    for (std::size_t c = 0; c < columns; ++c) result.flux[c] += table_->beam_albedo * direct_flux[c];
  }
  return result;
}

template <class Real>
GroundRadiance<Real> Ground<Real>::radiance_seen(const std::vector<std::vector<Real>>& arriving,
                                                 std::span<const double> diffuse_flux,
                                                 std::span<const double> direct_flux,
                                                 const OrdinateSet& ordinates) const {
  if (!table_ || direct_flux.empty()) return radiance(arriving, diffuse_flux, direct_flux, ordinates);
  GroundRadiance<Real> result = radiance(arriving, diffuse_flux, {}, ordinates);
  result.beam = table_->beam;
  result.direct_flux.assign(direct_flux.begin(), direct_flux.end());
  for (std::size_t c = 0; c < direct_flux.size(); ++c) result.flux[c] += table_->beam_albedo * direct_flux[c];
  return result;
}

template void add_arriving<float>(const ArrivingRays<float>&, const OrdinateSet&, int, const BoxGrid&,
                                  std::span<double>);
template void add_arriving<double>(const ArrivingRays<double>&, const OrdinateSet&, int, const BoxGrid&,
                                   std::span<double>);
template struct ArrivingRays<float>;
template struct ArrivingRays<double>;
template struct GroundRadiance<float>;
template struct GroundRadiance<double>;
template class Ground<float>;
template class Ground<double>;

}  // namespace cloudbow
