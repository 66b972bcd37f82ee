// thick_slabs: the solver of plane_parallel.hpp on Henyey-Greenstein slabs. Each line of stdin is a slab:
//   G OPTICAL_DEPTH SSA ALBEDO MU0 ...    asymmetry, of the slab; albedo of the Lambertian surface; cosines of suns
// and is answered by one line with two numbers per sun: reflectance, and the fraction of the incident flux that arrives
// at the bottom. The only argument, if there is one, is the number of angles per hemisphere.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "reference/plane_parallel.hpp"

int main(int argc, char** argv) {
  const int angles = argc > 1 ? std::stoi(argv[1]) : 48;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    double g = 0, optical_depth = 0, ssa = 0, albedo = 0;
    if (!(in >> g >> optical_depth >> ssa >> albedo)) {
      std::cerr << "thick_slabs: not a slab: " << line << '\n';
      return 2;
    }
    std::vector<double> suns;
    for (double mu0 = 0; in >> mu0;) suns.push_back(mu0);
    const auto fluxes = cloudbow::reference::plane_parallel_fluxes([g](int l) { return std::pow(g, l); }, suns,
                                                                   optical_depth, ssa, albedo, angles);
    std::cout << std::setprecision(17);
    for (const auto& [reflectance, transmittance] : fluxes) std::cout << reflectance << ' ' << transmittance << ' ';
    std::cout << std::endl;
  }
}
