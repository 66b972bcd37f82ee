#include "app/process/history.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

namespace cloudbow {

std::string history_line(const std::string& command) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())), command);
}

}  // namespace cloudbow
