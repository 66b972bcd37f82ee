#include "table_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace cloudbow {
namespace {

constexpr std::string_view magic = "cloudbow scattering table 1\n";

/// FNV-1a.
std::uint64_t hash(std::string_view text) {
  std::uint64_t h = 14695981039346656037u;
  for (const unsigned char c : text) h = (h ^ c) * 1099511628211u;
  return h;
}

void put(std::string& out, const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); }

void put_doubles(std::string& out, const auto& matrix) {
  put(out, static_cast<std::int64_t>(matrix.rows()));
  put(out, static_cast<std::int64_t>(matrix.cols()));
  out.append(reinterpret_cast<const char*>(matrix.data()), matrix.size() * sizeof(double));
}

/// Takes values off the front of a text; once anything is missing, all that follows is.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}
  bool good() const { return good_; }
  bool at_end() const { return good_ && rest_.empty(); }

  void get(auto& value) {
    if (const char* bytes = take(sizeof value)) std::memcpy(&value, bytes, sizeof value);
  }
  void get_doubles(auto& matrix) {
    std::int64_t rows = 0, cols = 0;
    get(rows);
    get(cols);
    constexpr std::int64_t most = 1 << 20;
    good_ = good_ && rows >= 0 && cols >= 0 && rows <= most && cols <= most;
    const char* bytes = good_ ? take(static_cast<std::size_t>(rows * cols) * sizeof(double)) : nullptr;
    if (!bytes) return;
    matrix.resize(rows, cols);
    if (matrix.size() > 0) std::memcpy(matrix.data(), bytes, matrix.size() * sizeof(double));
  }

 private:
  const char* take(std::size_t count) {
    good_ = good_ && count <= rest_.size();
    if (!good_) return nullptr;
    const char* bytes = rest_.data();
    rest_.remove_prefix(count);
    return bytes;
  }
  std::string_view rest_;
  bool good_ = true;
};

}  // namespace

TableCache::TableCache(std::filesystem::path directory, std::string key)
    : file_(std::move(directory) / fmt::format("scattering-{:016x}.table", hash(key))), key_(std::move(key)) {}

std::optional<FittedValues> TableCache::load() const {
  std::ifstream in(file_, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return std::nullopt;

  // magic, key, body, hash of all before it
  const std::string head = std::string(magic) + key_ + '\n';
  if (text.size() < head.size() + sizeof(std::uint64_t) || !text.starts_with(head)) return std::nullopt;
  const std::string_view hashed = std::string_view(text).substr(0, text.size() - sizeof(std::uint64_t));
  std::uint64_t written = 0;
  std::memcpy(&written, text.data() + hashed.size(), sizeof written);
  if (written != hash(hashed)) return std::nullopt;

  FittedValues values;
  Reader reader(hashed.substr(head.size()));
  reader.get_doubles(values.points_from_ordinates);
  reader.get_doubles(values.points_from_beam);
  reader.get(values.report.linear_programmes);
  reader.get(values.report.fallbacks);
  reader.get(values.report.least_value);
  reader.get(values.report.max_error);
  if (!reader.at_end()) return std::nullopt;
  return values;
}

void TableCache::store(const FittedValues& values) const {
  std::string text = std::string(magic) + key_ + '\n';
  put_doubles(text, values.points_from_ordinates);
  put_doubles(text, values.points_from_beam);
  put(text, values.report.linear_programmes);
  put(text, values.report.fallbacks);
  put(text, values.report.least_value);
  put(text, values.report.max_error);
  put(text, hash(text));

  std::error_code failure;
  std::filesystem::create_directories(file_.parent_path(), failure);
  static std::atomic<int> count = 0;
  std::filesystem::path temporary = file_;
  temporary += fmt::format(".{}.{}", ::getpid(), count++);
  bool written = false;
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    written = !out.fail();
  }
  if (written) std::filesystem::rename(temporary, file_, failure);
  if (!written || failure) std::filesystem::remove(temporary, failure);
}

}  // namespace cloudbow
