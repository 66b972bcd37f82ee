// Means over a spectral weight of functions that are given at wavenumbers.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// A weight by wavenumber, linear between its nodes and 0 beyond them. A wavenumber that stands twice is a step.
struct SpectralWeight {
  std::vector<double> wavenumber_cm1;  ///< not descending, at least two
  std::vector<double> weight;          ///< >= 0, any unit, not all 0
};

/// The mean as a sum over the nodes of a function: sum_n share[n] f_n.
struct NodeShares {
  std::vector<double> share;  ///< [nodes] >= 0, they sum to 1
  double below = 0;           ///< part of the weight below the first node, in which f is that of the first
  double above = 0;           ///< part of the weight above the last node
};

/// Integrals of the weight times the function that is 1 at a node, 0 at the others and linear between. They are exact:
/// the product is a quadratic on each piece of the union of both sets of nodes.
/// @param node_cm1 ascending, at least one.
/// @throws InputError if the weight is not as SpectralWeight says; the message begins with `name`.
NodeShares node_shares(std::span<const double> node_cm1, std::span<const double> wavenumber_cm1,
                       std::span<const double> weight, const std::string& name);

}  // namespace cloudbow
