// Truth: the kernel's own formats, proc(5) and cgroups(7), made in a folder.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "cloudbow/core/available_memory.hpp"

namespace cloudbow {
namespace {

// Less than any machine has that runs this.
constexpr std::uint64_t megabyte = 1000000;

class AvailableMemory : public testing::Test {
 protected:
  void SetUp() override {
    root_ = std::filesystem::temp_directory_path() / ("cloudbow-memory-" + std::to_string(getpid()));
    std::filesystem::remove_all(root_);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  std::uint64_t bytes() const { return available_memory_bytes(root_); }

  std::filesystem::path root_;
};

TEST_F(AvailableMemory, WithoutAnyFileIsThatOfTheMachine) {
  EXPECT_EQ(bytes(),
            static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
}

TEST_F(AvailableMemory, IsWhatTheSystemCallsAvailableAndWhatTheProcessHolds) {
  write("proc/meminfo", "MemTotal:  900000 b\nMemFree:  1000 b\nMemAvailable:   200000 b\n");
  EXPECT_EQ(bytes(), 200000U * 1024);
  write("proc/self/status", "Name:\tcloudbow\nVmSize:\t  90000 b\nVmRSS:\t  50000 b\nVmData:\t 60000 b\n");
  EXPECT_EQ(bytes(), 250000U * 1024);
  write("proc/meminfo", "MemTotal:  240000 b\nMemAvailable:   200000 b\n");
  EXPECT_EQ(bytes(), 240000U * 1024);
}

TEST_F(AvailableMemory, OfVersionTwoTheLeastOfTheGroupAndThoseAboveIt) {
  write("proc/self/cgroup", "0::/system.slice/job_7/step_0\n");
  write("sys/fs/cgroup/system.slice/job_7/step_0/memory.max", "max\n");
  EXPECT_GT(bytes(), 300 * megabyte);
  write("sys/fs/cgroup/system.slice/job_7/memory.max", "300000000\n");
  EXPECT_EQ(bytes(), 300 * megabyte);
  write("sys/fs/cgroup/system.slice/memory.max", "400000000\n");
  EXPECT_EQ(bytes(), 300 * megabyte);
  write("sys/fs/cgroup/memory.max", "200000000\n");
  EXPECT_EQ(bytes(), 200 * megabyte);
  write("sys/fs/cgroup/system.slice/job_7/step_0/memory.max", "100000000\n");
  EXPECT_EQ(bytes(), 100 * megabyte);
}

TEST_F(AvailableMemory, OfVersionOneByItsOwnPath) {
  write("proc/self/cgroup", "7:cpu,cpuacct:/elsewhere\n4:hugetlb,memory:/slurm/uid_1/job_7\n0::/\n");
  write("sys/fs/cgroup/memory/elsewhere/memory.limit_in_bytes", "100000000\n");
  write("sys/fs/cgroup/memory/slurm/uid_1/job_7/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_GT(bytes(), 300 * megabyte);
  write("sys/fs/cgroup/memory/slurm/uid_1/memory.limit_in_bytes", "300000000\n");
  EXPECT_EQ(bytes(), 300 * megabyte);
  write("sys/fs/cgroup/unified/memory.max", "200000000\n");  // both versions at once
  EXPECT_EQ(bytes(), 200 * megabyte);
}

TEST_F(AvailableMemory, InAContainerByItsRootWhereTheGroupIsNamedFromOutside) {
  write("proc/self/cgroup", "4:memory:/docker/0123abcd\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "300000000\n");
  EXPECT_EQ(bytes(), 300 * megabyte);
}

TEST_F(AvailableMemory, IsLessUnderLimitsOnAddressesAndData) {
  write("proc/self/status", "VmSize:\t90000 b\nVmRSS:\t50000 b\nVmData:\t70000 b\n");
  // In a child, whose limits end with it.
  const auto under = [&](auto resource, std::uint64_t limit) {
    const pid_t child = fork();
    if (child == 0) {
      const rlimit both{limit, limit};
      // Sanitizers reserve more addresses than any useful limit; setting this one removes no existing memory.
      const bool set = setrlimit(resource, &both) == 0;
      const std::uint64_t room = limit - 1024UL * (resource == RLIMIT_AS ? 90000 : 70000);
      _exit(set && available_memory_bytes(root_) == room + 50000UL * 1024 ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  };
#ifndef __SANITIZE_ADDRESS__
  EXPECT_EQ(under(RLIMIT_AS, 400 * megabyte), 0);
#endif
  EXPECT_EQ(under(RLIMIT_DATA, 500 * megabyte), 0);
}

}  // namespace
}  // namespace cloudbow
