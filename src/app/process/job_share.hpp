// "I/N": one of the shares in which jobs of a batch system do the work of a command.
#pragma once

#include <cstddef>
#include <string>

namespace cloudbow {

/// Every `of`th piece of work.
struct JobShare {
  std::size_t number = 1;  ///< from 1
  std::size_t of = 1;

  bool has(std::size_t piece) const { return piece % of == number - 1; }
};

/// @param option that has this value, as messages name it.
/// @throws InputError if the text is not "I/N", or if I is not from 1 to N.
JobShare parse_job_share(const std::string& option, const std::string& text);

}  // namespace cloudbow
