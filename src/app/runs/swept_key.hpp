// Keys of a scene with lists of values, as `cloudbow sweep --set` takes them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// A key and its values.
struct SweptKey {
  std::string key;                  ///< dotted
  std::vector<std::string> values;  ///< each as --set of a single run takes it
  bool is_list = false;             ///< a list or range was given, or several values: the key is a dimension
};

/// Reads "KEY=LIST": values between commas. A value is a number, a text (in quotes or not) or a TOML array. A range
/// FIRST:LAST:STEP stands for its numbers. LAST belongs to the range if steps reach it. Numbers of a range have the
/// decimals of FIRST and STEP. One value that is no range is no list.
/// @throws InputError if a value is empty or repeated, or a range makes no sense or is too long. Also if a quote or
/// bracket has no partner.
SweptKey parse_swept_key(const std::string& assignment);

/// @throws InputError if there is no value, too many, or one twice.
void check_values(const SweptKey& swept);

/// Values as a coordinate has them: numbers if all are, else texts.
struct CoordinateValues {
  std::vector<double> numbers;
  std::vector<std::string> texts;
};
CoordinateValues coordinate_values(const SweptKey& key);

/// Name of each key's dimension: its last part. If that is ambiguous or a name of results, the whole key with _ in
/// place of dots; all of them differ.
std::vector<std::string> dimension_names(std::span<const SweptKey> keys);

/// Units of a key by its ending ("_deg": "degree"), "1" if it has none that is known.
std::string units_of_key(const std::string& key);

}  // namespace cloudbow
