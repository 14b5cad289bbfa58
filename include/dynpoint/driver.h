/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Drivers: what a kind of device has to do, for those who write one (docs/drivers.md, "Writing a driver"). A driver is a
 * struct of functions for one kind of device; a device is one that is open. Those that are built in are listed by
 * dpt_driver_at; one from outside is used through the same struct.
 *
 * Threads: `open` and `find` may be called from several threads at once; the rest as device.h says.
 */
#ifndef DYNPOINT_DRIVER_H
#define DYNPOINT_DRIVER_H

#include "dynpoint/device.h"

/*
 * Of the contract below. It grows only where a driver of before would be served wrongly: a library refuses drivers of a
 * version above its own, and serves older ones, but for 1, of release 0.1. What is merely added does not change it: a
 * function is optional then and stands behind those of before, where `size` tells whether a driver has it; a library
 * that is older than a driver does not call it.
 */
#define DPT_DRIVER_VERSION 2

DPT_BEGIN

typedef struct dpt_driver dpt_driver;

/* Called for each device that a driver finds, with what `open` takes as `where` and a line about it. */
typedef void dpt_device_found_fn(void *user, const dpt_driver *driver, const char *where,
                                 const char *about);

/*
 * The contract. A driver's own device begins with a struct dpt_device, which dpt_device_open fills in. Arguments are
 * checked before a driver sees them: none is NULL but those that are said to be, wrenches are finite. Structs to be
 * filled in are the library's own, of the size that their first field says, and with room for 1024 bytes: a driver
 * fills in those of its own headers, whole, be it older or newer, and the caller gets as much as it has room for. What
 * info and counts leave alone is 0, what read does stays as it was.
 *
 * open    May block, some seconds at most. `where` is in the driver's own notation, NULL for the first or only one;
 *         settings follow a '?', as in "/dev/ttyACM0?rate=1000". On success the device has answered, gives no force,
 *         and *device is set; on failure nothing stays open and the text of `error` says why. Its code is filled in.
 * info    Never blocks or fails.
 * read    Never blocks, makes a bounded number of system calls, allocates nothing. Fills `state` with the latest
 *         sample, also if that was read before (fresh = 0). DPT_E_LOST when the device is gone: status LOST, fresh 0,
 *         the pose the last one known.
 * write   Likewise. The wrench is of the device on the hand, at the tool's tip, in the device's frame. What the device
 *         cannot do is left out, what is too strong is scaled down. DPT_E_BUSY: there was no room, it is dropped, the
 *         next one counts. A device that is not ready takes none: DPT_E_NOT_READY, or DPT_E_LOST.
 * clear   May block, some seconds at most. Ends a fault whose cause is gone; opens a lost device again where it was,
 *         DPT_E_LOST while it is not there. Motors may be switched on; there is no force until the next write.
 * counts  Never blocks or fails.
 * close   May block, but not for ever. The device gives no force when it returns, or its watchdog ends it; also when it
 *         is lost. Frees it.
 * find    May block. NULL where devices cannot be found.
 */
struct dpt_driver {
    uint32_t size;     /* sizeof(dpt_driver), of the driver's headers */
    uint32_t version;  /* DPT_DRIVER_VERSION */
    const char *name;  /* a word: "sim", "serial" */
    const char *about; /* a line for people */
    dpt_result (*open)(const dpt_driver *driver, const char *where, dpt_device **device,
                       dpt_device_error *error);
    void (*info)(const dpt_device *device, dpt_device_info *info);
    dpt_result (*read)(dpt_device *device, dpt_device_state *state);
    dpt_result (*write)(dpt_device *device, const dpt_wrench *wrench);
    dpt_result (*clear)(dpt_device *device);
    void (*counts)(const dpt_device *device, dpt_device_counts *counts);
    void (*close)(dpt_device *device);
    void (*find)(const dpt_driver *driver, dpt_device_found_fn *found, void *user);
};

/* It never grows, as a driver's own fields follow. */
struct dpt_device {
    const dpt_driver *driver;
    void *reserved[3]; /* the library's */
};

/* The drivers that are built in, from 0; NULL behind the last one. */
DPT_API const dpt_driver *dpt_driver_at(uint32_t index);

/* By name; NULL when there is none. */
DPT_API const dpt_driver *dpt_driver_named(const char *name);

/*
 * As dpt_device_open, with a driver from anywhere; one of a version or size that is not served (above), or without a
 * function, is DPT_E_UNSUPPORTED.
 *   where, error   may be NULL
 */
DPT_API dpt_result dpt_device_open_with(const dpt_driver *driver, const char *where,
                                        dpt_device **device, dpt_device_error *error);

DPT_END

#endif
