#include "cloudbow/core/error.hpp"
