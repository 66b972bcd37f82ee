// Truth: files made by the HDF5 library itself, each with one thing that leads out of the file.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <thread>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/hdf5_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr H5Z_filter_t foreign_filter = 300;

std::size_t same_bytes(unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*, void**) {
  return bytes;
}

class Hdf5File : public TemporaryFolder {
 protected:
  Hdf5File() {
    hdf5::start_library();
    const H5Z_class2_t foreign{H5Z_CLASS_T_VERS, foreign_filter, 1, 1, "made for this", nullptr, nullptr, same_bytes};
    H5Zregister(&foreign);
  }
  ~Hdf5File() override { H5Zunregister(foreign_filter); }

  void make_file(const std::function<void(hid_t)>& fill) const {
    const hid_t file = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    fill(file);
    EXPECT_GE(H5Fclose(file), 0);
  }

  static void make_dataset(
      hid_t group, const char* name, const std::function<void(hid_t)>& set = [](hid_t) {}) {
    const std::array<hsize_t, 1> shape{4};
    const hid_t space = H5Screate_simple(1, shape.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    set(properties);
    const hid_t dataset = H5Dcreate2(group, name, H5T_NATIVE_FLOAT, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    EXPECT_GE(dataset, 0);
    H5Dclose(dataset);
    H5Pclose(properties);
    H5Sclose(space);
  }

  std::string message_of() const {
    std::string message;
    try {
      hdf5::open_file(path_);
    } catch (const InputError& error) {
      message = error.what();
    }
    try {
      hdf5::check_file(path_);
      EXPECT_EQ(message, "");
    } catch (const InputError& error) {
      EXPECT_EQ(message, error.what());
    }
    return message;
  }

  void expect_refused(const std::string& what) const {
    EXPECT_THAT(message_of(), AllOf(HasSubstr(path_.string()), HasSubstr("leads elsewhere"), HasSubstr(what)));
  }

  std::filesystem::path path_ = folder_ / "file.h5";
};

TEST_F(Hdf5File, WhatHoldsItsDataIsOpened) {
  make_file([](hid_t file) {
    make_dataset(file, "plain");
    make_dataset(file, "compressed", [](hid_t properties) {
      const hsize_t chunk = 2;
      H5Pset_chunk(properties, 1, &chunk);
      H5Pset_shuffle(properties);
      H5Pset_deflate(properties, 1);
      H5Pset_fletcher32(properties);
    });
    H5Lcreate_soft("plain", file, "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(file, "plain", file, "hard", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(file, "/", group, "up", H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
  });
  EXPECT_EQ(message_of(), "");
}

TEST_F(Hdf5File, ALinkToAnotherFileIsRefusedWithoutFollowingIt) {
  mkfifo((folder_ / "pipe").c_str(), 0600);
  make_file([](hid_t file) {
    const hid_t group = H5Gcreate2(file, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("pipe", "/x", group, "away", H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
  });
  expect_refused("'group/away', a link to another file");
}

TEST_F(Hdf5File, NamesOfLinksDoNotReachTheTerminal) {
  make_file([](hid_t file) { H5Lcreate_external("x", "/x", file, "a\x1b[2Jb", H5P_DEFAULT, H5P_DEFAULT); });
  expect_refused("'a\\x1b[2Jb', a link to another file");
}

TEST_F(Hdf5File, AVirtualDatasetIsRefused) {
  make_file([](hid_t file) {
    make_dataset(file, "circle", [](hid_t properties) {
      const hsize_t length = 4;
      const hid_t space = H5Screate_simple(1, &length, nullptr);
      EXPECT_GE(H5Pset_virtual(properties, space, ".", "circle", space), 0);
      H5Sclose(space);
    });
  });
  expect_refused("'circle', a virtual dataset");
}

TEST_F(Hdf5File, ExternalStorageIsRefused) {
  make_file([](hid_t file) {
    make_dataset(file, "out", [](hid_t properties) { H5Pset_external(properties, "/dev/zero", 0, 16); });
  });
  expect_refused("'out', a dataset stored in other files");
}

TEST_F(Hdf5File, AFilterOfAPlugInIsRefused) {
  make_file([](hid_t file) {
    make_dataset(file, "odd", [](hid_t properties) {
      const hsize_t chunk = 2;
      H5Pset_chunk(properties, 1, &chunk);
      H5Pset_filter(properties, foreign_filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
    });
  });
  expect_refused("'odd', filter 300 of a plug-in (made for this)");
}

TEST_F(Hdf5File, ALinkOfAPlugInIsRefused) {
  const auto nowhere = [](const char*, hid_t, const void*, size_t, hid_t, hid_t) -> hid_t { return -1; };
  const H5L_class_t foreign{H5L_LINK_CLASS_T_VERS,
                            static_cast<H5L_type_t>(100),
                            "foreign",
                            nullptr,
                            nullptr,
                            nullptr,
                            nowhere,
                            nullptr,
                            nullptr};
  ASSERT_GE(H5Lregister(&foreign), 0);
  make_file([](hid_t file) {
    EXPECT_GE(H5Lcreate_ud(file, "odd", static_cast<H5L_type_t>(100), "", 0, H5P_DEFAULT, H5P_DEFAULT), 0);
  });
  H5Lunregister(static_cast<H5L_type_t>(100));
  expect_refused("'odd', a link of a plug-in");
}

TEST_F(Hdf5File, ALockedFileSaysSo) {
  make_file([](hid_t file) { make_dataset(file, "plain"); });
  const int descriptor = open(path_.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(descriptor, LOCK_EX), 0);
  EXPECT_THAT(message_of(), AllOf(HasSubstr(path_.string()), HasSubstr("is locked")));
  close(descriptor);
  EXPECT_EQ(message_of(), "");
}

TEST_F(Hdf5File, OtherFilesPassTheCheckForOtherLibraries) {
  std::ofstream(path_) << "CDF";
  hdf5::check_file(path_);
  EXPECT_THROW(hdf5::open_file(path_), hdf5::Error);
  EXPECT_THROW(hdf5::check_file(folder_), InputError);
}

TEST_F(Hdf5File, ErrorsAreNotPrintedInAnyThread) {
  make_file([](hid_t file) { make_dataset(file, "plain"); });
  std::filesystem::resize_file(path_, 100);
  testing::internal::CaptureStderr();
  for (int n = 0; n < 2; ++n) std::thread([this] { EXPECT_THROW(hdf5::open_file(path_), hdf5::Error); }).join();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Hdf5File, ADamagedFileIsRefused) {
  make_file([](hid_t file) { make_dataset(file, "plain"); });
  std::filesystem::resize_file(path_, 100);
  EXPECT_THROW(hdf5::open_file(path_), hdf5::Error);
  EXPECT_THROW(hdf5::check_file(path_), InputError);
}

}  // namespace
}  // namespace cloudbow
