// The folder of the tests of droplet tables.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"

namespace cloudbow {

class DropletTableFile : public testing::Test {
 protected:
  DropletTableFile() {
    folder_ = std::filesystem::temp_directory_path() / ("cloudbow-droplets-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~DropletTableFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write_text(const std::string& text) const {
    std::ofstream(folder_ / "table.txt") << text;
    return folder_ / "table.txt";
  }

  static std::string message(const std::filesystem::path& file, std::optional<double> wavelength = std::nullopt) {
    try {
      read_droplet_table(file, wavelength);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

inline DropletTable small_table() {
  return {0.67, {6, 12}, {0.27, 0.13}, {1 - 1e-12, 0.75}, {{1, 0.25, 0.01}, {1, 0.25, 0.125, 0.003}}};
}

inline DropletTableInfo some_info() {
  return {{1.331, 2e-8}, "somewhere", 1, "gamma", 0.1, "cloudbow", "cloudbow mie"};
}

}  // namespace cloudbow
