// Writes a small VDB file with one fault, for check_input_errors.py. usage: faulty_vdb
// nan|infinite|negative|rotated|empty|double OUT.vdb
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>

namespace {

template <class Grid>
typename Grid::Ptr make_grid() {
  auto grid = Grid::create();
  grid->setName("density");
  grid->setTransform(openvdb::math::Transform::createLinearTransform(50.0));
  return grid;
}

openvdb::GridBase::Ptr faulty(const std::string& fault) {
  if (fault == "double") {
    auto grid = make_grid<openvdb::DoubleGrid>();
    grid->fill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), 0.01);
    return grid;
  }
  auto grid = make_grid<openvdb::FloatGrid>();
  if (fault == "empty") return grid;
  for (int i = 0; i < 8; ++i) grid->tree().setValue({i, i % 3, 2}, 0.01f);
  if (fault == "nan") grid->tree().setValue({3, 0, 2}, std::numeric_limits<float>::quiet_NaN());
  if (fault == "infinite") grid->tree().setValue({3, 0, 2}, std::numeric_limits<float>::infinity());
  if (fault == "negative") grid->tree().setValue({3, 0, 2}, -0.01f);
  if (fault == "rotated") {
    auto transform = openvdb::math::Transform::createLinearTransform(50.0);
    transform->preRotate(0.3, openvdb::math::Z_AXIS);
    grid->setTransform(transform);
  }
  return grid;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: faulty_vdb nan|infinite|negative|rotated|empty|double OUT.vdb\n";
    return 2;
  }
  try {
    openvdb::initialize();
    std::ofstream file(argv[2], std::ios::binary);
    openvdb::io::Stream(file).write(openvdb::GridCPtrVec{faulty(argv[1])});
    return file.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
