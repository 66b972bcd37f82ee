// The folder that tests of imports write their files to.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "cloudbow/medium/cloud_import.hpp"

namespace cloudbow {

/// A folder of one test, gone with it.
class CloudImport : public testing::Test {
 protected:
  CloudImport() {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("cloudbow-import-") + testing::UnitTest::GetInstance()->current_test_info()->name() + "-" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~CloudImport() override {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static CloudImportOptions options_for(const std::filesystem::path& file) {
    CloudImportOptions options;
    options.file = file;
    return options;
  }

  std::filesystem::path folder_;
};

}  // namespace cloudbow
