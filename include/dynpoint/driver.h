/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The contract of a driver, for those who write one (docs/writing_drivers.md). A driver is a struct of
 * functions for one kind of device. dpt_driver_get lists the built-in drivers. A program can define one of its own and
 * open it with dpt_device_open_with.
 *
 * Threads: `open` and `find` may be called from several threads at once. All other functions take a device, which
 * belongs to one thread at a time (device.h). dpt_driver_get and dpt_driver_find may be called from any thread.
 */
#ifndef DYNPOINT_DRIVER_H
#define DYNPOINT_DRIVER_H

#include "dynpoint/device.h"

/*
 * The version of the contract below. It grows only if drivers written for the version before would be served wrongly. A
 * library refuses a driver of a version above its own. It serves older ones, except version 1 of release 0.1.
 *
 * An addition does not change the version. A new function is optional and comes after the existing ones, so `size`
 * tells whether a driver has it. A library that is older than the driver does not call it.
 */
#define DPT_DRIVER_VERSION 2

DPT_BEGIN

typedef struct dpt_driver dpt_driver;

/* Called for each device that a driver finds: `where` as `open` takes it, and a line about the device. */
typedef void dpt_device_found_fn(void *user, const dpt_driver *driver, const char *where, const char *about);

/*
 * The contract. A driver allocates its own struct, which begins with a struct dpt_device. dpt_device_open fills in that
 * first part.
 *
 * The library checks arguments before it calls a driver: no argument is NULL unless said below, and wrenches are
 * finite. The driver fills in the structs of its own headers completely, whether these are older or newer than the
 * library's. The library supplies room for 1024 bytes, sets `size` to that of its own struct, and hands to the caller
 * as much as the caller's struct has room for. Fields that `info` and `counts` leave alone are 0. Fields that `read`
 * leaves alone keep the value that the caller had there.
 *
 * open    Opens a device. May block for some seconds.
 *         `where` is in the driver's own notation; NULL is the first or only device. Settings follow a '?', as in
 *         "/dev/ttyACM0?rate=1000".
 *         Success: the device has answered and gives no force, and *device is set.
 *         Failure: nothing stays open, and error->text says why. The library fills in error->code.
 * info    Describes the device. Never blocks, never fails.
 * read    Fills `state` with the latest sample, also if it was read before (then `fresh` is 0). Never blocks, allocates
 *         nothing, makes a bounded number of system calls.
 *         DPT_E_LOST: the device is gone. The status is LOST, `fresh` is 0, the pose is the last known one.
 * write   Sends the wrench of the device on the hand, at the tool's tip, in the device's frame. Never blocks, allocates
 *         nothing, makes a bounded number of system calls. Components that the device cannot give are ignored. A wrench
 *         that is too strong is scaled down.
 *         DPT_E_BUSY: the line had no room. The command is dropped, and the one before stays in force.
 *         DPT_E_NOT_READY, DPT_E_LOST: a device that is not ready, or is lost, takes no command.
 * clear   Ends a fault whose cause is gone, or reopens a lost device at the same place. May block for some seconds. May
 *         switch the motors on; there is no force until the next write.
 *         DPT_E_LOST: the device is still not there.
 * counts  Reports counts. Never blocks, never fails.
 * close   Frees the device. May block, but not for ever. When it returns the device gives no force, or the device's
 *         watchdog ends the force. This holds for a lost device too.
 * find    Reports the devices that are there. May block. The pointer is NULL if devices cannot be found.
 * steer   Of a simulated device whose hand pulls it by a spring: the hand goes to `position`, in the device's frame, m.
 *         Called in any one thread, also during the other calls. Never blocks. The pointer is NULL if nothing can be
 *         steered. DPT_E_UNSUPPORTED: not by this hand.
 */
struct dpt_driver {
    uint32_t size;     /* sizeof(dpt_driver), as the driver's headers have it */
    uint32_t version;  /* DPT_DRIVER_VERSION */
    const char *name;  /* one word, as "sim" or "serial" */
    const char *about; /* one line for people */
    dpt_result (*open)(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error);
    void (*info)(const dpt_device *device, dpt_device_info *info);
    dpt_result (*read)(dpt_device *device, dpt_device_state *state);
    dpt_result (*write)(dpt_device *device, const dpt_wrench *wrench);
    dpt_result (*clear)(dpt_device *device);
    void (*counts)(const dpt_device *device, dpt_device_counts *counts);
    void (*close)(dpt_device *device);
    void (*find)(const dpt_driver *driver, dpt_device_found_fn *found, void *user);
    dpt_result (*steer)(dpt_device *device, const double position[3]);
    const void *reserved_pointer; /* NULL */
};

/* The beginning of every open device. It never grows, because the driver's own fields follow it. */
struct dpt_device {
    const dpt_driver *driver;
    void *reserved[3]; /* for the library; a driver leaves them alone */
};

/* The built-in driver of this index, from 0; NULL after the last one. */
DPT_API const dpt_driver *dpt_driver_get(uint32_t index);

/* The built-in driver of this name; NULL if there is none. */
DPT_API const dpt_driver *dpt_driver_find(const char *name);

/*
 * Open a device with this driver, built in or not. Otherwise as dpt_device_open.
 *   where    NULL or "": the first or only device
 *   error    may be NULL
 *
 * DPT_E_UNSUPPORTED: the driver's version or size is not served (see DPT_DRIVER_VERSION), or a function is missing.
 */
DPT_API dpt_result dpt_device_open_with(const dpt_driver *driver, const char *where, dpt_device **device,
                                        dpt_device_error *error);

DPT_END

#endif
