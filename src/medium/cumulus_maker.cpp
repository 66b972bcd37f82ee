// A field of fair-weather cumulus. Each cloud is a bundle of turrets that rise from a common base and end in domes;
// billows of ever smaller size, down to the cells, displace its surface outwards. They are Perlin's gradient noise, its
// absolute value for round bulges with sharp creases between.
#include <algorithm>
#include <cmath>
#include <limits>

#include "cloud_maker_parts.hpp"
#include "random.hpp"

namespace cloudbow {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double size_exponent =
    -1.7;  // number of clouds of a diameter (Neggers et al. 2003, doi 10.1175/1520-0469(2003)060<2060:SSOSCI>2.0.CO;2)
constexpr double largest_diameter_m = 1800;
constexpr double surplus = 1.25;  // of the area of the footprints: the cover is then reached by removing outer parts
constexpr double undiluted_fraction = 0.8;  // adiabatic fraction of liquid water at the base
constexpr double dilution_height_m = 1000;  // height at which entrainment has halved it

struct Turret {
  double x, y;    ///< from the middle of the cloud [m]
  double top;     ///< centre of its dome above the base [m]
  double radius;  ///< of turret and dome [m]
};

struct Cumulus {
  double x, y, radius, height;
  std::vector<Turret> turrets;
};

/// Gradient noise (Perlin 2002, doi 10.1145/566654.566636) that repeats after the domain's width along x and y, about
/// -1 to 1.
class PeriodicNoise {
 public:
  PeriodicNoise(const MakerGrid& grid, double wavelength, std::uint64_t seed)
      : nx_(waves(grid.width_x(), wavelength)),
        ny_(waves(grid.width_y(), wavelength)),
        fx_(nx_ / grid.width_x()),
        fy_(ny_ / grid.width_y()),
        fz_(1 / wavelength),
        seed_(split_mix(seed)) {}

  double operator()(double x, double y, double z) const {
    const double u = x * fx_;
    const double v = y * fy_;
    const double w = z * fz_;
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const int k = static_cast<int>(std::floor(w));
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int a = corner & 1;
      const int b = corner >> 1 & 1;
      const int c = corner >> 2;
      const double p = u - i - a;
      const double q = v - j - b;
      const double r = w - k - c;
      sum +=
          fade(1 - std::abs(p)) * fade(1 - std::abs(q)) * fade(1 - std::abs(r)) * slope(i + a, j + b, k + c, p, q, r);
    }
    return sum;
  }

 private:
  static int waves(double width, double wavelength) {
    return std::max(1, static_cast<int>(std::lround(width / wavelength)));
  }
  static double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

  double slope(int i, int j, int k, double p, double q, double r) const {
    static constexpr std::array<std::array<int, 3>, 12> edges = {{{1, 1, 0},
                                                                  {-1, 1, 0},
                                                                  {1, -1, 0},
                                                                  {-1, -1, 0},
                                                                  {1, 0, 1},
                                                                  {-1, 0, 1},
                                                                  {1, 0, -1},
                                                                  {-1, 0, -1},
                                                                  {0, 1, 1},
                                                                  {0, -1, 1},
                                                                  {0, 1, -1},
                                                                  {0, -1, -1}}};
    const auto wrap = [](int n, int period) { return static_cast<std::uint64_t>((n % period + period) % period); };
    const auto hash = split_mix(split_mix(split_mix(seed_ ^ wrap(i, nx_)) ^ wrap(j, ny_)) ^
                                static_cast<std::uint64_t>(std::int64_t{k}));
    const auto& edge = edges[hash % edges.size()];
    return edge[0] * p + edge[1] * q + edge[2] * r;
  }

  int nx_, ny_;
  double fx_, fy_, fz_;
  std::uint64_t seed_;
};

/// Octaves of noise, wavelengths halving from the largest cloud's to two cells.
class Turbulence {
 public:
  Turbulence(const MakerGrid& grid, double longest, std::uint64_t seed) {
    const double shortest = 2 * std::min(grid.dx, grid.dy);
    for (double wavelength = longest; wavelength >= shortest; wavelength /= 2) {
      octaves_.push_back({wavelength, PeriodicNoise(grid, wavelength, seed + octaves_.size())});
    }
  }

  /// Height [m] of the billows on a surface of the given radius: bulges up to that size, each as high as its share of
  /// it.
  double billows(double x, double y, double z, double radius) const {
    double sum = 0;
    for (const auto& [wavelength, noise] : octaves_) {
      if (wavelength <= 1.2 * radius) sum += wavelength * (std::abs(noise(x, y, z)) - 0.25);
    }
    return 0.55 * sum;
  }

  /// Fluctuation of order 1 with a spectrum that falls towards short waves.
  double fluctuation(double x, double y, double z) const {
    double sum = 0;
    for (const auto& [wavelength, noise] : octaves_)
      sum += std::cbrt(wavelength / octaves_.front().wavelength) * noise(x, y, z);
    return sum;
  }

 private:
  struct Octave {
    double wavelength;
    PeriodicNoise noise;
  };
  std::vector<Octave> octaves_;
};

/// From x1 to x2 the short way around a domain that repeats.
double periodic_distance(double x1, double x2, double width) {
  const double distance = x2 - x1;
  return distance - width * std::nearbyint(distance / width);
}

/// Diameters of a truncated power law until the footprints, overlapping at random, cover the given fraction; largest
/// first.
std::vector<double> draw_diameters(const MakerGrid& grid, double cover, Random& random) {
  const double largest = std::min(largest_diameter_m, 0.35 * std::min(grid.width_x(), grid.width_y()));
  const double smallest = std::min(std::max(3 * std::max(grid.dx, grid.dy), largest / 12), largest / 2);
  const double area = -std::log(1 - cover) * surplus * grid.width_x() * grid.width_y();
  const double power = size_exponent + 1;
  std::vector<double> diameters;
  for (double covered = 0; covered < area; covered += 0.25 * pi * diameters.back() * diameters.back()) {
    const double ratio = std::pow(largest / smallest, power);
    diameters.push_back(smallest * std::pow(1 + random.uniform() * (ratio - 1), 1 / power));
  }
  std::sort(diameters.begin(), diameters.end(), std::greater<>());
  return diameters;
}

std::vector<Turret> raise_turrets(double radius, double height, Random& random) {
  std::vector<Turret> turrets;
  const int count = 5 + static_cast<int>(radius / 40);
  const double stretch = random.uniform(0.65, 1);  // footprints are ellipses that point anywhere
  const double turn = random.uniform(0, pi);
  for (int n = 0; n < count; ++n) {
    // Turrets in the middle are wide and high, those towards the rim slender and low.
    const double distance = n == 0 ? 0 : std::sqrt(random.uniform());
    const double azimuth = random.uniform(0, 2 * pi);
    const double width = radius * random.uniform(0.28, 0.45) * (1 - 0.35 * distance);
    const double reach = distance * (radius - width);
    const double a = reach * std::cos(azimuth);
    const double b = reach * std::sin(azimuth) * stretch;
    const double top = height * random.uniform(0.55, 1) * (1 - 0.75 * distance * distance);
    turrets.push_back({a * std::cos(turn) - b * std::sin(turn), a * std::sin(turn) + b * std::cos(turn),
                       std::max(0.0, top - width), width});
  }
  return turrets;
}

std::vector<Cumulus> populate(const MakerGrid& grid, double headroom, double cover, std::uint64_t seed) {
  Random random(seed);
  std::vector<Cumulus> clouds;
  for (const double diameter : draw_diameters(grid, cover, random)) {
    Cumulus cloud{.x = 0,
                  .y = 0,
                  .radius = 0.5 * diameter,
                  .height = std::min(diameter * random.uniform(0.55, 0.95), 0.85 * headroom),
                  .turrets = {}};
    const auto overlaps = [&](const Cumulus& other) {
      const double x = periodic_distance(other.x, cloud.x, grid.width_x());
      const double y = periodic_distance(other.y, cloud.y, grid.width_y());
      return std::hypot(x, y) < 0.9 * (cloud.radius + other.radius);
    };
    for (int attempt = 0; attempt < 200; ++attempt) {
      cloud.x = random.uniform(0, grid.width_x());
      cloud.y = random.uniform(0, grid.width_y());
      if (std::none_of(clouds.begin(), clouds.end(), overlaps)) break;
    }
    cloud.turrets = raise_turrets(cloud.radius, cloud.height, random);
    clouds.push_back(cloud);
  }
  return clouds;
}

/// Distance into the bundle of turrets, smooth billows not counted: positive inside [m].
double depth_inside(const Cumulus& cloud, double x, double y, double z) {
  double depth = -std::numeric_limits<double>::infinity();
  for (const auto& turret : cloud.turrets) {
    const double above = std::max(0.0, z - turret.top);
    depth = std::max(depth, turret.radius - std::sqrt((x - turret.x) * (x - turret.x) +
                                                      (y - turret.y) * (y - turret.y) + above * above));
  }
  return depth;
}

/// Depth below the surface of the clouds in units of the width of their edge, -infinity far away.
DenseField depth_field(const MakerGrid& grid, int base, const std::vector<Cumulus>& clouds,
                       const Turbulence& turbulence) {
  DenseField depth(grid.cells(), -std::numeric_limits<double>::infinity());
  for (const auto& cloud : clouds) {
    const double reach = 1.4 * cloud.radius;
    const double edge = 0.5 * std::max(grid.dx, grid.dy) + 0.15 * cloud.radius;
    for (int k = base; k < grid.nz; ++k) {
      const double z = (k - base + 0.5) * grid.dz;
      if (z > cloud.height + 0.5 * cloud.radius) break;
      for (int j = 0; j < grid.ny; ++j) {
        const double y = periodic_distance(cloud.y, (j + 0.5) * grid.dy, grid.width_y());
        if (std::abs(y) > reach) continue;
        for (int i = 0; i < grid.nx; ++i) {
          const double x = periodic_distance(cloud.x, (i + 0.5) * grid.dx, grid.width_x());
          if (std::abs(x) > reach) continue;
          const double billows = turbulence.billows((i + 0.5) * grid.dx, (j + 0.5) * grid.dy, z, cloud.radius);
          auto& deepest = depth[grid.index(i, j, k)];
          deepest = std::max(deepest, (depth_inside(cloud, x, y, z) + billows) / edge);
        }
      }
    }
  }
  return depth;
}

}  // namespace

DenseField make_cumulus(const MakerGrid& grid, int base, double cover, std::uint64_t seed) {
  const auto clouds = populate(grid, (grid.nz - base) * grid.dz, cover, seed);
  const Turbulence turbulence(grid, clouds.front().radius, seed);
  DenseField field = depth_field(grid, base, clouds, turbulence);

  std::vector<double> deepest(grid.columns(), -std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < field.size(); ++n)
    deepest[n % deepest.size()] = std::max(deepest[n % deepest.size()], field[n]);
  const double surface = value_exceeded_by(cover, deepest);

  for (int k = 0; k < grid.nz; ++k) {
    const double z = (k - base + 0.5) * grid.dz;
    const double liquid_water =
        undiluted_fraction * moist_adiabatic_liquid_water_gradient * z / (1 + z / dilution_height_m);
    for (int j = 0; j < grid.ny; ++j) {
      for (int i = 0; i < grid.nx; ++i) {
        double& value = field[grid.index(i, j, k)];
        const double depth = std::min(1.0, value - surface);
        if (!(depth > 0)) {
          value = 0;
          continue;
        }
        // Dry air mixed in at the edge removes droplets and leaves the others as they are: extinction falls with their
        // number.
        const double share = 0.01 + 0.99 * depth * depth * (3 - 2 * depth);
        value = share * droplet_extinction(liquid_water) *
                std::exp(0.35 * turbulence.fluctuation((i + 0.5) * grid.dx, (j + 0.5) * grid.dy, z));
      }
    }
  }
  return field;
}

}  // namespace cloudbow
