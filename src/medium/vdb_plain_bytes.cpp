#include "vdb_plain_bytes.hpp"

#include <bit>
#include <limits>
#include <system_error>

#include "cloudbow/core/input_file.hpp"

namespace cloudbow {

PlainBytes::PlainBytes(const std::filesystem::path& path) {
  static_assert(std::endian::native == std::endian::little, "VDB files are read as they are");
  require_plain(unreadable_reason(path).empty());
  require_plain(file_.open(path, std::ios::in | std::ios::binary) != nullptr);
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  require_plain(!error && size_ <= static_cast<std::uint64_t>(std::numeric_limits<std::streamoff>::max()));
}

void PlainBytes::read(std::span<std::byte> target) {
  require_plain(target.size() <= left());
  const auto bytes = static_cast<std::streamsize>(target.size());
  require_plain(file_.sgetn(reinterpret_cast<char*>(target.data()), bytes) == bytes);
  position_ += target.size();
}

bool PlainBytes::flag() {
  const auto byte = number<std::uint8_t>();
  require_plain(byte <= 1);
  return byte == 1;
}

std::string PlainBytes::text(std::uint64_t bytes) {
  require_plain(bytes <= left());
  std::string text(bytes, '\0');
  read(std::as_writable_bytes(std::span(text.data(), text.size())));
  return text;
}

void PlainBytes::move_to(std::uint64_t position) {
  if (position == position_) return;
  require_plain(position <= size_);
  const auto offset = static_cast<std::streamoff>(position);
  require_plain(file_.pubseekoff(offset, std::ios::beg, std::ios::in) == std::streampos(offset));
  position_ = position;
}

}  // namespace cloudbow
