#include "fuzz_input.hpp"

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "cloudbow/core/error.hpp"

namespace cloudbow::fuzz {
namespace {

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "cloudbow_fuzz_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Tally {
  long accepted = 0, refused = 0, ended_in_a_child = 0;

  ~Tally() {
    std::fprintf(stderr, "readings: %ld accepted, %ld refused, %ld of them because a child ended\n", accepted, refused,
                 ended_in_a_child);
  }
};

/// After the file's name, with no byte of the mutant.
bool tells_of_a_child(std::string_view message) {
  message.remove_prefix(std::min(message.find(": "), message.size()));
  for (const char* library : {"HDF5", "libpng", "netCDF", "OpenVDB"}) {
    if (message.starts_with(std::string(": the file is damaged (") + library)) return true;
  }
  return false;
}

/// Children inherit this limit: on a file as small as a mutant a second shows as well as five that a library spins.
/// This process goes on beyond it, and the kernel then raises it, so it is set before each reading.
void limit_children() {
  signal(SIGXCPU, SIG_IGN);
  rlimit limit{};
  if (getrlimit(RLIMIT_CPU, &limit) != 0) std::abort();
  limit.rlim_cur = 1;
  if (setrlimit(RLIMIT_CPU, &limit) != 0) std::abort();
}

}  // namespace

const std::filesystem::path& folder() {
  static const Folder made;
  return made.path();
}

std::filesystem::path write_mutant(std::span<const std::uint8_t> bytes, const std::string& name) {
  std::filesystem::path path = folder() / name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

void expect_clean(const std::function<void()>& read) {
  static Tally tally;
  try {
    limit_children();
    read();
    ++tally.accepted;
  } catch (const InputError& error) {
    if (error.what()[0] == '\0') std::abort();
    ++tally.refused;
    if (tells_of_a_child(error.what())) ++tally.ended_in_a_child;
  }
}

}  // namespace cloudbow::fuzz
