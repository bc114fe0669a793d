#include "robotteamsim/plan/types.hpp"
