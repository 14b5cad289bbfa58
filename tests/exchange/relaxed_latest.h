/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For races.sh: included before latest_value.h it replaces the memory orders of both exchanges by PUBLISH_ORDER and
 * TAKE_ORDER. An order must be a constant, hence two calls.
 */
#ifndef DPT_TESTS_RELAXED_LATEST_H
#define DPT_TESTS_RELAXED_LATEST_H

#define __atomic_exchange_n(word, value, order)                                                                        \
    (__builtin_strcmp(__func__, "latest_value_publish") == 0 ? __atomic_exchange_n(word, value, PUBLISH_ORDER)         \
                                                             : __atomic_exchange_n(word, value, TAKE_ORDER))

#endif
