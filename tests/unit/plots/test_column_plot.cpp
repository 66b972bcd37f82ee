// Pictures of what a cloud holds. Truth: a PNG for a map and for a single row, or an error that names the file.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/column_plot.hpp"

namespace cloudbow {
namespace {

ColumnPlot plot_of(int nx, int ny) {
  ColumnPlot plot;
  plot.title = "cloud.vdb";
  plot.columns = {nx, ny};
  plot.column_size_m = {50, 40};
  for (int n = 0; n < nx * ny; ++n) plot.value.push_back(.1 * n);
  return plot;
}

TEST(ColumnPlot, IsAPngOfAMapAndOfARow) {
  const TemporaryFolder folder;
  for (const auto& [nx, ny] : {std::pair(4, 3), std::pair(5, 1), std::pair(1, 6)}) {
    write_column_plot(folder / "a.png", plot_of(nx, ny));
    std::ifstream file(folder / "a.png", std::ios::binary);
    std::string head(8, ' ');
    file.read(head.data(), 8);
    EXPECT_EQ(head, "\x89PNG\r\n\x1a\n") << nx << ' ' << ny;
  }
}

TEST(ColumnPlot, OfAnEmptyCloudIsAPngToo) {
  const TemporaryFolder folder;
  ColumnPlot plot = plot_of(2, 2);
  plot.value.assign(4, 0.);
  EXPECT_NO_THROW(write_column_plot(folder / "a.png", plot));
}

TEST(ColumnPlot, ThatCannotBeWrittenIsAnInputError) {
  EXPECT_THROW(write_column_plot("/nowhere/a.png", plot_of(2, 2)), InputError);
}

}  // namespace
}  // namespace cloudbow
