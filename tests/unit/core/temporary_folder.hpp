// A folder of the test's own, gone with everything in it.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace cloudbow {

class TemporaryFolder : public testing::Test {
 protected:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = std::filesystem::canonical(name);
  }
  ~TemporaryFolder() override { std::filesystem::remove_all(folder_); }

  void make(const std::string& name) { std::ofstream(folder_ / name) << name; }

  std::filesystem::path folder_;
};

}  // namespace cloudbow
