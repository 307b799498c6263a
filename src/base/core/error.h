// sightline::Error, which is part of the public interface: library users catch it.
#pragma once

#include "sightline/error.h"
