// Truth: the kinds of files that the system has, each made here. A reader that waited would end by the test's timeout.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <iterator>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class InputFile : public TemporaryFolder {
 protected:
  std::string message_of(const fs::path& file, std::uintmax_t most_bytes = 0) {
    try {
      open_input(file, "a poem", most_bytes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(InputFile, ARegularFileIsRead) {
  std::ofstream(folder_ / "file") << "text\n";
  fs::create_symlink("file", folder_ / "link");
  for (const char* name : {"file", "link"}) {
    EXPECT_EQ(unreadable_reason(folder_ / name), "");
    std::ifstream stream = open_input(folder_ / name, "a poem", 5);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "text\n");
  }
}

TEST_F(InputFile, OtherKindsAreRefusedAtOnce) {
  mkfifo((folder_ / "pipe").c_str(), 0600);
  fs::create_symlink("pipe", folder_ / "to_pipe");
  fs::create_symlink("nowhere", folder_ / "to_nothing");
  const int descriptor = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, (folder_ / "socket").c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  for (const auto& [file, kind] :
       std::vector<std::pair<fs::path, std::string>>{{folder_ / "none", "no such file"},
                                                     {folder_ / "to_nothing", "no such file"},
                                                     {folder_ / "none" / "none", "no such file"},
                                                     {"", "no such file"},
                                                     {folder_, "a directory"},
                                                     {folder_ / "pipe", "a named pipe"},
                                                     {folder_ / "to_pipe", "a named pipe"},
                                                     {folder_ / "socket", "a socket"},
                                                     {"/dev/null", "a device"}}) {
    EXPECT_EQ(message_of(file), file.string() + ": can't be read (found " + kind + ", allowed a poem)");
  }
  close(descriptor);
}

TEST_F(InputFile, PermissionsAreTold) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  std::ofstream(folder_ / "file") << "text";
  fs::permissions(folder_ / "file", fs::perms::none);
  EXPECT_THAT(message_of(folder_ / "file"), HasSubstr("Permission denied"));
}

TEST_F(InputFile, ALargerFileIsRefused) {
  std::ofstream(folder_ / "file") << std::string((1 << 20) + 1, ' ');
  EXPECT_THAT(message_of(folder_ / "file", 1 << 20), AllOf(HasSubstr("1048577 bytes"), HasSubstr("at most 1 MB")));
}

}  // namespace
}  // namespace cloudbow
