// A scene whose source is given, for tests of the final gather.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "transport/gather/gather.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {

inline constexpr std::array<double, 1> untruncated{0.};

// A scene whose scattered source at every control point is the cell's `source`.
struct SourceScene {
  BoxGrid box;
  Cells<double> cells;
  DirectionalSource<double> source;
  GroundRadiance<double> ground;
  GatherScene<double> gather;

  SourceScene(const BoxGrid& given, const std::vector<float>& extinction, const std::vector<double>& value, double sky,
              double surface)
      : box(given),
        cells(make_cells<double>(make_grid(box, extinction, 1.), untruncated, false)),
        source{ControlPoints(12), AngularField<double>(12, cells.size()), -Direction::UnitZ(), {}},
        ground{{}, AngularField<double>(1, box.columns()), {}},
        gather{box, cells, &source, {}, sky, &ground} {
    std::fill_n(ground.at_points.row(0), box.columns(), surface);
    const auto dense = dense_indices(cells.rows);
    for (int m = 0; m < 12; ++m) {
      for (std::size_t c = 0; c < cells.size(); ++c) source.at_points.row(m)[c] = value[dense[c]];
    }
  }
  SourceScene(const SourceScene&) = delete;
  SourceScene& operator=(const SourceScene&) = delete;
};

// Boxes of some hundred cells: threads would only wait for each other.
class GatherFlux : public testing::Test {
 protected:
  GatherFlux() { omp_set_num_threads(1); }
  ~GatherFlux() override { omp_set_num_threads(threads_); }

 private:
  int threads_ = omp_get_max_threads();
};

inline BoxGrid unequal_box(bool periodic) {
  BoxGrid box = make_box(8, 6, 0, periodic);
  box.dx_m = 30;
  box.dy_m = 20;
  box.z_edge_m = {0, 10, 35, 36, 80, 120, 150};
  return box;
}

inline double mean(const std::vector<double>& field) {
  return std::accumulate(field.begin(), field.end(), 0.) / static_cast<double>(field.size());
}

inline constexpr std::array inner_edges{1, 2, 3, 4, 5};

}  // namespace cloudbow
