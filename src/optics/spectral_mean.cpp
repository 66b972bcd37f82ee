#include "cloudbow/optics/spectral_mean.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

void check_weight(std::span<const double> wavenumber_cm1, std::span<const double> weight, const std::string& name) {
  const auto fail = [&](const std::string& text) { throw InputError(name + ": " + text); };
  if (wavenumber_cm1.size() != weight.size() || weight.size() < 2) {
    fail(fmt::format("weight of another length than its wavenumbers (found {} and {}, allowed the same, at least 2)",
                     weight.size(), wavenumber_cm1.size()));
  }
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (!(weight[n] >= 0 && std::isfinite(weight[n])))
      fail(fmt::format("weight out of range (found {} at {} cm-1, allowed >= 0)", weight[n], wavenumber_cm1[n]));
    if (!std::isfinite(wavenumber_cm1[n]) || (n > 0 && wavenumber_cm1[n] < wavenumber_cm1[n - 1]))
      fail(fmt::format("wavenumbers of the weight descend (found {} cm-1, allowed ascending ones)", wavenumber_cm1[n]));
  }
}

/// Shares of both ends of a piece on which weight and function are linear.
struct Piece {
  double left_share, right_share;
};

/// Simpson's rule for w (b - x)/(b - a) and w (x - a)/(b - a), exact for these quadratics.
Piece piece_of(double width, double left_weight, double right_weight) {
  return {width * (2 * left_weight + right_weight) / 6, width * (left_weight + 2 * right_weight) / 6};
}

}  // namespace

NodeShares node_shares(std::span<const double> node, std::span<const double> wavenumber, std::span<const double> weight,
                       const std::string& name) {
  check_weight(wavenumber, weight, name);
  assert(!node.empty());
  NodeShares result;
  result.share.assign(node.size(), 0.0);
  double total = 0;
  std::size_t right = 0;  // first node at or beyond the piece
  for (std::size_t n = 1; n < weight.size(); ++n) {
    const double begin = wavenumber[n - 1], end = wavenumber[n];
    if (!(end > begin)) continue;
    const auto weight_at = [&](double x) {
      const double t = (x - begin) / (end - begin);
      return (1 - t) * weight[n - 1] + t * weight[n];
    };
    double left = begin;
    while (left < end) {
      while (right < node.size() && node[right] <= left) ++right;
      const double stop = right < node.size() ? std::min(end, node[right]) : end;
      const Piece piece = piece_of(stop - left, weight_at(left), weight_at(stop));
      const double integral = piece.left_share + piece.right_share;
      total += integral;
      if (right == 0) {
        result.share.front() += integral;
        result.below += integral;
      } else if (right == node.size()) {
        result.share.back() += integral;
        result.above += integral;
      } else {
        // The function of the right node is (x - a)/(b - a).
        const double a = node[right - 1], b = node[right];
        const double of_right = piece.left_share * ((left - a) / (b - a)) + piece.right_share * ((stop - a) / (b - a));
        result.share[right] += of_right;
        result.share[right - 1] += integral - of_right;
      }
      left = stop;
    }
  }
  if (!(total > 0)) throw InputError(name + ": weight is 0 everywhere (found 0, allowed > 0 somewhere)");
  for (double& share : result.share) share = std::max(0.0, share / total);
  result.below /= total;
  result.above /= total;
  return result;
}

}  // namespace cloudbow
