#include "cloudbow/optics/surface_brdf.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

constexpr double least_cosine = .02;

// The two directions as kernels take them: away from the surface both, towards the source and towards the observer.
struct Angles {
  double mu_i, mu_o;  // cosines to the normal
  double tan_i, tan_o;
  double cos_azimuth;  // 1: source and observer on the same side
  double cos_phase;    // cosine of the angle between them

  Angles(const Direction& arriving, const Direction& leaving) {
    mu_i = std::clamp(-arriving.z(), least_cosine, 1.);
    mu_o = std::clamp(leaving.z(), least_cosine, 1.);
    tan_i = std::sqrt(1 - mu_i * mu_i) / mu_i;
    tan_o = std::sqrt(1 - mu_o * mu_o) / mu_o;
    const double across = std::hypot(arriving.x(), arriving.y()) * std::hypot(leaving.x(), leaving.y());
    cos_azimuth =
        across > 0 ? std::clamp(-(arriving.x() * leaving.x() + arriving.y() * leaving.y()) / across, -1., 1.) : 1;
    cos_phase = std::clamp(mu_i * mu_o * (1 + tan_i * tan_o * cos_azimuth), -1., 1.);
  }
  // Horizontal distance between the two lines of sight at unit height.
  double distance() const {
    return std::sqrt(std::max(0., tan_i * tan_i + tan_o * tan_o - 2 * tan_i * tan_o * cos_azimuth));
  }
};

double ross_thick(const Angles& a) {
  const double phase = std::acos(a.cos_phase);
  return ((pi / 2 - phase) * a.cos_phase + std::sin(phase)) / (a.mu_i + a.mu_o) - pi / 4;
}

double li_sparse(const Angles& a) {
  constexpr double height_to_width = 2;
  const double secants = 1 / a.mu_i + 1 / a.mu_o;
  const double sine = std::sqrt(1 - a.cos_azimuth * a.cos_azimuth);
  const double reach = std::hypot(a.distance(), a.tan_i * a.tan_o * sine);
  const double t = std::acos(std::min(1., height_to_width * reach / secants));
  const double overlap = (t - std::sin(t) * std::cos(t)) * secants / pi;
  return overlap - secants + (1 + a.cos_phase) / (2 * a.mu_i * a.mu_o);
}

// Fresnel's reflectance of unpolarised light at a surface met at this cosine.
double fresnel(double cosine, double index) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (index * index));
  const double across = (cosine - index * inside) / (cosine + index * inside);
  const double along = (index * cosine - inside) / (index * cosine + inside);
  return .5 * (across * across + along * along);
}

// Share of waves hidden by others per share seen, at a cosine to the vertical (Smith 1967, Eq. 21-24).
double hidden(double mu, double slope_variance) {
  if (mu >= 1) return 0;
  const double v = mu / std::sqrt((1 - mu * mu) * slope_variance);
  return std::max(0., .5 * (std::exp(-v * v) / (v * std::sqrt(pi)) - std::erfc(v)));
}

void require(bool good, const std::string& found, const std::string& allowed) {
  if (!good) throw InputError(found + " (" + allowed + ")");
}

}  // namespace

SurfaceBrdf SurfaceBrdf::lambertian(double albedo) {
  require(albedo >= 0 && albedo <= 1, fmt::format("surface albedo {}", albedo), "allowed: 0 to 1");
  SurfaceBrdf brdf;
  brdf.function_ = [value = albedo / pi](const Direction&, const Direction&) { return value; };
  brdf.key_ = fmt::format("lambertian {:.17g}", albedo);
  brdf.lambertian_ = true;
  return brdf;
}

SurfaceBrdf SurfaceBrdf::rpv(double rho0, double k, double theta, double rho_c) {
  require(rho0 >= 0 && std::isfinite(rho0), fmt::format("rho0 = {}", rho0), "allowed: >= 0");
  require(k > 0 && std::isfinite(k), fmt::format("k = {}", k), "allowed: > 0");
  require(std::abs(theta) < 1, fmt::format("theta = {}", theta), "allowed: between -1 and 1");
  require(rho_c >= 0 && std::isfinite(rho_c), fmt::format("rho_c = {}", rho_c), "allowed: >= 0");
  SurfaceBrdf brdf;
  brdf.function_ = [=](const Direction& arriving, const Direction& leaving) {
    const Angles a(arriving, leaving);
    const double bowl = std::pow(a.mu_i * a.mu_o * (a.mu_i + a.mu_o), k - 1);
    // They write the scattering angle; the phase angle is its supplement, hence the sign.
    const double lobe = (1 - theta * theta) / std::pow(1 + 2 * theta * a.cos_phase + theta * theta, 1.5);
    const double hot_spot = 1 + (1 - rho_c) / (1 + a.distance());
    return rho0 / pi * bowl * lobe * not_negative(hot_spot);
  };
  brdf.key_ = fmt::format("rpv {:.17g} {:.17g} {:.17g} {:.17g}", rho0, k, theta, rho_c);
  return brdf;
}

SurfaceBrdf SurfaceBrdf::ross_li(double f_iso, double f_vol, double f_geo) {
  require(f_iso >= 0 && std::isfinite(f_iso), fmt::format("f_iso = {}", f_iso), "allowed: >= 0");
  require(std::isfinite(f_vol) && std::isfinite(f_geo), fmt::format("f_vol = {}, f_geo = {}", f_vol, f_geo),
          "allowed: finite");
  SurfaceBrdf brdf;
  brdf.function_ = [=](const Direction& arriving, const Direction& leaving) {
    const Angles a(arriving, leaving);
    return not_negative(f_iso + f_vol * ross_thick(a) + f_geo * li_sparse(a)) / pi;
  };
  brdf.key_ = fmt::format("ross-li {:.17g} {:.17g} {:.17g}", f_iso, f_vol, f_geo);
  return brdf;
}

SurfaceBrdf SurfaceBrdf::cox_munk(double wind_speed_m_s, double refractive_index) {
  require(wind_speed_m_s >= 0 && wind_speed_m_s <= 50, fmt::format("wind_speed_m_s = {}", wind_speed_m_s),
          "allowed: 0 to 50");
  require(refractive_index > 1 && refractive_index < 10, fmt::format("refractive_index = {}", refractive_index),
          "allowed: above 1, below 10");
  const double variance = .003 + .00512 * wind_speed_m_s;
  SurfaceBrdf brdf;
  brdf.function_ = [=](const Direction& arriving, const Direction& leaving) {
    const Angles a(arriving, leaving);
    // The normal of the facet that mirrors one direction into the other bisects the angle between them.
    const double cos_half = std::sqrt(.5 * (1 + a.cos_phase));
    if (cos_half == 0) return 0.;
    const double tilt = std::min(1., (a.mu_i + a.mu_o) / (2 * cos_half));
    const double tilt2 = tilt * tilt;
    const double slopes = std::exp(-(1 - tilt2) / (tilt2 * variance)) / (pi * variance);
    const double seen = 1 / (1 + hidden(a.mu_i, variance) + hidden(a.mu_o, variance));
    return fresnel(cos_half, refractive_index) * slopes * seen / (4 * a.mu_i * a.mu_o * tilt2 * tilt2);
  };
  brdf.key_ = fmt::format("cox-munk {:.17g} {:.17g}", wind_speed_m_s, refractive_index);
  return brdf;
}

double SurfaceBrdf::operator()(const Direction& arriving, const Direction& leaving) const {
  return function_(arriving, leaving);
}

double SurfaceBrdf::directional_albedo(double mu) const {
  const Direction arriving(std::sqrt(1 - mu * mu), 0, -mu);
  if (lambertian_) return function_(arriving, -arriving) * pi;
  // Both sides of the plane of incidence are alike: half the azimuths suffice. Nodes are densest at the horizon,
  // because glints are narrow there, by mu_o = u^2.
  constexpr int polar_nodes = 96;
  constexpr int azimuths = 192;
  const GaussLegendre u = make_gauss_legendre(polar_nodes);
  double albedo = 0;
  for (int i = 0; i < polar_nodes; ++i) {
    const double root = .5 * (1 + u.node[i]);
    const double cosine = root * root;
    const double sine = std::sqrt(1 - cosine * cosine);
    double ring = 0;
    for (int j = 0; j < azimuths; ++j) {
      const double azimuth = pi * (j + .5) / azimuths;
      ring += function_(arriving, {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
    }
    albedo += .5 * u.weight[i] * 2 * root * cosine * ring * 2 * pi / azimuths;
  }
  return albedo;
}

}  // namespace cloudbow
