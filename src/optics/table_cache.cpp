#include "table_cache.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>
#include <vector>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/digest.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"

namespace cloudbow {
namespace {

constexpr std::string_view magic = "cloudbow scattering table 4\n";
constexpr std::string_view name_begin = "scattering-", name_end = ".table";

std::uint64_t digest_of(std::string_view text) {
  Digest digest;
  digest.add_bytes(text.data(), text.size());
  return digest.value();
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

void bound_cache(const std::filesystem::path& directory, std::uintmax_t most_bytes) {
  struct Table {
    std::filesystem::file_time_type used;
    std::uintmax_t bytes;
    std::filesystem::path path;
  };
  std::vector<Table> tables;
  std::uintmax_t bytes = 0;
  std::error_code failure;
  for (std::filesystem::directory_iterator entry(directory, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    std::error_code of_entry;
    if (!is_cached_table(entry->path()) || !std::filesystem::is_regular_file(entry->symlink_status(of_entry))) continue;
    const Table table{entry->last_write_time(of_entry), entry->file_size(of_entry), entry->path()};
    if (of_entry) continue;  // another run has just removed it
    bytes += table.bytes;
    tables.push_back(table);
  }
  std::sort(tables.begin(), tables.end(), [](const Table& a, const Table& b) { return a.used < b.used; });
  for (const Table& table : tables) {
    if (bytes <= most_bytes) return;
    if (std::filesystem::remove(table.path, failure)) bytes -= table.bytes;
  }
}

TableCache::TableCache(const std::filesystem::path& directory, std::string key) : key_(std::move(key)) {
  if (!directory.empty()) file_ = directory / fmt::format("{}{:016x}{}", name_begin, digest_of(key_), name_end);
}

std::optional<FittedColumns> TableCache::load() const {
  if (file_.empty() || !unreadable_reason(file_).empty()) return std::nullopt;
  std::ifstream in(file_, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return std::nullopt;

  // magic, key, body, digest of all before it
  const std::string head = std::string(magic) + key_ + '\n';
  if (text.size() < head.size() + sizeof(std::uint64_t) || !text.starts_with(head)) return std::nullopt;
  const std::string_view hashed = std::string_view(text).substr(0, text.size() - sizeof(std::uint64_t));
  std::uint64_t written = 0;
  std::memcpy(&written, text.data() + hashed.size(), sizeof written);
  if (written != digest_of(hashed)) return std::nullopt;

  FittedColumns columns;
  Reader reader(hashed.substr(head.size()));
  reader.get_doubles(columns.value);
  reader.get(columns.report.linear_programmes);
  reader.get(columns.report.fallbacks);
  reader.get(columns.report.least_value);
  reader.get(columns.report.max_error);
  if (!reader.at_end()) return std::nullopt;
  std::error_code no_write;  // then its time stays that of its making
  std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now(), no_write);
  return columns;
}

void TableCache::store(const FittedColumns& columns) const {
  if (file_.empty()) return;
  std::string text = std::string(magic) + key_ + '\n';
  put_doubles(text, columns.value);
  put(text, columns.report.linear_programmes);
  put(text, columns.report.fallbacks);
  put(text, columns.report.least_value);
  put(text, columns.report.max_error);
  put(text, digest_of(text));

  std::error_code failure;
  std::filesystem::create_directories(file_.parent_path(), failure);
  // A link may lead to a file of the user's.
  const auto older = std::filesystem::symlink_status(file_, failure);
  if (std::filesystem::exists(older) && !std::filesystem::is_regular_file(older)) return;
  try {
    write_file_atomically(file_, text);
    bound_cache(file_.parent_path(), most_cached_bytes);
  } catch (const InputError&) {  // the table is made again
  }
}

bool is_cached_table(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with(name_begin) && name.ends_with(name_end);
}

}  // namespace cloudbow
