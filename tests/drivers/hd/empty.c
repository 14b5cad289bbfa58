/* SPDX-License-Identifier: BSD-3-Clause */
/* A library that has nothing of libHD's. */
__attribute__((visibility("default"))) const char *const stand_in_is_empty = "";
