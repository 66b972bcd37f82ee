#include "app/process/job_share.hpp"

#include <fmt/format.h>

#include <charconv>

#include "cloudbow/core/error.hpp"

namespace cloudbow {

JobShare parse_job_share(const std::string& option, const std::string& text) {
  JobShare share;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, share.number);
  const bool has_slash = number.ec == std::errc() && number.ptr != end && *number.ptr == '/';
  const auto of = has_slash ? std::from_chars(number.ptr + 1, end, share.of) : number;
  if (!has_slash || of.ec != std::errc() || of.ptr != end || share.number < 1 || share.number > share.of)
    throw InputError(fmt::format("{}: found '{}', allowed I/N with I from 1 to N, as in 3/8", option, text));
  return share;
}

}  // namespace cloudbow
