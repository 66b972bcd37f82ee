#include "cloudbow/medium/emission.hpp"
