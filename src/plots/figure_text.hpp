// Texts of figures: markup of plain texts and of units.
#pragma once

#include <string>
#include <string_view>

namespace cloudbow {

/// Text that shows these characters: marks of the markup are escaped; line ends are spaces; other control
/// characters and bytes that are no UTF-8 become \xNN.
std::string plain_text(std::string_view text);

/// A unit of udunits as it is printed: "W m-2" with a raised exponent and a true minus sign, "um" with a mu, "degree"
/// as its sign. Empty for "1".
std::string unit_text(std::string_view unit);

/// "name [unit]", or the name alone if there is no unit. @param factor power of ten by which the numbers beside it are
/// multiplied: 3 stands for thousands
std::string labelled_with_unit(std::string_view name, std::string_view unit, int factor = 0);

/// 10 to a power, raised.
std::string power_of_ten(int exponent);

/// A number with a true minus sign. @param decimals digits after the point
std::string number_text(double value, int decimals);

}  // namespace cloudbow
