// The rows behind refractive_index(): wavelength [um], n, k.
#pragma once

#include <span>

namespace cloudbow {

struct IndexRow {
  double wavelength_um;
  double n;
  double k;
};

std::span<const IndexRow> water_index_rows();
std::span<const IndexRow> ice_index_rows();

}  // namespace cloudbow
