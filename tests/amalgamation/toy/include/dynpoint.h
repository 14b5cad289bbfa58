/* SPDX-License-Identifier: BSD-3-Clause */
/* A library that is all collisions: what tools/packaging/amalgamate.py has to keep apart (tests/amalgamation.sh). */
#ifndef DYNPOINT_H
#define DYNPOINT_H

#include "dynpoint/base.h"

#endif
