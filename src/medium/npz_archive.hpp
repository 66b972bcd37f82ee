// NumPy's archives of arrays (.npz): ZIP files of .npy files, stored or deflated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

class NpzArchive {
 public:
  /// Reads the list of members. @throws InputError if the file is no such archive, or damaged
  explicit NpzArchive(const std::filesystem::path& file);

  /// Names of the arrays, without ".npy".
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const;
  /// The .npy file of an array. @throws InputError if it is damaged
  std::string content(const std::string& name) const;

 private:
  struct Member {
    int method;
    std::uint32_t checksum;
    std::uint64_t stored_bytes, bytes, header_at;
  };

  void read_directory();
  std::string bytes_at(std::uint64_t begin, std::uint64_t count) const;

  std::filesystem::path file_;
  std::uint64_t file_bytes_;
  std::vector<std::string> names_;
  std::vector<Member> members_;  // in the order of the names
};

}  // namespace cloudbow
