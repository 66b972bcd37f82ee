// Errors that end as one message to the user.
#pragma once

#include <stdexcept>
#include <string>

namespace cloudbow {

/// The user's input or usage is wrong: the program prints what() on one line and exits with code 2.
/// The message reads "location: problem (what was found, what is allowed) suggestion".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace cloudbow
