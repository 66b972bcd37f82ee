// Archives of NumPy. Truth: the bytes that numpy.savez and savez_compressed write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

/// An archive of one stored array "lwc" of two numbers, 0.5 and 0.25, as numpy.savez writes it.
std::string small_archive() {
  const auto number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int n = 0; n < bytes; ++n) text += static_cast<char>(value >> (8 * n) & 255);
    return text;
  };
  std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }";
  head.resize(117, ' ');
  const std::string array =
      std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + std::string("\0\0\0\x3f\0\0\x80\x3e", 8);
  // CRC-32 of IEEE 802.3, bit by bit.
  std::uint32_t checksum = 0xffffffff;
  for (const char c : array) {
    checksum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) checksum = (checksum >> 1) ^ (checksum & 1 ? 0xedb88320 : 0);
  }
  const auto bytes = static_cast<std::uint32_t>(array.size());
  const std::string name = "lwc.npy", zeros(64, '\0');
  const std::string about =
      number(20, 2) + zeros.substr(0, 8) + number(~checksum, 4) + number(bytes, 4) + number(bytes, 4) + number(7, 2);
  const std::string member = "PK\x03\x04" + about + zeros.substr(0, 2) + name + array;
  const std::string directory = "PK\x01\x02" + number(20, 2) + about + zeros.substr(0, 16) + name;
  return member + directory + "PK\x05\x06" + zeros.substr(0, 4) + number(1, 2) + number(1, 2) +
         number(static_cast<std::uint32_t>(directory.size()), 4) +
         number(static_cast<std::uint32_t>(member.size()), 4) + zeros.substr(0, 2);
}

TEST_F(CloudImport, ArchivesOfNumpy) {
  const std::string archive = small_archive();
  CloudImportOptions options = options_for(write("a.npz", archive));
  options.voxel_size_m = {10, 20, 30};
  const CloudField found = import_cloud(options).field;
  EXPECT_EQ(found.quantity, "liquid_water_content");
  EXPECT_EQ(found.cells, (std::array<int, 3>{1, 1, 2}));
  EXPECT_THAT(found.value, testing::ElementsAre(0.5F, 0.25F));
  options.variable = "qc";
  EXPECT_THAT(message_of([&] { import_cloud(options); }),
              HasSubstr("no array 'qc' (as --variable says; arrays in the file: lwc)"));
  options.variable.clear();
  // Every shortened archive and every changed byte is refused, or changes nothing that counts.
  for (std::size_t n = 4; n < archive.size(); ++n) {
    options.file = write("cut.npz", archive.substr(0, n));
    EXPECT_NE(message_of([&] { import_cloud(options); }), "") << n;
    std::string changed = archive;
    changed[n] = static_cast<char>(changed[n] ^ 0x55);
    options.file = write("changed.npz", changed);
    try {
      EXPECT_THAT(import_cloud(options).field.value, testing::ElementsAre(0.5F, 0.25F)) << n;
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), HasSubstr("changed.npz")) << n;
    }
  }
}

}  // namespace
}  // namespace cloudbow
