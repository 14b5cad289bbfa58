/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dynpoint: let a line-shaped tool feel triangle meshes in a haptic loop.
 *
 * The core, libdynpoint. It never allocates, prints, waits, locks or reads a clock, and it keeps no global state: the
 * caller supplies every block of memory. The offline compiler has a header of its own, <dynpoint/compile.h>.
 */
#ifndef DYNPOINT_H
#define DYNPOINT_H

#include "dynpoint/arm.h"
#include "dynpoint/base.h"
#include "dynpoint/body.h"
#include "dynpoint/contact.h"
#include "dynpoint/coupling.h"
#include "dynpoint/exchange.h"
#include "dynpoint/guard.h"
#include "dynpoint/hull.h"
#include "dynpoint/insertion.h"
#include "dynpoint/kernel.h"
#include "dynpoint/mesh.h"
#include "dynpoint/passivity.h"
#include "dynpoint/query.h"
#include "dynpoint/record.h"
#include "dynpoint/result.h"
#include "dynpoint/snapshot.h"
#include "dynpoint/springs.h"
#include "dynpoint/strip.h"
#include "dynpoint/tip.h"
#include "dynpoint/tool.h"
#include "dynpoint/types.h"
#include "dynpoint/world.h"

#endif
