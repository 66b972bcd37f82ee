#include "transport/columns/polar_streams.hpp"

#include <algorithm>
#include <cmath>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

// P_0 to P_{count-1} at x.
std::vector<double> legendre(int count, double x) {
  std::vector<double> value(count, 1.);
  if (count > 1) value[1] = x;
  for (int l = 2; l < count; ++l) value[l] = ((2 * l - 1) * x * value[l - 1] - (l - 1) * value[l - 2]) / l;
  return value;
}

std::vector<double> truncated_moments(const DeltaM& phase, int count) {
  std::vector<double> moments(count, 0.);
  for (int l = 0; l < count; ++l) moments[l] = phase.truncated.moment(l);
  return moments;
}

// [l][k] integral of P_l times the shifted Legendre polynomial P_k(2 mu - 1) over mu from 0 to 1.
std::vector<std::vector<double>> half_range_moments(int degrees, int count) {
  const GaussLegendre fine = make_gauss_legendre((degrees + count) / 2 + 1);
  std::vector<std::vector<double>> moment(degrees, std::vector<double>(count, 0.));
  for (std::size_t q = 0; q < fine.node.size(); ++q) {
    const std::vector<double> whole = legendre(degrees, .5 * (fine.node[q] + 1));
    const std::vector<double> half = legendre(count, fine.node[q]);
    for (int l = 0; l < degrees; ++l) {
      for (int k = 0; k < count; ++k) moment[l][k] += .5 * fine.weight[q] * whole[l] * half[k];
    }
  }
  return moment;
}

// Under a low sun half of a wide forward peak goes up and must not stay in the beam. The upper limits are what streams
// near the horizon resolve. Chosen on layers with g .93 to .98 and mu0 .05 to .3.
int beam_truncation_order(int count, std::optional<double> sun_cosine) {
  const int least = 4 * count;
  if (!sun_cosine) return least;
  const int most = std::max(least, std::min(6 * count, 48));
  return static_cast<int>(std::clamp(3 / *sun_cosine, static_cast<double>(least), static_cast<double>(most)));
}

}  // namespace

PolarStreams make_polar_streams(int count, std::span<const PhaseFunction> phase, std::optional<double> sun_cosine) {
  // Diffuse light needs no more moments than streams carry. The light that the beam scatters into each half range can
  // be computed to any order; the rest continues straight.
  const int diffuse_order = 2 * count;
  const int beam_order = beam_truncation_order(count, sun_cosine);
  PolarStreams streams;
  const GaussLegendre half = make_gauss_legendre(count);
  std::vector<std::vector<double>> at_stream;
  for (int i = 0; i < count; ++i) {
    streams.cosine.push_back(.5 * (half.node[i] + 1));
    streams.weight.push_back(.5 * half.weight[i]);
    at_stream.push_back(legendre(diffuse_order, streams.cosine[i]));
  }
  const auto half_range = half_range_moments(beam_order, count);
  for (const PhaseFunction& p : phase) {
    const DeltaM diffuse = delta_m(p, diffuse_order);
    const DeltaM beam = delta_m(p, beam_order);
    PolarStreams::Scattering scattering{diffuse.forward_fraction, beam.forward_fraction, {}, {}, {}, {}};
    const std::vector<double> moment = truncated_moments(diffuse, diffuse_order);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum[2] = {0, 0};
        for (int l = 0; l < diffuse_order; ++l)
          sum[l % 2] += (2 * l + 1) * moment[l] * at_stream[i][l] * at_stream[j][l];
        const double share = std::sqrt(streams.weight[i] * streams.weight[j]);
        scattering.even.push_back(share * sum[0]);
        scattering.odd.push_back(share * sum[1]);
      }
    }
    if (sun_cosine) {
      const std::vector<double> beam_moment = truncated_moments(beam, beam_order);
      const std::vector<double> at_sun = legendre(beam_order, *sun_cosine);
      for (int i = 0; i < count; ++i) {
        const std::vector<double> node = legendre(count, half.node[i]);
        double sum[2] = {0, 0};
        for (int l = 0; l < beam_order; ++l) {
          double projected = 0;
          for (int k = 0; k < count; ++k) projected += (2 * k + 1) * node[k] * half_range[l][k];
          sum[l % 2] += 2 * (2 * l + 1) * beam_moment[l] * at_sun[l] * projected;
        }
        scattering.from_beam_even.push_back(sum[0]);
        scattering.from_beam_odd.push_back(sum[1]);
      }
    }
    streams.phase.push_back(std::move(scattering));
  }
  return streams;
}

}  // namespace cloudbow
