#include "cloudbow/core/available_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

namespace cloudbow {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// Bytes of a line "Name: n kB" of /proc/meminfo or /proc/self/status.
std::optional<std::uint64_t> kibibytes_of(const fs::path& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    std::uint64_t kibibytes = 0;
    if (words >> word >> kibibytes && word == name + ":") return 1024 * kibibytes;
  }
  return std::nullopt;
}

/// The number in a control group's file; "max" and files that are not there are no limit.
std::uint64_t limit_in(const fs::path& file) {
  std::uint64_t bytes = 0;
  std::ifstream in(file);
  return in >> bytes ? bytes : unlimited;
}

/// The least limit of a group and of those above it. Within a container the kernel may name the group by a path of the
/// host that is not there: those above it are.
std::uint64_t least_limit(const fs::path& hierarchy, const std::string& group, const char* file) {
  std::uint64_t least = unlimited;
  for (fs::path at = fs::path(group).relative_path();; at = at.parent_path()) {
    least = std::min(least, limit_in(hierarchy / at / file));
    if (at.empty()) return least;
  }
}

/// By /proc/self/cgroup, whose lines are "number:controllers:group"; version 2 names no controllers.
std::uint64_t control_group_limit(const fs::path& root) {
  const fs::path mounts = root / "sys/fs/cgroup";
  std::uint64_t least = unlimited;
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':');
    const auto second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") {
      for (const char* mount : {"", "unified"})
        least = std::min(least, least_limit(mounts / mount, group, "memory.max"));
    } else if (controllers.find(",memory,") != std::string::npos) {
      least = std::min(least, least_limit(mounts / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

/// Bytes that a limit on addresses or data allows in all: those not yet `reserved`, and the `held` ones in memory.
std::uint64_t under_limit(const rlimit& limit, std::uint64_t reserved, std::uint64_t held) {
  if (limit.rlim_cur == RLIM_INFINITY) return unlimited;
  return (limit.rlim_cur > reserved ? limit.rlim_cur - reserved : 0) + held;
}

}  // namespace

std::uint64_t available_memory_bytes(const fs::path& root) {
  const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
  const std::uint64_t machine = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const fs::path status = root / "proc/self/status";
  const std::uint64_t held = kibibytes_of(status, "VmRSS").value_or(0);
  const std::uint64_t addresses = kibibytes_of(status, "VmSize").value_or(held);
  const std::uint64_t data = kibibytes_of(status, "VmData").value_or(held);
  rlimit of_addresses{RLIM_INFINITY, RLIM_INFINITY}, of_data{RLIM_INFINITY, RLIM_INFINITY};
  getrlimit(RLIMIT_AS, &of_addresses);
  getrlimit(RLIMIT_DATA, &of_data);
  const auto available = kibibytes_of(root / "proc/meminfo", "MemAvailable");
  return std::min({machine, kibibytes_of(root / "proc/meminfo", "MemTotal").value_or(machine),
                   available ? *available + held : unlimited, control_group_limit(root),
                   under_limit(of_addresses, addresses, held), under_limit(of_data, data, held)});
}

}  // namespace cloudbow
