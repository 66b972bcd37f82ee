// Truth: the file system afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <iterator>
#include <set>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class AtomicFileTest : public TemporaryFolder {
 protected:
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.insert(entry.path().filename());
    return found;
  }

  static std::string content(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  static mode_t mode_of(const fs::path& file) {
    struct stat found {};
    return stat(file.c_str(), &found) == 0 ? found.st_mode & 07777 : 0;
  }

  /// The temporary file of a process that ends without removing it, or waits until it is killed.
  pid_t leave_behind(const fs::path& target, bool alive) {
    const pid_t child = fork();
    if (child == 0) {
      const AtomicFile* const unfinished = new AtomicFile(target);
      std::ofstream(unfinished->temporary()) << "half";
      if (alive) pause();
      _exit(0);
    }
    if (!alive) waitpid(child, nullptr, 0);
    while (alive && names().empty()) usleep(1000);
    return child;
  }
};

TEST_F(AtomicFileTest, AnOlderFilesPermissionsAreKept) {
  const fs::path file = folder_ / "file";
  make("file");
  for (const mode_t mode : {0600, 0640, 0664, 0755}) {
    chmod(file.c_str(), mode);
    write_file_atomically(file, "new");
    EXPECT_EQ(mode_of(file), mode);
  }
  EXPECT_EQ(content(file), "new");
}

TEST_F(AtomicFileTest, WhatOthersMayNotReadTheyNeverMay) {
  const fs::path file = folder_ / "file";
  make("file");
  chmod(file.c_str(), 0600);
  const AtomicFile unfinished(file);
  EXPECT_EQ(mode_of(unfinished.temporary()), 0600U);
}

TEST_F(AtomicFileTest, ANewFileHasThePermissionsOfTheUser) {
  const mode_t before = umask(027);
  write_file_atomically(folder_ / "file", "new");
  umask(before);
  EXPECT_EQ(mode_of(folder_ / "file"), 0640U);
}

TEST_F(AtomicFileTest, ThroughALinkItsTargetIsWritten) {
  fs::create_directory(folder_ / "data");
  make("data/there");
  for (const char* name : {"there", "coming"}) {
    fs::create_symlink(fs::path("data") / name, folder_ / name);
    write_file_atomically(folder_ / name, "new");
    EXPECT_TRUE(fs::is_symlink(folder_ / name));
    EXPECT_FALSE(fs::is_symlink(folder_ / "data" / name));
    EXPECT_EQ(content(folder_ / "data" / name), "new");
  }
}

TEST_F(AtomicFileTest, LinksThatLeadNowhereAreRefused) {
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  fs::create_symlink("self", folder_ / "self");
  fs::create_symlink("a/file", folder_ / "below");
  fs::create_symlink("missing/file", folder_ / "dangling");
  for (const char* name : {"a", "b", "self", "below", "dangling"}) {
    EXPECT_THAT([&] { write_file_atomically(folder_ / name, "new"); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr("can't be written ("))))
        << name;
    EXPECT_THROW(check_target(folder_ / name), InputError) << name;
    EXPECT_TRUE(fs::is_symlink(folder_ / name)) << name;
  }
}

TEST_F(AtomicFileTest, ATargetIsCheckedWithoutAFile) {
  leave_behind(folder_ / "file", false);
  const auto before = names();
  check_target(folder_ / "file");
  EXPECT_EQ(names(), before);
  EXPECT_THROW(check_target(folder_), InputError);
  EXPECT_THROW(check_target(folder_ / "missing" / "file"), InputError);
}

TEST_F(AtomicFileTest, TheRemainsOfADeadProcessAreRemoved) {
  leave_behind(folder_ / "file", false);
  EXPECT_EQ(names().size(), 1U);
  write_file_atomically(folder_ / "other", "new");
  EXPECT_EQ(names().size(), 2U);
  write_file_atomically(folder_ / "file", "new");
  EXPECT_THAT(names(), ElementsAre("file", "other"));
}

TEST_F(AtomicFileTest, AProcessThatLivesKeepsItsFile) {
  const pid_t child = leave_behind(folder_ / "file", true);
  write_file_atomically(folder_ / "file", "new");
  EXPECT_EQ(names().size(), 2U);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  write_file_atomically(folder_ / "file", "new");
  EXPECT_THAT(names(), ElementsAre("file"));
}

TEST_F(AtomicFileTest, FilesOfOtherHostsStayADay) {
  const std::string of_other_host = ".file.01234567.999999999-0.tmp";
  make(of_other_host);
  write_file_atomically(folder_ / "file", "new");
  EXPECT_TRUE(fs::exists(folder_ / of_other_host));
  fs::last_write_time(folder_ / of_other_host, fs::file_time_type::clock::now() - std::chrono::hours(25));
  write_file_atomically(folder_ / "file", "new");
  EXPECT_FALSE(fs::exists(folder_ / of_other_host));
}

TEST_F(AtomicFileTest, NamesOfOthersStay) {
  for (const char* name : {".file.tmp", ".file.01234567.1.tmp", ".file.0123456.1-0.tmp", ".file.01234567.1-0.tmp2",
                           ".file.01234567.x-0.tmp", ".file.0123456g.1-0.tmp", "file.01234567.1-0.tmp"}) {
    make(name);
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(25));
  }
  const auto before = names();
  write_file_atomically(folder_ / "file", "new");
  EXPECT_EQ(names().size(), before.size() + 1);
}

TEST_F(AtomicFileTest, LongNamesHaveRoom) {
  const fs::path file = folder_ / std::string(255, 'n');
  write_file_atomically(file, "new");
  EXPECT_EQ(content(file), "new");
}

}  // namespace
}  // namespace cloudbow
