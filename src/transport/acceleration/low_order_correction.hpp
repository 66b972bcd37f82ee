// Correction of the iterate by the same transport problem with few directions (transport synthetic acceleration).
// Diffusion accelerates it if the medium is thick (docs/theory.md, "Acceleration").
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "transport/acceleration/coarsening.hpp"
#include "transport/acceleration/diffusion_correction.hpp"

namespace cloudbow {

template <class Real>
class LowOrderCorrection {
 public:
  /// @param tolerance relative, of each correction.
  /// @param share of the solve, whose ranks all make the same low-order solution; null: there is one rank
  LowOrderCorrection(const TransportSystem<Real>& system, double tolerance, const OrdinateShare* share = nullptr);
  ~LowOrderCorrection();
  LowOrderCorrection(LowOrderCorrection&&) noexcept;
  LowOrderCorrection& operator=(LowOrderCorrection&&) noexcept;

  /// The moments [low_moments][own cells] of the light that the system's own beam leaves: a first guess. If there is
  /// thermal emission, the guess has its light too, and that of sky and ground.
  void guess(std::span<Real> moments);
  /// Computes the moments missing after a sweep that changed them by `change`: those of the light that this change
  /// leads to. Both [low_moments][own cells].
  void correct(std::span<const Real> change, std::span<Real> correction);

  int sweeps() const { return sweeps_; }  ///< with few directions, so far
  bool uses_diffusion() const;
  /// Slower from now on, but without the part that can diverge.
  void drop_diffusion();

 private:
  CellRange own_cells() const;
  void emit(std::span<const Real> source);
  void emit_moment(int moment, const Real* source);
  std::vector<Real> iterate();
  void solve(std::span<Real> moments);

  std::optional<Coarsening<Real>> coarse_;  // without: the problem's own cells
  TransportSystem<Real> low_;
  std::vector<DenseMatrix<Real>> scattered_moments_;  // [p] low_moments x low_moments
  std::vector<Real> beam_moments_;                    // [beam][low_moments]
  const TransportSystem<Real>* full_;
  const OrdinateShare* share_;
  std::unique_ptr<DiffusionCorrection<Real>> diffusion_;
  Ground<Real> guess_ground_;  // with its emission, if there is thermal emission
  double tolerance_;
  int sweeps_ = 0;
};

}  // namespace cloudbow
