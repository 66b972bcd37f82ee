// Writes a small VDB file with one fault, for check_input_errors.py. usage: faulty_vdb FAULT OUT.vdb, with a FAULT of
// faulty()
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
  if (fault == "mask") {
    auto grid = make_grid<openvdb::MaskGrid>();
    grid->fill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), true);
    return grid;
  }
  auto grid = make_grid<openvdb::FloatGrid>();
  if (fault == "background" || fault == "nan_background") {
    grid = openvdb::FloatGrid::create(fault == "background" ? 0.001f : std::numeric_limits<float>::quiet_NaN());
    grid->setName("density");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(50.0));
  }
  if (fault == "empty") return grid;
  for (int i = 0; i < 8; ++i) grid->tree().setValue({i, i % 3, 2}, 0.01f);
  if (fault == "nan") grid->tree().setValue({3, 0, 2}, std::numeric_limits<float>::quiet_NaN());
  if (fault == "infinite") grid->tree().setValue({3, 0, 2}, std::numeric_limits<float>::infinity());
  if (fault == "negative") grid->tree().setValue({3, 0, 2}, -0.01f);
  if (fault == "level_set") grid->setGridClass(openvdb::GRID_LEVEL_SET);
  if (fault == "water") grid->insertMeta("quantity", openvdb::StringMetadata("liquid_water_content"));
  if (fault == "per_km") grid->insertMeta("units", openvdb::StringMetadata("km^-1"));
  if (fault == "named") grid->setName("den\x1b[2Jsity");
  if (fault == "sheared") {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(
        openvdb::Mat4d(50.0, 0.0, 0.0, 0.0, 0.0, 50.0, 0.0, 0.0, 9.0, 0.0, 50.0, 0.0, 0.0, 0.0, 0.0, 1.0)));
  }
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
    std::cerr << "usage: faulty_vdb FAULT OUT.vdb\n";
    return 2;
  }
  try {
    openvdb::initialize();
    std::ofstream file(argv[2], std::ios::binary);
    openvdb::GridCPtrVec grids{faulty(argv[1])};
    if (std::string(argv[1]) == "twins") grids.push_back(grids.front()->deepCopyGrid());
    openvdb::io::Stream(file).write(grids);
    return file.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
