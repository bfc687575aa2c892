// The program's version.
#pragma once

#ifndef LAPWING_VERSION
#define LAPWING_VERSION "0.1.0"
#endif
