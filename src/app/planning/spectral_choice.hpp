// The choice of a few g-points, with weights, that stand for all in three dimensions (docs/theory.md, "Few g-points").
#pragma once

#include <span>
#include <vector>

namespace cloudbow {

/// Means over columns by height, W m-2 and W m-3.
struct LevelMeans {
  std::vector<double> up;            ///< [levels + 1]
  std::vector<double> down_diffuse;  ///< [levels + 1]
  std::vector<double> direct;        ///< [levels + 1]
  std::vector<double> absorbed;      ///< [levels] net
  std::vector<double> light{};       ///< [3] EnergyLedger::power, of it incident, and emitted by the ground
};

/// One g-point's answer for sampled columns, as independent columns have it.
struct ColumnAnswers {
  double power = 1;              ///< of the g-point, W m-2; the unit of all that follows; 0: the g-point has no light
  std::vector<double> up;        ///< [columns] at the top, per power
  std::vector<double> down;      ///< [columns] at the ground, per power, direct and diffuse
  std::vector<double> absorbed;  ///< [columns] below the cloud's top, net, per power
  std::vector<double> heating;   ///< [levels below the cloud's top] absorbed per volume, net, per power, mean; or empty
  LevelMeans means;              ///< per power; or empty
};

struct SpectralChoice {
  std::vector<int> point;      ///< chosen, ascending
  std::vector<double> weight;  ///< > 0; a field of all is sum of weight times the field per power of the chosen
  double residual = 0;         ///< of the sampled columns, relative: foretells the error of fields in three dimensions
  /// Means of all less those of the chosen, W m-2 and W m-3. It is to be added to the fields of the chosen. Domain
  /// means then err by three-dimensional effects alone. Empty without ColumnAnswers::means.
  LevelMeans missing;
};

/// Non-negative least squares: the x >= 0 that minimises |A x - b| (Lawson and Hanson 1974, chapter 23).
/// @param columns [n] of A, all of b's length.
std::vector<double> non_negative_least_squares(std::span<const std::vector<double>> columns, std::span<const double> b);

/// Forward selection with exchange, until the residual is below `tolerance` or all are chosen. G-points without power
/// are never chosen; all others together have residual 0. Deterministic.
/// @param points at most so many; 0: no limit.
SpectralChoice choose_points(std::span<const ColumnAnswers> of_points, double tolerance, int points = 0);

}  // namespace cloudbow
